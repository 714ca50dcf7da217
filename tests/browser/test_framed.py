"""The dashboard in a frame of a portal: logged in and raced there; no other site can frame it."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserType, ConsoleMessage, Page, expect

from tests.browser.dashboard import PATIENCE_MS
from tests.browser.rooms import TOKEN
from tests.browser.serving import serving
from tests.install_browser import find_browser
from tests.proxied import Location, free_port, proxied

pytestmark = pytest.mark.timeout(300)

SHORT = "simulator=kinematic&lanes=q-learning,greedy&steps=40&depth=try"
_BLOCKS_COOKIES_OF_THIRD_PARTIES = "--test-third-party-cookie-phaseout"


@pytest.fixture
def strict_browser(chromium: BrowserType) -> Iterator[Browser]:
    """Chromium that keeps cookies of third parties only if they are partitioned."""
    options = ["--no-sandbox", "--disable-gpu", _BLOCKS_COOKIES_OF_THIRD_PARTIES]
    with chromium.launch(executable_path=find_browser(), args=options) as launched:
        yield launched


def framing(address: str) -> str:
    """Return a page that has another in a frame."""
    frame = f'<iframe src="{address}" title="Hexapods" width="1280" height="700"></iframe>'
    return f"<!doctype html><title>Portal</title>{frame}"


def test_a_listed_portal_frames_it_and_others_do_not(
    strict_browser: Browser, tmp_path: Path
) -> None:
    port, port_of_portal = free_port(), free_port()
    school = f"https://localhost:{port}/hex/"
    # Another site than the server's, since it has another host.
    portal = f"https://127.0.0.1:{port_of_portal}"
    pages = {"/login": framing(f"{school}?token={TOKEN}&{SHORT}"), "/course": framing(school)}
    with (
        serving(
            tmp_path / "data",
            token=TOKEN,
            public_url=school,
            trusted_proxies="127.0.0.1",
            frame_ancestors=portal,
        ) as server,
        proxied(tmp_path / "school", port, [Location("/hex/", server.address)], has_tls=True),
        proxied(tmp_path / "portal", port_of_portal, pages=pages, has_tls=True),
        strict_browser.new_context(ignore_https_errors=True) as context,
    ):
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        errors: list[str] = []
        page.on("console", lambda said: note_error(said, errors))
        logs_in_and_races(page, portal, school)
        assert errors == []
        # Of another site the frame is empty, and the browser says why.
        stranger = f"https://stranger.localhost:{port_of_portal}"
        page.goto(f"{stranger}/course")
        page.wait_for_timeout(1000)
        assert all(not frame.url.startswith(school) for frame in page.frames)
        assert any("frame-ancestors" in error for error in errors), errors
        # Nor does a login in one portal hold in a tab.
        page.goto(school)
        expect(page.get_by_role("group", name="Connection")).to_contain_text("connected")
        expect(page.locator("button.primary")).to_have_count(0)


def note_error(said: ConsoleMessage, errors: list[str]) -> None:
    """Keep the text of an error."""
    if said.type == "error":
        errors.append(said.text)


def logs_in_and_races(page: Page, portal: str, school: str) -> None:
    """The frame logs in by its address, starts a race, and is still logged in the next time."""
    page.goto(f"{portal}/login")
    frame = page.frame_locator("iframe[title=Hexapods]")
    expect(frame.get_by_role("group", name="Connection")).to_contain_text("connected")
    [cookie] = page.context.cookies(school)
    assert (cookie["sameSite"], cookie["secure"], cookie["path"]) == ("None", True, "/hex/")
    assert cookie["name"].startswith("__Secure-hexapods_operator_")
    assert (cookie["partitionKey"] or "").startswith("https://127.0.0.1")
    frame.locator("button.primary").click()
    standings = frame.get_by_role("table", name="Standings")
    expect(standings).to_contain_text("Q-learning")
    expect(standings).to_contain_text(" m")
    # The 3D view is framed by both pages.
    view = frame.frame_locator("iframe").locator("html")
    expect(view).to_be_attached()
    page.goto(f"{portal}/course")
    expect(frame.locator("button.primary")).to_be_visible()
