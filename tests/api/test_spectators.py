"""The address at which others watch, and its QR code."""

from collections.abc import Callable

import pytest
import segno

from app.api.reachable import machine_addresses, reachable_first, url_of
from tests.api.calls import Api

TOKEN = "a-token-for-tests"
Serve = Callable[..., Api]


@pytest.mark.parametrize(
    ("settings", "host", "address"),
    [
        ({"host": "0.0.0.0"}, "127.0.0.1:8000", None),
        ({"host": "0.0.0.0"}, "192.168.1.5:8000", "http://192.168.1.5:8000/"),
        ({"host": "192.168.1.5"}, "localhost:8000", "http://192.168.1.5:8000/"),
        ({"host": "fd00::5"}, "localhost:8000", "http://[fd00::5]:8000/"),
        ({"allowed_hosts": ("lab.example",)}, "lab.example", "http://lab.example/"),
        ({"public_url": "https://lab.example"}, "127.0.0.1:8000", "https://lab.example/"),
    ],
)
def test_address_is_one_that_others_can_open(
    serve: Serve, settings: dict[str, object], host: str, address: str | None
) -> None:
    invitation = serve(token=TOKEN, **settings).get("/spectators", headers={"Host": host})
    if address is None:
        [local, *_] = reachable_first(machine_addresses("0.0.0.0"))
    expected = address or url_of(local.host, 8000)
    assert invitation["address"] == expected
    assert TOKEN not in str(invitation)
    assert invitation["reason"] == ""
    assert invitation["watching"] == 0
    # Dark on white in both themes, with the margin that scanners need.
    code = segno.make(expected, micro=False)
    assert invitation["qr_code"] == code.svg_data_uri(border=2, light="#fff")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({}, "--share"),
        ({"token": TOKEN}, "Only this machine"),
        ({"token": TOKEN, "host": "0.0.0.0", "spectators": "token"}, "needs the token"),
    ],
)
def test_without_an_address_for_spectators_the_reason_is_returned(
    serve: Serve, settings: dict[str, object], words: str
) -> None:
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    invitation = serve(**settings).get("/spectators", headers=bearer)
    assert (invitation["address"], invitation["qr_code"]) == (None, None)
    assert words in invitation["reason"]
