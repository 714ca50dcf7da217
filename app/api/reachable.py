"""Addresses of this machine at which phones of the same network reach a server, by interface."""

import ipaddress
import re
import socket
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import psutil

from app.settings import is_loopback

WILDCARDS = ("0.0.0.0", "::")  # noqa: S104 - compared, not bound
_FAMILIES = (socket.AF_INET, socket.AF_INET6)
_LEADS_ELSEWHERE = {
    "a VPN": (
        r"(tun|tap|wg|ppp|utun|ipsec|gpd|zt|nordlynx|proton)\d*|tailscale.*|.*(vpn|wireguard).*"
    ),
    "virtual machines or containers": (
        r"(docker|veth|virbr|vmnet|vboxnet|lxc|lxd|cni|flannel|podman|nerdctl)\S*|br-\S+"
        r"|vethernet.*|.*(virtualbox|vmware|hyper-v).*"
    ),
    "a mobile network": r"(wwan|rmnet|ccmni|pdp_ip|wwp)\S*",
}
"""What an interface leads to by its name, other than the network in which phones are."""


class InterfaceAddress(NamedTuple):
    """An address of this machine.

    Attributes:
        host: IPv4 or IPv6 address, without a zone.
        interface: name of the interface.
        obstacle: why phones of the same network do not reach it; empty if they may.
    """

    host: str
    interface: str
    obstacle: str


def url_of(host: str, port: int) -> str:
    """Return the address of the page of a server on a host, with a slash at the end."""
    return f"http://[{host}]:{port}/" if ":" in host else f"http://{host}:{port}/"


def machine_addresses(bound: str) -> list[InterfaceAddress]:
    """Return the addresses at which a server that is bound to a host may be reached.

    Args:
        bound: a wildcard, of which there are the addresses of all interfaces that are up; or an
            address or name.
    """
    if bound in WILDCARDS:
        return list(of_interfaces(bound, psutil.net_if_addrs(), psutil.net_if_stats()))
    return [InterfaceAddress(bound, "", "is this machine alone" if is_loopback(bound) else "")]


def reachable_first(addresses: Sequence[InterfaceAddress]) -> list[InterfaceAddress]:
    """Return the addresses that phones may reach: that of the default route first, then IPv4."""
    default = default_address()
    may_reach = [address for address in addresses if not address.obstacle]
    return sorted(may_reach, key=lambda address: (address.host != default, ":" in address.host))


def why_unreachable(bound: str, addresses: Sequence[InterfaceAddress]) -> str:
    """Return why phones reach none of these addresses, and what to do about it.

    Args:
        bound: the host to which the server is bound.
        addresses: those of `machine_addresses`, each of which has an obstacle.
    """
    parts = [
        f"{address.host} ({address.interface}) {address.obstacle}"
        if address.interface
        else f"{address.host} {address.obstacle}"
        for address in addresses
    ]
    reason = "; ".join(parts) or "it has no network but itself"
    advice = (
        "Connect this machine to the network in which the phones are, or turn on its hotspot and "
        "connect them to that, and start the server again"
    )
    if bound in WILDCARDS and any(":" in address.host for address in addresses):
        advice += "; where there is IPv6 alone, with --host ::"
    return (
        f"Phones cannot reach this machine: {reason}. {advice}. If an address leads here from "
        "elsewhere, set HEXAPODS_PUBLIC_URL to it."
    )


def default_address() -> str | None:
    """Return the address of the default route, as a connected UDP socket has it; None without."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # TEST-NET-1 (RFC 5737); nothing is sent
            address: str = probe.getsockname()[0]
        except OSError:
            return None
    return address


def of_interfaces(
    bound: str, interfaces: Mapping[str, Sequence[Any]], states: Mapping[str, Any]
) -> Iterator[InterfaceAddress]:
    """Yield the addresses of interfaces that are up, but for loopback; as `machine_addresses`.

    Args:
        bound: a wildcard.
        interfaces: addresses by interface, as psutil has them.
        states: states by interface, as psutil has them.
    """
    for name, addresses in interfaces.items():
        state = states.get(name)
        if state is None or not state.isup:
            continue
        for address in addresses:
            if address.family not in _FAMILIES:
                continue
            host = address.address.partition("%")[0]
            if is_loopback(host):
                continue
            obstacle = _obstacle_of(host) or _where_it_leads(name, getattr(state, "flags", ""))
            if not obstacle and bound == WILDCARDS[0] and ":" in host:
                obstacle = "is IPv6, which a server bound to 0.0.0.0 does not hear"
            yield InterfaceAddress(host, name, obstacle)


def _obstacle_of(host: str) -> str:
    if ipaddress.ip_address(host).is_link_local:
        return "is an address that the machine has given itself, without a network"
    return ""


def _where_it_leads(interface: str, flags: str) -> str:
    for what, names in _LEADS_ELSEWHERE.items():
        if re.fullmatch(names, interface, re.IGNORECASE):
            return f"leads to {what}"
    return "leads to a VPN" if "pointopoint" in flags else ""
