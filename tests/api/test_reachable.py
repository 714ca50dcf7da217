"""Addresses at which phones reach the server: by interface, and the reason where there is none."""

import socket
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from app.api import reachable
from app.api.reachable import machine_addresses, reachable_first, url_of, why_unreachable

WIFI = ("wlan0", "192.168.1.5")
HOTSPOT = ("ap0", "10.42.0.1")
LOOPBACK = ("lo", "127.0.0.1")


def machine(
    monkeypatch: pytest.MonkeyPatch, *addresses: tuple[str, str], down: str = "", flags: str = ""
) -> None:
    """Give this machine interfaces with addresses; the first one has the default route."""
    interfaces: dict[str, list[Any]] = {}
    for name, host in addresses:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        interfaces.setdefault(name, []).append(SimpleNamespace(family=family, address=host))
        # Each interface has an address of its link, too.
        interfaces[name].append(SimpleNamespace(family=-1, address="02:fc:00:00:00:01"))
    states = {name: SimpleNamespace(isup=name != down, flags=flags) for name in interfaces}
    monkeypatch.setattr(psutil, "net_if_addrs", lambda: interfaces)
    monkeypatch.setattr(psutil, "net_if_stats", lambda: states)
    monkeypatch.setattr(reachable, "default_address", lambda: addresses[0][1])


def hosts(bound: str = "0.0.0.0") -> Sequence[str]:
    return [address.host for address in reachable_first(machine_addresses(bound))]


def test_the_address_of_the_network_is_chosen_among_all_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    others = [
        ("tun0", "10.8.0.6"),
        ("docker0", "172.17.0.1"),
        ("br-1a2b3c", "172.18.0.1"),
        ("vEthernet (WSL)", "172.29.64.1"),
        ("tailscale0", "100.100.1.2"),
        ("wwan0", "10.11.12.13"),
        ("eth1", "169.254.7.7"),
        ("wlan0", "fe80::1%wlan0"),
    ]
    # A VPN may have the default route.
    machine(monkeypatch, *others, LOOPBACK, WIFI)
    assert hosts() == ["192.168.1.5"]


def test_a_hotspot_without_a_default_route_is_an_address_like_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    machine(monkeypatch, LOOPBACK, HOTSPOT)
    assert hosts() == ["10.42.0.1"]


def test_several_are_listed_and_the_default_route_comes_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    machine(monkeypatch, ("eth0", "10.1.2.3"), HOTSPOT, WIFI)
    assert hosts() == ["10.1.2.3", "10.42.0.1", "192.168.1.5"]
    machine(monkeypatch, WIFI, HOTSPOT, down="wlan0")
    assert hosts() == ["10.42.0.1"]


def test_ipv6_counts_where_the_server_hears_it_and_stands_in_brackets(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    machine(monkeypatch, LOOPBACK, ("lo", "::1"), ("eth0", "2001:db8::5"))
    assert hosts() == []
    words = why_unreachable("0.0.0.0", machine_addresses("0.0.0.0"))
    assert "2001:db8::5 (eth0) is IPv6, which a server bound to 0.0.0.0 does not hear" in words
    assert "--host ::" in words
    assert hosts("::") == ["2001:db8::5"]
    assert url_of("2001:db8::5", 8000) == "http://[2001:db8::5]:8000/"
    assert url_of("192.168.1.5", 8000) == "http://192.168.1.5:8000/"


@pytest.mark.parametrize(
    ("address", "flags", "reason"),
    [
        (LOOPBACK, "up,loopback", "it has no network but itself"),
        (("wg0", "10.9.0.2"), "up", "10.9.0.2 (wg0) leads to a VPN"),
        (("corp", "10.9.0.2"), "up,pointopoint", "10.9.0.2 (corp) leads to a VPN"),
        (("docker0", "172.17.0.1"), "up", "leads to virtual machines or containers"),
        (("en0", "169.254.3.4"), "up", "without a network"),
    ],
)
def test_where_phones_reach_none_the_reason_is_named_and_what_to_do(
    monkeypatch: pytest.MonkeyPatch, address: tuple[str, str], flags: str, reason: str
) -> None:
    machine(monkeypatch, address, flags=flags)
    assert hosts() == []
    words = why_unreachable("0.0.0.0", machine_addresses("0.0.0.0"))
    assert reason in words
    for advice in ("hotspot", "HEXAPODS_PUBLIC_URL"):
        assert advice in words


def test_an_address_that_was_chosen_is_taken_but_for_loopback() -> None:
    assert hosts("10.8.0.6") == ["10.8.0.6"]
    assert hosts("lab.example") == ["lab.example"]
    assert hosts("127.0.0.1") == hosts("::1") == hosts("localhost") == []
