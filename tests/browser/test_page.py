"""The page by itself: what it says before anything runs, its links, keys, widths and roles."""

import re
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Browser, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

PHONE: ViewportSize = {"width": 360, "height": 780}


@pytest.mark.looks_at_3d
def test_first_visit_invites(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(server.address)
    expect(dashboard.primary).to_have_text("Train 500 steps, then race")
    expect(dashboard.start_list).to_have_count(3)
    for name, invitation in (
        ("Learning", "Each evaluation"),
        ("The race", "Each robot"),
        ("Action values in this state", "When a learner"),
    ):
        panel = page.get_by_role("region", name=name, exact=True)
        expect(panel).to_contain_text(invitation)
    # Gaits and worlds are folded until someone asks for them.
    expect(page.locator(".group > summary")).to_contain_text(
        ["Training Q-learning", "Robot and world Left-right, opposite", "Race Q-learning, Greedy"]
    )
    expect(page.get_by_role("radio")).to_have_count(0)
    assert page.url == server.address
    page.get_by_role("link", name="Runs").click()
    expect(page.get_by_text("No runs yet.")).to_be_visible()
    expect(page.get_by_role("region", name="Runs", exact=True)).to_contain_text(
        "or its report. Start the first one, or drop"
    )


def test_the_first_lesson_is_skipped_once_and_opened_again(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    lesson = page.get_by_role("region", name="A first lesson")
    for title in ("Moves", "Colours on the feet", "Trial and error"):
        expect(lesson).to_contain_text(title)
        lesson.get_by_role("button", name="Next").click()
    expect(lesson).to_contain_text("First change. Press “Train 500 steps, then race”")
    assert dashboard.violations() == []
    dashboard.button("Skip the lesson").click()
    expect(lesson).to_have_count(0)

    dashboard.open(shared_server.address)
    expect(dashboard.primary).to_be_visible()
    expect(lesson).to_have_count(0)
    page.goto(f"{shared_server.address}#runs")
    page.get_by_role("button", name="Keys and help").click()
    dashboard.button("Show the first lesson").click()
    expect(lesson).to_be_focused()
    expect(lesson).to_be_in_viewport(ratio=1)
    page.set_viewport_size(PHONE)
    expect(lesson).to_be_in_viewport(ratio=1)
    expect(dashboard.primary).to_be_in_viewport(ratio=1)
    assert dashboard.scroll_width() == PHONE["width"]
    assert dashboard.violations() == []


def test_the_button_and_the_scoreboard_stay_in_view(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    page.set_viewport_size({"width": 1440, "height": 900})
    dashboard.open(shared_server.address)
    rate, its_help = dashboard.box("#field-alpha"), dashboard.box("#help-alpha")
    assert 0 <= its_help["y"] - rate["y"] - rate["height"] < 8

    dashboard.unfold("Robot and world")
    expect(page.get_by_role("radiogroup", name="Gait")).to_be_in_viewport(ratio=1)
    expect(dashboard.primary).to_be_in_viewport(ratio=1)
    expect(page.get_by_role("region", name="Scoreboard")).to_be_in_viewport(ratio=1)

    practice = page.get_by_role("spinbutton", name="Practice, as a number")
    practice.fill("10000000")
    assert practice.evaluate("field => field.scrollWidth <= field.clientWidth")

    page.set_viewport_size({"width": 1920, "height": 1080})
    for link, left, right in (
        ("Race", ".stage", ".controls"),
        ("Experiments", ".experiment-list", ".answer"),
        ("Runs", ".runs", ".runs"),
    ):
        page.get_by_role("navigation").get_by_role("link", name=link).click()
        header, panel = dashboard.box(".brand"), dashboard.box(right)
        assert dashboard.box(left)["x"] == header["x"]
        switches = dashboard.box(".switches")
        # The last switch is a sign in the middle of its square.
        assert abs(panel["x"] + panel["width"] - switches["x"] - switches["width"]) <= 8


def test_links_carry_the_form(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    dashboard.unfold_settings()
    page.get_by_role("radio", name="Front-back, mirrored").check(force=True)
    page.get_by_role("radio", name="Payload").check(force=True)
    page.get_by_label("Add a disturbance").select_option("Two limp legs")
    dashboard.button("Leg 2").click()
    page.get_by_label("From step").fill("11")
    page.get_by_role("spinbutton", name="Practice, as a number").fill("750")
    page.get_by_role("slider", name="Discount γ").fill("0.5")
    page.get_by_label("Robot").select_option("slippery")
    page.get_by_role("checkbox", name="Two-step", exact=True).uncheck()
    link = page.url
    page.goto("about:blank")

    dashboard.open(link)
    expect(dashboard.primary).to_have_text(re.compile("^Train 750 steps"))
    expect(page.get_by_role("slider", name="Discount γ")).to_have_value("0.5")
    dashboard.unfold_settings()
    expect(page.get_by_role("radio", name="Front-back, mirrored")).to_be_checked()
    expect(page.get_by_role("radio", name="Payload")).to_be_checked()
    expect(
        page.get_by_role("group", name="Limp legs").get_by_role("button", pressed=True)
    ).to_have_text(["1", "2", "4"])
    expect(page.get_by_label("From step")).to_have_value("11")
    assert "disturb=limp:legs=1,2,4:at=10" in page.url
    assert dashboard.violations() == []
    expect(page.get_by_label("Robot")).to_have_value("slippery")
    expect(page.get_by_role("checkbox", name="Two-step", exact=True)).not_to_be_checked()
    page.get_by_role("button", name="Share").click()
    told = page.get_by_role("status").filter(has_text=re.compile("link", re.IGNORECASE))
    expect(told).to_be_visible()


def test_a_number_that_is_none_holds_the_button_back(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    alpha = page.get_by_role("spinbutton", name="Learning rate, as a number")
    alpha.fill("0")
    expect(page.get_by_role("alert").filter(has_text="over 0 and at most 1")).to_be_visible()
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    alpha.fill("0.7")
    expect(dashboard.primary).not_to_have_attribute("aria-disabled", "true")


_CLOSE_AND_PRESS = """([how, key]) => {
    document.querySelector("dialog[open]")[how]();
    dispatchEvent(new KeyboardEvent("keydown", {key}));
}"""


@pytest.mark.looks_at_3d
def test_keys(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?steps=100000&pace=8")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)

    follow = page.get_by_label("Follow")
    page.keyboard.press("3")
    expect(follow).to_have_value("3")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    # A key that follows before the page is told that the dialog was closed.
    page.evaluate(_CLOSE_AND_PRESS, ["close", "2"])
    expect(follow).to_have_value("2")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    # As by Escape, and again a key before the page is told.
    page.evaluate(_CLOSE_AND_PRESS, ["requestClose", "?"])
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("0")
    expect(follow).to_have_value("free")

    page.keyboard.press("r")
    expect(page.get_by_text(re.compile(r"^Practising, \d"))).to_be_visible()
    page.keyboard.press("Space")
    expect(page.get_by_text(re.compile("^Paused at "))).to_be_visible()
    # The stage forwards the keys that it gets.
    dashboard.view.locator("body").press("Space")
    expect(page.get_by_text(re.compile(r"^Practising, \d"))).to_be_visible()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_phone_needs_no_scrolling_sideways(
    flat_browser: Browser, shared_server: Serving, theme: str
) -> None:
    scheme: Literal["light", "dark"] = "light" if theme == "light" else "dark"
    with new_page(flat_browser, viewport=PHONE, color_scheme=scheme) as page:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(shared_server.address)
        stage = page.get_by_role("region", name="Stage", exact=True)
        top, below = stage.bounding_box(), dashboard.primary.bounding_box()
        assert top is not None
        assert below is not None
        assert top["y"] + top["height"] <= below["y"]

        page.locator("summary", has_text="Settings").first.click()
        dashboard.unfold_settings()
        assert dashboard.scroll_width() == PHONE["width"]
        assert dashboard.violations() == []
        page.mouse.wheel(0, 600)
        expect(stage).to_be_in_viewport(ratio=0.99)

        page.goto(f"{shared_server.address}#runs")
        assert dashboard.scroll_width() == PHONE["width"]
        head, kinds = dashboard.box(".runs-head"), dashboard.box(".runs-head .segments")
        assert kinds["x"] + kinds["width"] <= head["x"] + head["width"]
        assert dashboard.complaints == []


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(dashboard: Dashboard, shared_server: Serving, theme: str) -> None:
    dashboard.page.emulate_media(color_scheme="light" if theme == "light" else "dark")
    dashboard.open(shared_server.address)
    dashboard.unfold_settings()
    assert dashboard.violations() == []
    dashboard.page.get_by_role("link", name="Runs").click()
    expect(dashboard.page.get_by_role("heading", name="Runs")).to_be_visible()
    assert dashboard.violations() == []


@pytest.mark.looks_at_3d
def test_the_theme_is_chosen_and_remembered(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    page.get_by_role("button", name=re.compile("^Theme: auto")).click()
    page.get_by_role("button", name=re.compile("^Theme: light")).click()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    dashboard.open(shared_server.address)
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    stage = dashboard.view.locator("html")
    expect(stage).to_have_attribute("data-theme", "dark")


def test_spectators_get_no_controls(dashboard: Dashboard, tmp_path: Path) -> None:
    page = dashboard.page
    with serving(tmp_path, token="for-the-operator") as guarded:
        dashboard.open(guarded.address)
        expect(page.get_by_role("heading", name="You are watching")).to_be_visible()
        expect(dashboard.primary).to_have_count(0)
        expect(page.get_by_label("Clock")).to_have_count(0)
        expect(page.get_by_label("Follow")).to_be_visible()
        page.keyboard.press("r")

        dashboard.open(f"{guarded.address}?token=for-the-operator")
        assert page.url == guarded.address
        expect(dashboard.primary).to_be_visible()
        assert dashboard.get("/api/v1/trainings")["items"] == []


def test_a_guarded_page_says_what_it_needs(dashboard: Dashboard, tmp_path: Path) -> None:
    with serving(tmp_path, token="for-the-operator", spectators="token") as guarded:
        dashboard.page.goto(guarded.address)
        expect(dashboard.page.get_by_role("heading", name="This page needs a link")).to_be_visible()
        expect(dashboard.primary).to_have_count(0)
        assert {complaint.split()[0] for complaint in dashboard.complaints} == {"401"}
        dashboard.page.goto("about:blank")
        dashboard.complaints.clear()
