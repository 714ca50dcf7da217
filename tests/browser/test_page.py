"""The page by itself: what it says before anything runs, its lesson, links, keys and roles."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving

pytestmark = pytest.mark.timeout(300)


@pytest.mark.test
def test_a_first_visit_invites(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(server.address)
    expect(dashboard.headline).to_have_text("A hexapod learns to walk")
    expect(dashboard.primary).to_have_text("Train 500 steps, then race")
    expect(dashboard.start_list).to_have_count(3)
    expect(dashboard.scoreboard).to_contain_text("Each robot draws a line here")
    # Whoever watches is asked for no settings.
    expect(page.get_by_role("tab")).to_have_count(0)
    expect(page.get_by_role("textbox").or_(page.get_by_role("radio"))).to_have_count(0)
    assert page.url == server.address
    expect(page).to_have_title("Racing Hexapods")

    page.get_by_role("link", name="Runs").click()
    expect(page.get_by_text("No runs yet.")).to_be_visible()
    expect(page).to_have_title("Runs · Racing Hexapods")
    expect(page.get_by_role("region", name="Runs", exact=True)).to_contain_text(
        "or its report. Start the first one, or drop"
    )


@pytest.mark.test
def test_the_lesson_is_over_once_and_comes_back_where_it_was(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page, lesson = dashboard.page, dashboard.lesson
    dashboard.open(shared_server.address)
    expect(lesson).to_contain_text(re.compile(r"Card 1 of \d"))
    # A link opens any card; the last one leads on.
    dashboard.open(shared_server.link(card=99))
    expect(lesson).to_contain_text("Your turn")
    expect(page).not_to_have_url(re.compile("card="))
    page.reload()
    lesson.get_by_role("button", name="Change it").click()
    expect(page.get_by_role("tab", name="Train", selected=True)).to_be_visible()
    expect(lesson).to_have_count(0)

    dashboard.open(shared_server.address)
    expect(dashboard.primary).to_be_visible()
    expect(lesson).to_have_count(0)
    page.goto(f"{shared_server.address}#runs")
    menu(page, "Keys and help")
    dashboard.button("Show the first lesson").click()
    expect(lesson).to_contain_text("Card 1")
    expect(lesson).to_be_in_viewport(ratio=1)
    menu(page, "Hide the lesson")
    expect(lesson).to_have_count(0)
    menu(page, "The first lesson")
    expect(lesson).to_be_visible()


def menu(page: Page, item: str) -> None:
    """Choose an item of the menu in the header."""
    banner = page.get_by_role("banner")
    banner.get_by_label("More", exact=True).click()
    banner.get_by_role("menuitem", name=item, exact=True).click()


def test_the_menu_is_in_groups_and_moved_through_by_keys(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    page.goto(f"{shared_server.address}runs")
    expect(page).to_have_url(f"{shared_server.address}#runs")
    expect(page).to_have_title("Runs · Racing Hexapods")
    more = page.get_by_label("More", exact=True)
    more.focus()
    page.keyboard.press("Enter")
    menu = page.get_by_role("menu")
    expect(menu.get_by_role("menuitem", name="Copy a link to this")).to_be_focused()
    titles = menu.get_by_role("group").evaluate_all("all => all.map((group) => group.ariaLabel)")
    assert titles == ["Share", "With a class", "This page", "Language", "Help"]
    page.keyboard.press("ArrowUp")
    expect(menu.get_by_role("menuitem", name="Keys and help")).to_be_focused()
    page.keyboard.press("Home")
    page.keyboard.press("l")
    expect(menu.get_by_role("menuitem", name="Lessons")).to_be_focused()
    weights = "all => [...new Set(all.map((item) => getComputedStyle(item).fontWeight))]"
    assert menu.get_by_role("menuitem").evaluate_all(weights) == ["500"]
    assert dashboard.violations() == []
    page.keyboard.press("Escape")
    expect(more).to_be_focused()
    expect(menu).to_be_hidden()
    page.keyboard.press("Enter")
    expect(menu.get_by_role("menuitem", name="Copy a link to this")).to_be_focused()
    page.keyboard.press("End")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog")).to_contain_text("Keys")


def test_fields_have_room_and_views_have_the_same_edges(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    page.set_viewport_size({"width": 1440, "height": 900})
    dashboard.open(shared_server.link(depth="try", tab="train"))
    rate, its_help = dashboard.box("#field-alpha"), dashboard.box("#help-alpha")
    assert 0 <= its_help["y"] - rate["y"] - rate["height"] < 8
    practice = page.get_by_role("spinbutton", name="Practice, as a number")
    practice.fill("10000000")
    assert practice.evaluate("field => field.scrollWidth <= field.clientWidth")

    brand = dashboard.box("h1")
    assert dashboard.box("[aria-label=Stage]")["x"] == brand["x"]
    more, panel = dashboard.box("[aria-label=More]"), dashboard.box("aside")
    # The menu is a sign in the middle of its square.
    assert abs(panel["x"] + panel["width"] - more["x"] - more["width"]) <= 8


@pytest.mark.test
def test_links_carry_the_form(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(depth="study"))
    train = dashboard.open_tab("Train")
    train.get_by_role("radio", name="Front-back, mirrored").check(force=True)
    train.get_by_role("spinbutton", name="Practice, as a number").fill("750")
    train.get_by_role("slider", name="Discount γ").fill("0.5")
    dashboard.unfold("Race")
    train.get_by_role("checkbox", name="Two-step", exact=True).uncheck()
    world = dashboard.open_tab("World")
    world.get_by_role("radio", name="Payload").check(force=True)
    world.get_by_label("Add a disturbance").select_option("Two limp legs")
    limp = world.get_by_role("group", name="Limp legs")
    limp.get_by_role("button", name="Leg 2", exact=True).click()
    world.get_by_label("From step").fill("11")
    dashboard.unfold("Robot")
    world.get_by_label("Robot", exact=True).select_option("slippery")
    link = page.url
    page.goto("about:blank")

    dashboard.open(link)
    expect(dashboard.primary).to_have_text(re.compile("^Train 750 steps"))
    expect(world.get_by_role("radio", name="Payload")).to_be_checked()
    expect(limp.get_by_role("button", pressed=True)).to_have_text(["1", "2", "4"])
    expect(world.get_by_label("From step")).to_have_value("11")
    assert "disturb=limp:legs=1,2,4:at=10" in page.url
    dashboard.unfold("Robot")
    expect(world.get_by_label("Robot", exact=True)).to_have_value("slippery")
    assert dashboard.violations() == []
    dashboard.open_tab("Train")
    expect(train.get_by_role("slider", name="Discount γ")).to_have_value("0.5")
    expect(train.get_by_role("radio", name="Front-back, mirrored")).to_be_checked()
    dashboard.unfold("Race")
    expect(train.get_by_role("checkbox", name="Two-step", exact=True)).not_to_be_checked()
    page.get_by_role("button", name="Share").click()
    message = page.get_by_role("status").filter(has_text=re.compile("link", re.IGNORECASE))
    expect(message).to_be_visible()


def test_a_number_that_is_none_holds_the_button_back(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(shared_server.link(depth="try", tab="train"))
    alpha = page.get_by_role("spinbutton", name="Learning rate, as a number")
    alpha.fill("0")
    expect(page.get_by_role("alert").filter(has_text="over 0 and at most 1")).to_be_visible()
    expect(dashboard.primary).to_have_attribute("aria-disabled", "true")
    # Who is elsewhere meanwhile is led back to it.
    dashboard.open_tab("World")
    dashboard.actions.get_by_role("button", name="Learning rate").click()
    expect(alpha).to_be_focused()
    alpha.fill("0.7")
    expect(dashboard.primary).not_to_have_attribute("aria-disabled", "true")


_CLOSE_AND_PRESS = """([how, key]) => {
    document.querySelector("dialog[open]")[how]();
    dispatchEvent(new KeyboardEvent("keydown", {key}));
}"""


def follow(page: Page) -> Locator:
    return page.get_by_role("combobox", name="Follow", exact=True)


def test_a_key_acts_once_the_help_is_closed(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    keys = page.get_by_role("dialog", name="Keys")
    dashboard.open(shared_server.link(depth="try", tab="board"))
    page.keyboard.press("?")
    expect(keys).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)

    page.keyboard.press("3")
    expect(follow(page)).to_have_value("3")
    page.keyboard.press("?")
    expect(keys).to_be_visible()
    # A key that follows before the page is told that the dialog was closed.
    page.evaluate(_CLOSE_AND_PRESS, ["close", "2"])
    expect(follow(page)).to_have_value("2")
    page.keyboard.press("?")
    expect(keys).to_be_visible()
    # As by Escape, and again a key before the page is told.
    page.evaluate(_CLOSE_AND_PRESS, ["requestClose", "?"])
    expect(keys).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.keyboard.press("0")
    expect(follow(page)).to_have_value("free")


@pytest.mark.looks_at_3d
def test_the_3d_view_has_the_theme_and_forwards_keys(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(server.link(depth="try", steps=100_000, pace=8))
    page.keyboard.press("r")
    expect(page.get_by_text(re.compile(r"^Practising, \d"))).to_be_visible()
    page.keyboard.press("Space")
    expect(page.get_by_text(re.compile("^Paused at "))).to_be_visible()
    dashboard.view.locator("body").press("Space")
    expect(page.get_by_text(re.compile(r"^Practising, \d"))).to_be_visible()

    page.get_by_label("More", exact=True).click()
    page.get_by_role("menuitem", name="Theme: auto").click()
    page.get_by_role("menuitem", name="Theme: light").click()
    for document in (page, dashboard.view):
        expect(document.locator("html")).to_have_attribute("data-theme", "dark")
    page.reload()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")


@pytest.mark.test
def test_spectators_get_no_controls(dashboard: Dashboard, tmp_path: Path) -> None:
    page = dashboard.page
    with serving(tmp_path, token="for-the-operator") as guarded:
        dashboard.open(guarded.link(depth="try", tab="board"))
        expect(page.get_by_role("region", name="You are watching")).to_be_visible()
        expect(dashboard.primary).to_have_count(0)
        expect(page.get_by_label("Clock")).to_have_count(0)
        expect(follow(page)).to_be_visible()
        page.keyboard.press("r")

        dashboard.open(f"{guarded.address}?token=for-the-operator")
        assert page.url == guarded.address
        expect(dashboard.primary).to_be_visible()
        assert dashboard.get("/api/v1/trainings")["items"] == []


@pytest.mark.test
def test_a_guarded_page_says_what_it_needs(dashboard: Dashboard, tmp_path: Path) -> None:
    with serving(tmp_path, token="for-the-operator", spectators="token") as guarded:
        dashboard.page.goto(guarded.address)
        expect(dashboard.page.get_by_role("heading", name="This page needs a link")).to_be_visible()
        expect(dashboard.page).to_have_title(re.compile("^No access"))
        expect(dashboard.primary).to_have_count(0)
        assert {complaint.split()[0] for complaint in dashboard.complaints} == {"401"}
        dashboard.page.goto("about:blank")
        dashboard.complaints.clear()
