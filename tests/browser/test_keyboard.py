"""The page without a pointer: train, race, scrub, and run an experiment by keys alone."""

import re
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold
from tests.browser.test_picture import at_rest, picture_of

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode(
    {
        "steps": 4,
        "evaluate_every": 2,
        "race_steps": 3,
        "simulator": "kinematic",
        "lanes": "q-learning,greedy",
    }
)
SMALL = urlencode(
    {
        "experiment": "table1",
        "seeds": 2,
        "simulator": "kinematic",
        "gaits": "left-right-origin",
        "observations": "measured",
        "robots": "stiff",
    }
)
MAX_TABS = 150
"""More than the page has places to stop at."""


def tab_to(page: Page, target: Locator) -> None:
    """Press Tab until the target has the focus, which must be visible there."""
    expect(target).to_be_visible()
    for _ in range(MAX_TABS):
        page.keyboard.press("Tab")
        if target.evaluate("element => element === document.activeElement"):
            assert target.evaluate("element => element.matches(':focus-visible')")
            return
    raise AssertionError(f"Tab does not reach {target}")


def test_train_race_scrub_and_experiment(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}#")
    tab_to(page, dashboard.primary)
    page.keyboard.press("Enter")
    expect(dashboard.headline).to_have_text(re.compile("wins|tie"))
    expect(dashboard.button("Play the stage again")).to_be_visible()

    seek = dashboard.moment
    tab_to(page, seek)
    assert float(seek.input_value()) > 0
    slider = seek.element_handle()
    page.keyboard.press("Home")
    # Looked at in each frame: a race of a second plays on from its start at once.
    page.wait_for_function("slider => Number(slider.value) < slider.max / 2", arg=slider)
    page.keyboard.press("ArrowRight")

    tab_to(page, page.get_by_role("link", name="Experiments"))
    page.keyboard.press("Enter")
    tab_to(page, page.get_by_role("button", name="New experiment"))
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog", name="New experiment")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog", name="New experiment")).to_be_hidden()
    page.goto(f"{server.address}#experiments?{SMALL}")
    seeds = page.get_by_label("Seeds", exact=True)
    tab_to(page, seeds)
    page.keyboard.press("Control+A")
    page.keyboard.type("1")
    tab_to(page, page.get_by_role("button", name=re.compile("^Run Table 1: ")))
    page.keyboard.press("Enter")
    expect(dashboard.experiment_state("finished")).to_be_visible()
    [run] = dashboard.get("/api/v1/experiments")["items"]
    assert run["config"]["seeds"] == 1


RACE = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 20,
    "lanes": [{"agent": "greedy"}, {"agent": "random-walk"}],
    "disturbances": [{"kind": "sensor-noise", "sd_m": 0.001, "at_step": 5}],
}


@pytest.mark.test
def test_depths_tabs_and_time(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        hold(api, finished(api, "races", RACE), 2.0)
    dashboard.open(shared_server.address)
    expect(dashboard.standings).to_be_visible()
    goes_through_depths_and_tabs(dashboard)
    goes_through_time(dashboard)

    page.keyboard.press("p")
    expect(page.get_by_role("region", name="Presenter’s panel")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_role("banner")).to_be_visible()


def test_each_press_moves_the_moment(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        hold(api, finished(api, "races", RACE), 2.0)
    dashboard.open(shared_server.address)
    seek = dashboard.moment
    expect(seek).to_have_value("2")
    seek.focus()
    for _ in range(20):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(70)  # as a person presses, while the stage tells where it is
    expect(seek).to_have_value("4")
    for _ in range(5):
        page.keyboard.press("ArrowLeft")
    expect(seek).to_have_value("3.5")
    assert dashboard.get("/api/v1/stage")["time_s"] == 3.5


def test_help_opens_at_its_beginning(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Keys")
    expect(dialog.get_by_role("heading", name="Keys")).to_be_focused()
    expect(dialog.get_by_role("heading", name="Keys")).to_be_in_viewport()
    assert dialog.evaluate("element => element.scrollHeight > element.clientHeight"), "it is long"
    assert dialog.evaluate("element => element.scrollTop") == 0
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()


@pytest.mark.looks_at_3d
def test_a_key_in_the_picture_does_one_thing(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        race = finished(api, "races", RACE)
    dashboard.open(shared_server.link(run=race["id"], t="2"))
    view = picture_of(page, robots=2)
    at_rest(view, page)
    place = "() => __viserMutable.camera.position.toArray()"
    directed = pytest.approx(view.evaluate(place), abs=0.02)

    # Letters are the page's, also those by which the client would move its camera.
    page.get_by_title("The robots on the track, in 3D").focus()
    for key in "wasqd":
        page.keyboard.press(key, delay=300)
    expect(dashboard.group("Depth").get_by_role("button", pressed=True)).to_have_text("Try")
    at_rest(view, page)
    assert view.evaluate(place) == directed
    # Arrows turn it, plus and minus bring it nearer and away: it is the viewer's, until C.
    back = dashboard.button("Directed camera")
    expect(back).to_have_count(0)
    page.keyboard.press("ArrowLeft", delay=600)
    expect(back).to_be_visible()
    at_rest(view, page)
    turned = view.evaluate(place)
    assert turned != directed
    page.keyboard.press("+")
    at_rest(view, page)
    assert view.evaluate(place) != pytest.approx(turned, abs=0.02)
    page.keyboard.press("c")
    expect(back).to_have_count(0)
    at_rest(view, page)
    assert view.evaluate(place) == directed
    disturbs_a_race_that_plays(dashboard)


def disturbs_a_race_that_plays(dashboard: Dashboard) -> None:
    """The menu of a leg offers to pause the race, and then what can happen."""
    page = dashboard.page
    page.get_by_label("Speed", exact=True).select_option("0.25")
    dashboard.button("Play your replay").press("Enter")
    page.keyboard.press("1")
    page.keyboard.press("l")
    expect(page.get_by_role("button", name="Leg 1")).to_be_focused()
    page.keyboard.press("Enter")
    menu = page.get_by_role("region", name=re.compile("leg 1$"))
    expect(menu).to_contain_text("A race is disturbed at the step where it is paused.")
    expect(menu.get_by_role("button", name="Pause")).to_be_focused()
    page.keyboard.press("Enter")
    kinds = menu.get_by_role("group", name="What happens")
    expect(kinds.get_by_role("button").first).to_be_focused()


def goes_through_depths_and_tabs(dashboard: Dashboard) -> None:
    """D shows more, E explains; arrows go through the tabs; a backslash hides the panel."""
    page = dashboard.page
    page.keyboard.press("e")
    tab_to(page, dashboard.panel.get_by_role("button", name="Back to the board"))
    page.keyboard.press("Enter")
    expect(dashboard.scoreboard).to_be_visible()

    depth = dashboard.group("Depth").get_by_role("button", pressed=True)
    for title in ("Try", "Study"):
        page.keyboard.press("d")
        expect(depth).to_have_text(title)
    shown = page.get_by_role("tab", selected=True)
    tab_to(page, shown)
    for key, title in (("ArrowRight", "Train"), ("End", "What if"), ("ArrowRight", "Board")):
        page.keyboard.press(key)
        expect(shown).to_have_text(title)
        expect(shown).to_be_focused()
    for key, title in (("ArrowLeft", "What if"), ("Home", "Board")):
        page.keyboard.press(key)
        expect(shown).to_have_text(title)
    page.keyboard.press("\\")
    expect(dashboard.panel).to_have_count(0)
    page.keyboard.press("\\")
    expect(dashboard.panel).to_be_visible()
    page.keyboard.press("d")
    expect(depth).to_have_text("Watch")


def goes_through_time(dashboard: Dashboard) -> None:
    """Home and End go to the ends, brackets to what happened."""
    page, moment = dashboard.page, dashboard.moment
    tab_to(page, dashboard.time.get_by_role("button", name=re.compile("^Play")))
    page.keyboard.press("Home")
    expect(moment).to_have_value("0")
    page.keyboard.press("]")
    expect(moment).not_to_have_value("0")
    disturbed_s = float(moment.input_value())
    page.keyboard.press("]")
    expect(moment).not_to_have_value(str(disturbed_s))
    page.keyboard.press("[")
    expect(moment).to_have_value(str(disturbed_s))
    page.keyboard.press("End")
    expect(dashboard.headline).to_have_text(re.compile("^Greedy wins"))
    assert moment.input_value() == moment.get_attribute("max")
