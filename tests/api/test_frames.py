"""Pages in frames of other sites: by default of none, else of the origins that a setting lists."""

from collections.abc import Callable

import pytest

from app.api.cookies import CookieRules
from tests.api.calls import Api

TOKEN = "a-token-for-tests"
PORTAL = "https://portal.school.example"
FRAMED = {
    "public_url": "https://hexapods.example",
    "frame_ancestors": (PORTAL, "https://moodle.example:8443"),
    "token": TOKEN,
}
IN_FRAME = {
    "Host": "hexapods.example",
    "Sec-Fetch-Site": "cross-site",
    "Sec-Fetch-Mode": "navigate",
    "Sec-Fetch-Dest": "iframe",
}
Shared = Callable[..., Api]


@pytest.mark.parametrize("path", ["/", "/runs", "/viewer/", "/docs", "/nothing", "/api/v1/runs"])
def test_every_policy_lists_the_origins(shared: Shared, path: str) -> None:
    headers = shared(**FRAMED).client.get(path, headers={"Host": "hexapods.example"}).headers
    frames = f"frame-ancestors 'self' {PORTAL} https://moodle.example:8443"
    assert frames in headers["content-security-policy"]
    # It knows no lists.
    assert "x-frame-options" not in headers
    assert shared().client.get("/api/v1/runs").headers["x-frame-options"] == "SAMEORIGIN"


def test_a_page_opens_in_a_frame_of_another_site_only_where_frames_may_be(shared: Shared) -> None:
    opened = shared(**FRAMED).client.get("/", headers=IN_FRAME)
    refused = shared(public_url="https://hexapods.example").client.get("/", headers=IN_FRAME)
    assert (opened.status_code, refused.status_code) == (200, 403)


@pytest.mark.parametrize(
    "headers",
    [
        {"Sec-Fetch-Mode": "cors", "Sec-Fetch-Dest": "empty"},
        {"Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "object"},
        {"Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "image"},
    ],
)
def test_other_requests_of_the_framing_site_are_refused(
    shared: Shared, headers: dict[str, str]
) -> None:
    """Though browsers send cookies with them, as they are `SameSite=None`."""
    client = shared(**FRAMED).client
    assert client.get("/api/v1/runs", headers={**IN_FRAME, **headers}).status_code == 403
    change = {**IN_FRAME, **headers, "Origin": PORTAL}
    assert client.post("/api/v1/races", headers=change, json={}).status_code == 403


def test_cookies_are_kept_for_each_site_around_the_frame(shared: Shared) -> None:
    answer = shared(**FRAMED).client.get(f"/?token={TOKEN}", headers=IN_FRAME)
    cookie = answer.headers["set-cookie"]
    assert cookie.startswith("__Host-hexapods_operator_443=")
    assert cookie.endswith("; Path=/; HttpOnly; SameSite=None; Secure; Partitioned")


def test_over_plain_http_cookies_are_as_without_frames(shared: Shared) -> None:
    """Browsers refuse `SameSite=None` there."""
    answer = shared(frame_ancestors=(PORTAL,), token=TOKEN).client.get(f"/?token={TOKEN}")
    assert answer.headers["set-cookie"].endswith("; HttpOnly; SameSite=Strict")
    assert CookieRules(is_secure=True).attributes == "SameSite=Strict; Secure"
