"""Presenting: a window in large type, card by card, by its own keys or by a remote on a phone."""

import re
import socket
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Route, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold, serving
from tests.browser.type_sizes import small_texts
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

TOKEN = "for-the-operator"
RACE = {
    "gait": "left-right-vertical",
    "simulator": "kinematic",
    "steps": 20,
    "lanes": [{"agent": "q-learning", "training": {"steps": 60}}, {"agent": "greedy"}],
}
SCREEN: ViewportSize = {"width": 1920, "height": 1080}
PHONE: ViewportSize = {"width": 390, "height": 844}
LEAST_PX = 18


@pytest.mark.test
def test_a_window_is_presented_and_a_remote_turns_its_cards(
    dashboard: Dashboard, flat_browser: Browser, tmp_path: Path
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    address = f"http://localhost:{port}/"
    page = dashboard.page
    page.set_viewport_size(SCREEN)
    with (
        serving(tmp_path, port, TOKEN, public_url=address) as server,
        server.api(TOKEN) as api,
        new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True) as phone,
    ):
        race = finished(api, "races", RACE)
        hold(api, race, 2.5)
        # Whoever watches may show the page so, but not command what others see.
        dashboard.open(f"{address}?present")
        expect(presenter_panel(dashboard)).to_contain_text("watching")
        expect(dashboard.button("Next card")).to_have_count(0)
        shows_the_race_in_large_type(dashboard, address)

        dashboard.open(f"{address}?token={TOKEN}&present")
        remote = Dashboard(phone, has_3d=False)
        remote.open(f"{address}?token={TOKEN}&remote")
        follows_its_remote(dashboard, remote)
        obeys_its_own_keys(dashboard)
        assert remote.complaints == []


def presenter_panel(dashboard: Dashboard) -> Locator:
    """The card, what comes next, and how others can watch."""
    return dashboard.page.get_by_role("region", name="Presenter’s panel")


def shows_the_race_in_large_type(dashboard: Dashboard, address: str) -> None:
    """The picture takes most of the screen; the board, the rule and the address can be read."""
    page = dashboard.page
    expect(page.get_by_role("banner")).to_be_hidden()
    expect(
        presenter_panel(dashboard).get_by_text(address[len("http://") : -1], exact=True)
    ).to_be_visible()
    code = presenter_panel(dashboard).get_by_role("img", name=f"QR code of {address}")
    assert code.evaluate("image => image.naturalWidth") > 20
    dashboard.eventually(lambda: dashboard.has_figures(lanes=2), "the scoreboard is there")
    expect(dashboard.headline).to_have_text(re.compile("leads|level"))
    expect(dashboard.panel.get_by_role("definition").first).to_contain_text(
        re.compile(r"The farthest at time-out wins: .* \(paper clock\)")
    )
    dashboard.stand_in_for_stage()
    assert small_texts(page, LEAST_PX) == []
    stage = page.get_by_role("region", name="Stage").bounding_box()
    assert stage is not None
    assert stage["width"] > 0.6 * SCREEN["width"]
    assert dashboard.scroll_width() <= SCREEN["width"]
    assert dashboard.violations() == []


def follows_its_remote(dashboard: Dashboard, remote: Dashboard) -> None:
    """Cards go forward and back; a step is explained; the page is blank; the code shrinks."""
    card = presenter_panel(dashboard)
    remote.page.get_by_role("button", name=re.compile("^Next: It knows nothing yet")).tap()
    expect(card).to_contain_text(re.compile(r"Card 1 of \d.*It knows nothing yet"))
    remote.page.get_by_role("button", name=re.compile("^Next: It tries moves")).tap()
    expect(card).to_contain_text("It tries moves")
    expect(remote.page.get_by_role("heading", name="2. It tries moves.")).to_be_visible()
    remote.button("Back").tap()
    expect(card).to_contain_text("Card 1 of")

    remote.button("Show why").tap()
    expect(dashboard.headline).to_have_text(re.compile("^Legs .* to "))
    assert small_texts(dashboard.page, LEAST_PX) == []
    remote.button("Show why").tap()
    expect(dashboard.headline).to_have_text(re.compile("leads|level"))

    shown_again = dashboard.button("Show the page again")
    remote.button("Blank").tap()
    expect(shown_again).to_be_visible()
    assert dashboard.violations() == []
    remote.button("Blank").tap()
    expect(shown_again).to_have_count(0)

    code = card.get_by_role("img", name=re.compile("^QR code"))
    large = code.bounding_box()
    remote.button("Code small").tap()
    dashboard.eventually(lambda: code.bounding_box() != large, "another size")
    small = code.bounding_box()
    assert large is not None
    assert small is not None
    assert small["height"] < large["height"]
    remote.button("Code none").tap()
    expect(code).to_have_count(0)

    ends = remote.button("End at time-out")
    expect(ends).to_have_attribute("aria-pressed", "true")
    ends.tap()
    expect(ends).to_have_attribute("aria-pressed", "false")
    assert remote.scroll_width() == PHONE["width"]
    assert remote.violations() == []


def obeys_its_own_keys(dashboard: Dashboard) -> None:
    """Press the keys of a remote control for slides; it fills the screen until Escape or P."""
    page, card = dashboard.page, presenter_panel(dashboard)
    page.keyboard.press("PageDown")
    expect(card).to_contain_text("Card 2 of")
    page.keyboard.press("ArrowRight")
    expect(card).to_contain_text("Card 3 of")
    page.keyboard.press("ArrowLeft")
    expect(card).to_contain_text("Card 2 of")
    page.keyboard.press("q")
    expect(card.get_by_role("img", name=re.compile("^QR code"))).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("banner")).to_be_visible()
    expect(page).not_to_have_url(re.compile("present"))

    dashboard.choose_depth("Try")
    dashboard.button("Present").click()
    expect(card).to_be_visible()
    is_full = "document.fullscreenElement !== null"
    dashboard.eventually(lambda: page.evaluate(is_full), "it fills the screen")
    page.keyboard.press("p")
    expect(card).to_have_count(0)
    dashboard.eventually(lambda: not page.evaluate(is_full), "it fills the screen no more")
    # It is as deep as before.
    expect(page.get_by_role("tab", name="Board", selected=True)).to_be_visible()


@pytest.mark.promises
def test_its_button_is_in_the_header_before_its_code_as_it_would_move_the_others(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    blocked: list[Route] = []

    def hold_back(route: Route) -> None:
        blocked.append(route)

    dashboard.page.route("**/features/presenter/*.js", hold_back)
    dashboard.open(f"{shared_server.address}?depth=try")
    expect(dashboard.page.locator("header").get_by_role("button", name="Share")).to_be_visible()
    button = dashboard.page.locator("header").get_by_role("button", name="Present")
    expect(button.filter(visible=True)).to_have_count(1)
    for route in blocked:
        route.continue_()
