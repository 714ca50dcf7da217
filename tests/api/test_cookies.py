"""The cookies of a request: which of them are kept, and what of them."""

from typing import Any

from app.api.cookies import CookieRules, SessionCookie, cookies_of, kept_cookies


def scope(*lines: str, host: str = "127.0.0.1:8000") -> dict[str, Any]:
    return {
        "type": "http",
        "headers": [(b"host", host.encode())],
        "state": {"cookies": kept_cookies(lines)},
    }


def test_names_that_can_be_ours_are_kept() -> None:
    """Those of features begin likewise, also of features that the core does not know."""
    lines = ("a=b; hexapods_operator_8000=x", "__Host-hexapods_room_443_ABC=y;hexapod_1=z; sid=1")
    assert cookies_of(scope(*lines)) == {
        "hexapods_operator_8000": "x",
        "__Host-hexapods_room_443_ABC": "y",
    }


def test_values_of_cookies_are_not_decoded() -> None:
    cookies = kept_cookies(
        [r'hexapods_visitor_1="\"\054"; hexapods_room_1_A=a=b; hexapods_room_1_B']
    )
    assert list(cookies.values()) == [r'"\"\054"', "a=b", ""]


def test_a_session_is_that_of_the_port_the_client_has_called() -> None:
    request_scope = scope("hexapods_operator_8000=x; __Host-hexapods_operator_443=y")
    assert SessionCookie(request_scope, CookieRules(is_secure=False), path="").value == "x"
    public = scope("hexapods_operator_8000=x; __Host-hexapods_operator_443=y", host="robots.test")
    assert SessionCookie(public, CookieRules(is_secure=True), path="").value == "y"
