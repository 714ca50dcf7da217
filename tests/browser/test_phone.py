"""On a phone: what is how many taps away, and every tab fits, is accessible and meets a thumb."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.budget import shown_on
from tests.browser.dashboard import Dashboard
from tests.browser.serving import finished, hold, serving
from tests.browser.test_spectators import RACE, TOKEN
from tests.browser.test_workspace import BUDGETS, PRACTICE, each_tab
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

PHONE: ViewportSize = {"width": 390, "height": 844}
NARROW: ViewportSize = {"width": 360, "height": 780}
SMALL: ViewportSize = {"width": 360, "height": 640}
THUMB_PX = 40


def test_a_phone(flat_browser: Browser, tmp_path: Path) -> None:
    with (
        serving(tmp_path, token=TOKEN) as server,
        server.api(TOKEN) as api,
        new_page(flat_browser, viewport=PHONE, has_touch=True, is_mobile=True) as page,
    ):
        hold(api, finished(api, "races", RACE), 5.0)
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.address)
        taps_of_a_spectator(dashboard)
        dashboard.open(f"{server.address}?token={TOKEN}")
        content_has_half_of_the_screen(dashboard, "ended")
        fits_and_is_accessible(dashboard)
        practice = api.post("trainings", json=PRACTICE).raise_for_status().json()
        expect(dashboard.headline).to_have_text(re.compile("so far$"))
        content_has_half_of_the_screen(dashboard, "practising")
        work_unfolds(dashboard)
        api.post(f"trainings/{practice['id']}/stop").raise_for_status()
        assert dashboard.complaints == []


def taps_of_a_spectator(dashboard: Dashboard) -> None:
    """Who leads, a replay of one's own, why, and settings of one's own."""
    page = dashboard.page
    # Without a tap: who leads and why, and no more than may be shown at once.
    expect(dashboard.headline).to_have_text(re.compile("leads|level"))
    expect(dashboard.headline).to_be_in_viewport(ratio=1)
    dashboard.stand_in_for_stage()
    shown, budget = shown_on(page), BUDGETS["Watch"]
    assert shown.controls <= budget.controls
    assert shown.words <= budget.words
    # One: a replay of one's own. The stage stays where it is while the page is read.
    dashboard.button("Replay").tap()
    expect(page.get_by_role("slider", name="Moment of your replay")).to_be_visible()
    stage = page.get_by_role("region", name="Stage", exact=True)
    expect(stage).to_be_in_viewport(ratio=1)
    dashboard.button("Back to the stage").tap()
    # At most two: the step, explained.
    page.get_by_role("tab", name="Why").tap()
    expect(page.get_by_role("region", name="Explanation")).to_contain_text("Why this move")
    # Three: what thirty robots make of one's own α.
    dashboard.group("Depth").get_by_role("button", name="Study").tap()
    page.get_by_role("tab", name="What if").tap()
    dashboard.button("Choices").tap()
    dashboard.button("Try other settings").tap()
    alpha = page.get_by_role("spinbutton", name="Learning rate, as a number")
    alpha.fill("0.2")
    expect(page.get_by_role("img", name=re.compile("^These settings: "))).to_be_visible()


def content_has_half_of_the_screen(dashboard: Dashboard, state: str) -> None:
    """Of each tab of each depth, with the lesson's card folded; what starts a run stays there."""
    page = dashboard.page
    card = page.get_by_role("button", name="Card", exact=True)
    if card.get_attribute("aria-expanded") == "true":
        expect(dashboard.lesson).to_be_in_viewport(ratio=1)
        card.tap()
    expect(dashboard.lesson).to_be_hidden()
    shares = dict[str, float]()
    for depth, tab in each_tab(dashboard):
        for size in (SMALL, PHONE):
            page.set_viewport_size(size)
            share = dashboard.box("#panel-body")["height"] / size["height"]
            if share < 0.5:
                shares[f"{state} {depth} {tab} at {size['width']}"] = share
            expect(page.get_by_role("region", name="Stage", exact=True)).to_be_in_viewport(ratio=1)
            expect(page.locator("header .starts button").last).to_be_in_viewport(ratio=1)
    assert shares == {}


def work_unfolds(dashboard: Dashboard) -> None:
    """How far a practice is can be seen, and a tap unfolds what holds and ends it."""
    dashboard.choose_depth("Try")
    expect(dashboard.button("Stop")).to_be_hidden()
    fold = dashboard.panel.get_by_role("button", name=re.compile(r"^Progress: \d+ %$"))
    fold.tap()
    expect(dashboard.button("Stop")).to_be_in_viewport(ratio=1)
    expect(dashboard.panel.get_by_role("progressbar")).to_be_in_viewport(ratio=1)
    fold.tap()
    expect(dashboard.button("Stop")).to_be_hidden()


def fits_and_is_accessible(dashboard: Dashboard) -> None:
    """No tab of any depth scrolls sideways, is too small for a thumb, or fails axe."""
    page = dashboard.page
    problems: dict[str, list[str]] = {}
    for depth, tab in each_tab(dashboard):
        for size in (NARROW, PHONE):
            page.set_viewport_size(size)
            if (width := dashboard.scroll_width()) > size["width"]:
                problems[f"{depth} {tab} at {size['width']}"] = [f"{width} px wide"]
        expect(dashboard.headline).to_be_in_viewport(ratio=1)
        if too_small := dashboard.small_targets(THUMB_PX):
            problems[f"{depth} {tab} targets"] = too_small
        if violations := dashboard.violations_in_both_themes():
            problems[f"{depth} {tab}"] = violations
    assert problems == {}
