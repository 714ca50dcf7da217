"""Step by step through a practice: why, how the values changed, and the whole table."""

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, finished, hold

pytestmark = pytest.mark.timeout(300)

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}


def explanation(page: Page) -> Locator:
    """Return the content of the tab "Why" for the step that is looked at."""
    return page.get_by_role("region", name="Explanation", exact=True)


def step_number(page: Page) -> Locator:
    """The number of that step, in the tabs that are about it."""
    return page.get_by_role("textbox", name="Step", exact=True)


@pytest.mark.test
def test_a_practice_is_explained_step_by_step(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        run = finished(api, "trainings", {**WALK, "steps": 120, "agent": "q-learning"})
        hold(api, run, 5.0)
    dashboard.open(shared_server.link(depth="study", tab="why"))
    explained, step = explanation(page), step_number(page)

    # It follows the stage, and tells the step as the server explains it.
    expect(explained).to_contain_text("Before the step: legs")
    number = int(step.input_value())
    assert 1 < number < 120
    answer = dashboard.get(f"/api/v1/runs/{run['id']}/explain?step={number}")
    # Three sentences, each in one place: what in the head, why and what it missed below.
    for sentence in (answer["why"], answer["missed"]):
        expect(explained.get_by_text(sentence, exact=True)).to_have_count(1)
    expect(explained).to_contain_text("new value = (1 − α)")
    expect(explained).to_contain_text("stored value to the last bit")
    # The head of the panel tells the move, and what came of it.
    pair, cell = answer["action"]
    legs, place = "+".join(map(str, answer["pairs"][pair])), answer["cell_names"][cell]
    expect(dashboard.headline).to_have_text(f"Legs {legs} to {place}")
    expect(dashboard.reason).to_have_text(answer["what"])
    expect(dashboard.panel.get_by_text(answer["what"], exact=True)).to_have_count(1)
    assert dashboard.violations() == []

    # Forward, back, and any step by its number; then the stage again.
    dashboard.button("One step forward").click()
    expect(step).to_have_value(str(number + 1))
    step.fill("1")
    step.press("Enter")
    expect(explained).to_contain_text("It explored: ")
    expect(dashboard.button("One step back")).to_be_disabled()
    reads_the_whole_table(dashboard, run["id"])
    dashboard.button("Follow the stage").click()
    expect(step).to_have_value(str(number))

    # Who watches has the reason, and a way back.
    dashboard.choose_depth("Watch")
    dashboard.panel.get_by_role("button", name=re.compile("^Explain")).click()
    expect(explained).to_contain_text("Why this move")
    expect(explained).not_to_contain_text("new value")
    dashboard.panel.get_by_role("button", name="Back to the board").click()
    expect(dashboard.scoreboard).to_be_visible()


def test_a_value_reads_the_same_in_every_view(dashboard: Dashboard, shared_server: Serving) -> None:
    """Of a learner over landings: its best move in the state that is shown."""
    page = dashboard.page
    with shared_server.api() as api:
        practice = {**WALK, "steps": 120, "agent": "afterstate-q", "pace": 8}
        run = finished(api, "trainings", practice)
        # Near its end it takes what it holds for best.
        hold(api, run, 37.5)
    dashboard.open(shared_server.link(depth="study", tab="why"))
    explained = explanation(page)
    made = explained.locator(".values td.next")
    expect(made).to_be_visible()
    number = int(step_number(page).input_value())
    answer = dashboard.get(f"/api/v1/runs/{run['id']}/explain?step={number}")
    pair, cell = answer["action"]
    value_m = answer["choice"]["scores"][pair][cell]
    text = f"{1000 * value_m:.1f}".replace("-", "−")
    said, colours = dict[str, str](), dict[str, str]()

    def shown(view: str, where: Locator, coloured: Locator | None = None) -> None:
        said[view] = where.inner_text().replace("\u00a0", " ")
        if coloured is not None:
            colours[view] = coloured.evaluate("cell => getComputedStyle(cell).backgroundColor")

    shown("values in this state", made, made)
    legend = page.locator(".legend")
    expect(legend).to_contain_text(re.compile(r"−?\d+\.\d[\s\S]*\d+\.\d\smm"))
    if answer["choice"]["kind"] == "exploited":
        shown("sentence", explained.get_by_text(answer["why"], exact=True))
    panel = dashboard.open_tab("Table")
    shown("table", panel.get_by_test_id("heat-read").locator("b"))
    landed = panel.locator(".is-landed")
    shown("landings", landed, landed.locator(".landing-value"))
    key = panel.locator(".heat .values-key")
    low, high = re.findall(r"−?\d+\.\d", key.inner_text())[:2]
    assert [low, high] == re.findall(r"−?\d+\.\d", legend.inner_text())[:2]
    # Where the stage is not followed the moves are ranked.
    dashboard.open_tab("Why")
    dashboard.button("One step back").click()
    dashboard.button("One step forward").click()
    expect(step_number(page)).to_have_value(str(number))
    expect(dashboard.reason).to_have_text(answer["what"])
    ranked = explained.get_by_role("row").filter(has_text=", made")
    shown("ranking", ranked, ranked.locator(".score-bar i"))

    assert all(
        re.search(rf"(?<![\d.]){re.escape(text)}(?!\d)", words) for words in said.values()
    ), said
    # The picture's values come to a hundredth of a millimetre, which is one of 256 shades at most.
    shades = [[int(part) for part in re.findall(r"\d+", colour)] for colour in colours.values()]
    assert all(max(channel) - min(channel) <= 1 for channel in zip(*shades, strict=True)), colours


def reads_the_whole_table(dashboard: Dashboard, run_id: str) -> None:
    """The table by keys and by pointer; without either it is at the move that was made."""
    answer = dashboard.get(f"/api/v1/runs/{run_id}/explain?step=120")
    pair, cell = answer["action"]
    move = f"Legs {'+'.join(map(str, answer['pairs'][pair]))} to {answer['cell_names'][cell]}: "
    page, step = dashboard.page, step_number(dashboard.page)
    panel = dashboard.open_tab("Table")
    expect(panel.get_by_role("heading", name="The whole table before step 1")).to_be_visible()
    expect(panel).to_contain_text("0 % of 1500 moves tried")
    step.fill("120")
    step.press("Enter")
    expect(panel).to_contain_text(re.compile(r"[1-9] % of 1500"))
    grid, read = panel.get_by_role("grid"), panel.get_by_test_id("heat-read").locator("b")
    expect(panel.get_by_role("heading", name="The whole table before step 120")).to_be_visible()
    # The table and the move of a step are two answers: until the second is there, the move is that
    # of the step before.
    expect(read).to_contain_text(move)
    before = read.inner_text()
    grid.focus()
    for key in ("Home", "PageUp", "PageDown", "ArrowUp", "End", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
    expect(panel.get_by_role("gridcell")).to_contain_text("legs 3+6 to back left")
    page.keyboard.press("Escape")
    expect(read).to_have_text(before)
    grid.hover(position={"x": 3, "y": 3})
    expect(read).to_contain_text("Legs 1+4 to home")
    assert dashboard.violations() == []
    page.set_viewport_size({"width": 360, "height": 780})
    page.emulate_media(color_scheme="dark")
    expect(grid).to_be_visible()
    assert dashboard.scroll_width() == 360
    assert dashboard.violations() == []
    page.set_viewport_size({"width": 1280, "height": 720})


GHOST = "/world/run/lane0/grid/posture"
HAS_NODE = "name => Boolean(__viserMutable.nodeRefFromName[name])"
# Of a cell of the foot grid in the window of the 3D view [px], as labels.js has that of labels.
PLACE_OF_CELL = """([name, instance]) => {
    const {camera, canvas, nodeRefFromName} = __viserMutable;
    const {batched_positions} = __viserSceneTree.getState()[name].message.props;
    const {buffer, byteOffset, byteLength} = batched_positions;
    const at = new Float32Array(buffer.slice(byteOffset, byteOffset + byteLength))
        .slice(3 * instance, 3 * instance + 3);
    const {x, y} = camera.position.clone().set(...at)
        .applyMatrix4(nodeRefFromName[name].matrixWorld).project(camera);
    return {x: (x + 1) / 2 * canvas.clientWidth, y: (1 - y) / 2 * canvas.clientHeight};
}"""


@pytest.mark.looks_at_3d
def test_a_state_is_shown_in_the_scene_and_found_from_it(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        hold(api, finished(api, "trainings", {**WALK, "steps": 40, "agent": "q-learning"}), 5.0)
    dashboard.open(shared_server.link(depth="study", tab="table"))
    panel = page.get_by_role("tabpanel", name="Table", exact=True)
    grid, note = panel.get_by_role("grid"), panel.locator(".heat-note")
    view = page.frame(url=re.compile("/viewer/"))
    assert view is not None

    # A click in the table draws the ghost; another moves it, and Escape takes it away.
    grid.click(position={"x": 3, "y": 1})
    state = re.compile(
        r"stands in this state: legs 1\+4 home, legs 2\+5 home, (legs 3\+6 [a-z ]+)\."
    )
    expect(note).to_contain_text(state)
    view.wait_for_function(HAS_NODE, arg=f"{GHOST}/0")
    match = state.search(note.inner_text())
    assert match is not None
    grid.hover(position={"x": 3, "y": 40})
    expect(note).to_contain_text("stands in the chosen state")
    note.hover()
    expect(panel.get_by_test_id("heat-read")).to_contain_text(match[1])
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(note).to_contain_text("legs 1+4 home, legs 2+5 home, legs 3+6")
    expect(note).not_to_contain_text(match[1])
    assert dashboard.violations() == []
    page.keyboard.press("Escape")
    view.wait_for_function(f"name => !({HAS_NODE})(name)", arg=GHOST)
    expect(note).to_contain_text("A click puts a ghost")

    # A cell in the scene is found in the table, whose tab opens.
    dashboard.open_tab("Board")
    cells = "/world/run/lane0/grid/others/fills"
    place = view.evaluate(PLACE_OF_CELL, [cells, 2 * 4 + 1])
    dashboard.view.owner.click(position=place)
    expect(note).to_contain_text("Clicked in the scene: legs 3+6 to front right.")
    expect(panel.get_by_test_id("heat-read")).to_contain_text("Legs 3+6 to front right: ")
    expect(grid).to_be_in_viewport()


@pytest.mark.test
def test_lanes_of_a_race_are_explained(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        practice = finished(api, "trainings", {**WALK, "steps": 60})
        lanes = [{"agent": "q-learning", "training_id": practice["id"]}, {"agent": "greedy"}]
        hold(api, finished(api, "races", {**WALK, "steps": 6, "lanes": lanes}), 1.0)
    dashboard.open(shared_server.link(depth="study", tab="why"))
    explained, lane = explanation(page), page.get_by_role("group", name="Lane", exact=True)

    expect(explained).to_contain_text("it does not learn here")
    expect(dashboard.open_tab("Table")).to_contain_text("at the end of its practice")
    lane.get_by_role("button", name="Greedy").click()
    expect(dashboard.panel).to_contain_text("This lane has no table of a training")
    dashboard.open_tab("Why")
    expect(explained).to_contain_text("It simulated 12 steps and compared the ")
    expect(explained.get_by_role("heading", name="Values in this state")).to_have_count(0)
    expect(explained.get_by_role("table").last.get_by_role("row")).to_have_count(6)
    assert dashboard.violations() == []


def test_a_learner_over_landings_has_a_row_for_each(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    with shared_server.api() as api:
        run = finished(api, "trainings", {**WALK, "steps": 60, "agent": "afterstate-q"})
    dashboard.open(shared_server.link(depth="study", tab="table", run=run["id"]))
    rows = page.get_by_role("region", name="Table of landings, the best first").get_by_role("row")

    expect(rows).to_have_count(1 + 125)
    expect(page.get_by_text(re.compile(r"\d+ of 125 came so far"))).to_be_visible()
    expect(page.get_by_role("heading", name="The same values by states and moves")).to_be_visible()
    assert dashboard.violations() == []


def test_why_a_learner_loses_is_asked_on_the_board(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    practice = {"steps": 60, "seed": 3}
    lanes = [{"agent": "q-learning", "training": practice}, {"agent": "greedy"}]
    with shared_server.api() as api:
        race = finished(api, "races", {**WALK, "steps": 20, "lanes": lanes})
        hold(api, race, 1e3)
    dashboard.open(shared_server.link(depth="try"))
    ask = dashboard.panel.get_by_role("button", name="Why does it lose?")
    expect(ask).to_have_count(1)  # not of greedy, which has won
    ask.click()

    explained = explanation(dashboard.page)
    answer = dashboard.get(f"/api/v1/races/{race['id']}/loss?lane=0")
    for sentence in answer["sentences"]:
        expect(explained).to_contain_text(sentence)
    expect(explained.get_by_text("Why does it lose?")).to_be_focused()
    assert dashboard.violations() == []
    dashboard.page.set_viewport_size({"width": 360, "height": 780})
    # The page learns of its new width a moment later.
    dashboard.page.wait_for_function("document.documentElement.scrollWidth === 360")

    # Where the server cannot tell it, it says so.
    dashboard.page.route(
        "**/loss?*",
        lambda route: route.fulfill(
            status=409,
            json={
                "type": "about:blank",
                "title": "Conflict",
                "status": 409,
                "detail": "It keeps no table.",
            },
        ),
    )
    dashboard.page.reload()
    explained.get_by_text("Why does it lose?").click()
    expect(explained).to_contain_text("Not told here: It keeps no table.")
    assert dashboard.complaints.pop().startswith("409")
