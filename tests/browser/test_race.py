"""The whole way: press the button, watch it learn and race, go on, stop."""

import re
from itertools import combinations
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Locator, Route, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

SHORT = urlencode({"steps": 8, "evaluate_every": 4, "race_steps": 3})
LONG = urlencode({"steps": 100_000, "pace": 8})
PRACTISES = re.compile(r"^Practising[,:] \d")
"""How far it is; where the picture is behind, first how far that is."""


@pytest.mark.test
@pytest.mark.looks_at_3d
def test_train_then_race_then_again(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{SHORT}&depth=study&tab=train")
    expect(dashboard.shown_run).to_have_text("On the start line")
    before = dashboard.picture()

    expect(dashboard.primary).to_have_text("Train 8 steps, then race")
    dashboard.primary.click()

    expect(dashboard.shown_run).to_contain_text("of 8")
    dashboard.open_tab("Board")
    expect(dashboard.standings).to_be_visible()
    dashboard.eventually(lambda: dashboard.picture() != before, "the robots move in the canvas")
    dashboard.eventually(dashboard.has_figures, "the scoreboard fills")
    verdict = re.compile(r"^\S.* (wins by \d+\s[cm]m|tie)$")
    expect(dashboard.headline).to_have_text(verdict)
    expect(page.get_by_role("status").filter(has_text=verdict)).to_be_attached()
    expect(dashboard.scoreboard).to_contain_text(
        re.compile(r"Ranked at time-out, .* 3 steps.* \(paper clock\)")
    )
    # The ranking is settled, and the others walk on for those who want to see it.
    dashboard.button("Keep watching").click()
    slowest = dashboard.rows.filter(has_text="Two-step")
    expect(slowest.get_by_role("cell", name="468", exact=True)).to_be_visible()
    expect(dashboard.button("Play the stage again")).to_be_visible()
    end_s = float(dashboard.moment.get_attribute("max") or 0)
    expect(slowest).to_contain_text(f"3 steps in 0:{int(end_s + 1e-3):02}")
    check_crosshairs(dashboard)
    assert dashboard.violations() == []
    expect(dashboard.open_tab("Why")).to_contain_text("What it missed")
    dashboard.open_tab("Board")
    for width, height in ((390, 844), (844, 390)):
        page.set_viewport_size({"width": width, "height": height})
        dashboard.eventually(lambda: overlaps(dashboard) == [], "labels apart from each other")
        expect(dashboard.primary).to_be_in_viewport(ratio=1)

    # Someone else goes on, without the 3D view: it takes most of the time of this test.
    page.close()
    dashboard = Dashboard(page.context.new_page(), has_3d=False)
    dashboard.open(f"{server.address}?{SHORT}&depth=study&tab=board")
    expect(dashboard.headline).to_have_text(verdict)
    check_widths_of_the_scoreboard(dashboard)
    expect(dashboard.primary).to_have_text("Practise 8 more, race again")
    dashboard.primary.click()
    dashboard.choose_depth("Watch")
    expect(dashboard.scoreboard).to_contain_text("16 steps of practice")
    expect(dashboard.primary).to_have_text("Practise 8 more, race again")

    runs = dashboard.get("/api/v1/trainings")["items"]
    assert [run["progress"]["done"] for run in runs] == [8, 8]
    assert runs[0]["config"]["continue_from"] == runs[1]["id"]
    assert dashboard.complaints == []


def check_crosshairs(dashboard: Dashboard) -> None:
    """Read the values of both charts by pointer, keys and finger."""
    page = dashboard.page
    race = page.get_by_role("slider", name="Values of the race")
    race.scroll_into_view_if_needed()
    box = race.bounding_box()
    assert box is not None
    finger = {"clientX": box["x"] + 1, "pointerType": "touch"}
    race.dispatch_event("pointerdown", finger)
    race.dispatch_event("pointerleave", finger)
    expect(race).to_contain_text(re.compile(r"^0\.0\ss.*Two-step 0\.00\sm"))
    expect(page.get_by_role("img", name=re.compile("^The race after .*Two-step"))).to_be_visible()

    train = dashboard.open_tab("Train")
    drawing = train.get_by_role("img", name=re.compile("^Learning curve: .*greedy gets"))
    expect(drawing).to_be_visible()
    curve = train.get_by_role("slider", name="Values of the learning curve")
    curve.hover()
    expect(curve).to_contain_text(re.compile(r"steps.*Q-learning −?\d\.\d\d\sm"))
    curve.press("Home")
    expect(curve).to_have_attribute(
        "aria-valuetext",
        re.compile(r"^0 steps: Q-learning 0\.00\sm, Greedy \d\.\d\d\sm, Best known 0\.51\sm$"),
    )
    curve.press("ArrowRight")
    expect(curve).to_have_attribute("aria-valuetext", re.compile("^4 steps: "))


def check_widths_of_the_scoreboard(dashboard: Dashboard) -> None:
    """Check that its columns stay in the panel; the viewport has another size then."""
    for width in (390, 800, 1280, 1440, 1920):
        dashboard.page.set_viewport_size({"width": width, "height": 900})
        # As wide as they get: backwards, after slow decisions with many simulated transitions, of
        # an agent whose settings are told.
        dashboard.rows.evaluate_all(
            """lanes => lanes.forEach(({rows: [{cells}]}) => {
                const texts = (cell) => {
                    const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
                    return walker.nextNode();
                };
                texts(cells[1]).data = "Informed search, budget 300";
                const widest = ["−0.36 m", "−0.36 m", "120 ms", "46 800"];
                [...cells].slice(2).forEach((cell, n) => (texts(cell).data = widest[n]));
            })"""
        )
        board, panel = dashboard.standings.bounding_box(), dashboard.panel.bounding_box()
        assert board is not None
        assert panel is not None
        assert board["x"] + board["width"] <= panel["x"] + panel["width"] - 16


def boxes(shown: Locator) -> list[tuple[str, dict[str, float]]]:
    """The text of each element, and where it lies in the window [px], all at one moment.

    Read one by one, an element that is hidden meanwhile would be waited for.
    """
    shown_boxes: list[tuple[str, dict[str, float]]] = shown.evaluate_all(
        """shown => shown.map(one => {
            const frame = window.frameElement?.getBoundingClientRect() ?? {x: 0, y: 0};
            const {x, y, width, height} = one.getBoundingClientRect();
            return [one.innerText, {x: x + frame.x, y: y + frame.y, width, height}];
        }).filter(([, {width}]) => width > 0)"""
    )
    return shown_boxes


def overlaps(dashboard: Dashboard) -> list[tuple[str, str]]:
    """Pairs of the stage's labels and chips that lie on each other, or what is missing."""
    frame = dashboard.view
    labels = boxes(frame.locator(".labels > div:not([hidden])"))
    if len(labels) < 3:
        return [("labels", f"{len(labels)} are shown")]
    chips = boxes(dashboard.labels.locator(".chip"))
    return [
        (words, other_words)
        for (words, box), (other_words, other_box) in combinations((*labels, *chips), 2)
        if box["x"] < other_box["x"] + other_box["width"]
        and other_box["x"] < box["x"] + box["width"]
        and box["y"] < other_box["y"] + other_box["height"]
        and other_box["y"] < box["y"] + box["height"]
    ]


def test_the_values_of_the_state_are_a_table(dashboard: Dashboard, server: Serving) -> None:
    dashboard.open(f"{server.address}?{LONG}&depth=study&tab=train")
    dashboard.button("Train, don’t race").click()
    panel = dashboard.open_tab("Why")
    values = panel.get_by_role("region", name="Values in this state").get_by_role("table")
    expect(values.get_by_role("rowheader")).to_have_count(3)
    expect(values.get_by_role("cell", name="here", exact=True)).to_have_count(3)
    expect(values.get_by_role("cell", name=re.compile(", its next move$"))).to_have_count(1)
    expect(dashboard.headline).to_have_text(re.compile(r"^Legs \d\+\d to (home|front|back)"))
    expect(values.get_by_role("cell", name=re.compile("^never")).first).to_be_visible()
    tried = values.get_by_role("cell", name=re.compile(r"tried \d"))
    expect(tried.first).to_have_text(re.compile(r"^−?\d+\.\d\s*[1-9]\d*×, tried \d+ times?"))
    assert dashboard.violations() == []


def test_rates_move_while_it_practises_and_it_stops(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?{LONG}&depth=study&tab=train")
    dashboard.primary.click()
    expect(
        page.get_by_text(re.compile(r"^Practising, \S+ of 100.000 steps, then the race$"))
    ).to_be_visible()

    page.get_by_role("slider", name="Learning rate α").fill("0.5")
    page.get_by_role("slider", name="Exploration now ε").fill("0.25")

    def changes() -> dict[str, float]:
        [training] = dashboard.get("/api/v1/trainings")["items"]
        return {
            k: v for change in training["changes"] for k, v in change.get("settings", {}).items()
        }

    dashboard.eventually(
        lambda: (changes().get("alpha"), changes().get("epsilon")) == (0.5, 0.25), "the new rates"
    )

    said = re.compile(r"^Changed: α\s0\.5 from step \d+, ε\s0\.25 from step \d+$")
    expect(page.get_by_text(said)).to_be_visible()
    other = Dashboard(page.context.new_page(), has_3d=False)
    other.open(f"{server.address}?depth=study&tab=train")
    alpha = other.page.get_by_role("slider", name="Learning rate α")
    expect(alpha).to_have_value("0.5")
    expect(other.page.get_by_role("slider", name="Exploration now ε")).to_have_value("0.25")
    expect(other.group("Settings")).to_contain_text(re.compile(r"with α\s0\.3, pace\smax\."))
    other.unfold("More settings")
    expect(other.page.get_by_label("Pace of practice")).to_have_value("8")
    alpha.fill("0.75")
    expect(page.get_by_role("slider", name="Learning rate α")).to_have_value("0.75")
    assert other.complaints == []
    other.page.close()

    expect(dashboard.button("Pause the stage")).to_be_visible()
    dashboard.button("Pause training").click()
    expect(page.get_by_text(re.compile("^Paused at "))).to_be_visible()
    expect(dashboard.button("Play the stage")).to_be_visible()
    dashboard.button("Resume training").click()
    expect(page.get_by_text(PRACTISES)).to_be_visible()

    dashboard.button("Stop").click()
    expect(dashboard.primary).to_have_text(re.compile("^Train "))
    page.get_by_role("link", name="Runs").click()
    expect(dashboard.runs.get_by_text("stopped", exact=True)).to_have_count(2)

    # Keys of the race do nothing here, and a menu closes as menus do.
    page.keyboard.press("r")
    row = dashboard.runs.first
    menu, inside = row.get_by_label("More for this"), row.get_by_role("button", name="As code")
    menu.click()
    expect(inside).to_be_visible()
    page.keyboard.press("Tab")
    page.keyboard.press("Escape")
    expect(inside).to_be_hidden()
    expect(menu).to_be_focused()
    menu.press("Enter")
    expect(inside).to_be_visible()
    page.get_by_role("heading", name="Runs").click()
    expect(inside).to_be_hidden()
    assert len(dashboard.get("/api/v1/trainings")["items"]) == 1


def test_no_click_is_lost_while_a_command_is_answered(
    dashboard: Dashboard, server: Serving
) -> None:
    """The event of the pause comes before its answer; the button waits for that."""
    page = dashboard.page

    def late(route: Route) -> None:
        page.wait_for_timeout(1500)
        route.continue_()

    dashboard.open(f"{server.address}?{LONG}&depth=try")
    dashboard.primary.click()
    expect(page.get_by_text(PRACTISES)).to_be_visible()
    page.route("**/api/v1/stage", late)
    dashboard.button("Pause training").click()
    expect(page.get_by_text(re.compile("^Paused at "))).to_be_visible()
    dashboard.button("Resume training").click()
    expect(page.get_by_text(PRACTISES)).to_be_visible()
    page.unroute_all(behavior="wait")
    dashboard.button("Stop").click()
    expect(dashboard.primary).to_have_text(re.compile("^Train "))


def test_a_refusal_stands_beside_the_button(dashboard: Dashboard, server: Serving) -> None:
    dashboard.open(f"{server.address}?{urlencode({'grid_side_m': 0.9})}")
    dashboard.primary.click()
    problem = dashboard.actions.get_by_role("alert").filter(has_text="cannot reach")
    expect(problem).to_contain_text("smaller Grid side than")
    assert [c.split()[0] for c in dashboard.complaints] == ["422"]
    dashboard.complaints.clear()
    dashboard.button("Dismiss").click()
    expect(problem).to_have_count(0)


def test_a_chart_tells_why_it_stays_empty(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    problem = {"title": "Gone", "detail": "The recording was deleted to make room."}
    answer = {"status": 410, "content_type": "application/problem+json", "json": problem}
    page.route("**/timeline?*", lambda route: route.fulfill(**answer))
    dashboard.open(server.link(lanes="greedy", race_steps=2, depth="try", tab="board"))
    chart = page.get_by_role("region", name="Distance against time", exact=True)
    expect(chart).to_contain_text("Each robot draws a line here")
    dashboard.primary.click()
    expect(chart.get_by_role("alert")).to_have_text(problem["detail"])
    expect(chart).not_to_contain_text(re.compile("draws a line|lines start"))
    page.unroute_all(behavior="wait")
    page.get_by_role("combobox", name="Clock").select_option("free")
    expect(chart.get_by_role("img", name=re.compile("^The race after .*Greedy"))).to_be_visible()
    expect(chart.get_by_role("alert")).to_have_count(0)
    assert {c.split()[0] for c in dashboard.complaints} == {"410"}
    dashboard.complaints.clear()


def test_two_operators_and_one_stage(
    dashboard: Dashboard, flat_browser: Browser, server: Serving
) -> None:
    link = f"{server.address}?{LONG}&depth=try"
    dashboard.open(link)
    dashboard.button("Train, don’t race").click()
    expect(dashboard.page.get_by_text(PRACTISES)).to_be_visible()
    run_on_stage = dashboard.get("/api/v1/stage")["run_id"]

    with new_page(flat_browser) as page:
        other = Dashboard(page, has_3d=False)
        other.open(link)
        other.button("Train, don’t race").click()
        expect(other.page.get_by_text("The stage shows another run")).to_be_visible()
        assert other.get("/api/v1/stage")["run_id"] == run_on_stage
        other.button("Show on the stage").click()
        expect(other.page.get_by_text("The stage shows another run")).to_have_count(0)
        assert other.get("/api/v1/stage")["run_id"] != run_on_stage
        assert other.complaints == []
    expect(dashboard.page.get_by_text("The stage shows another run")).to_be_visible()
