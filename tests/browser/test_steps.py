"""Step by step through a practice: why, how the values changed, and the whole table."""

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}


def send(dashboard: Dashboard, method: str, path: str, body: dict[str, Any]) -> dict[str, Any]:
    """Return the API's answer to a request of the page."""
    answer: dict[str, Any] = dashboard.page.evaluate(
        """([path, method, body]) => fetch(path, {
            method, body: JSON.stringify(body), headers: {"Content-Type": "application/json"},
        }).then(answer => answer.json())""",
        [f"/api/v1/{path}", method, body],
    )
    return answer


def finished(dashboard: Dashboard, path: str, body: dict[str, Any]) -> str:
    """Start a run, wait for its end, and return its id."""
    run_id: str = send(dashboard, "POST", path, {**WALK, **body})["id"]
    is_done = f"/api/v1/{path}/{run_id}"
    dashboard.eventually(lambda: dashboard.get(is_done)["state"] == "finished", f"{path} ends")
    return run_id


def explained(dashboard: Dashboard, run_id: str, time_s: float) -> Locator:
    """Hold a moment of a run on the stage, and return the panel that explains it."""
    send(dashboard, "PUT", "stage", {"run_id": run_id, "time_s": time_s, "playing": False})
    panel = dashboard.page.get_by_role("region", name="Step by step")
    panel.get_by_role("button", name="Explain this step").click()
    return panel


def explanation(panel: Locator) -> Locator:
    """The part of the panel that explains a step."""
    return panel.get_by_role("region", name=re.compile("explained$"))


def test_a_practice_is_explained_step_by_step(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    dashboard.open(shared_server.address)
    run_id = finished(dashboard, "trainings", {"steps": 120, "agent": "q-learning"})
    panel = explained(dashboard, run_id, 5.0)
    told, step = explanation(panel), panel.get_by_role("textbox", name="Step")

    # It follows the stage, and tells the step as the server explains it.
    expect(told).to_contain_text("Q-learning moved legs")
    number = int(step.input_value())
    assert 1 < number < 120
    answer = dashboard.get(f"/api/v1/runs/{run_id}/explain?step={number}")
    expect(told).to_contain_text(answer["choice"]["sentences"][0])
    expect(told).to_contain_text("new value = (1 − α)")
    expect(told).to_contain_text("stored value to the last bit")
    read = panel.get_by_test_id("heat-read").locator("b")
    pair, cell = answer["action"]
    moved = f"Legs {'+'.join(map(str, answer['pairs'][pair]))} to {answer['cell_names'][cell]}"
    expect(read).to_contain_text(f"{moved}: ")
    assert dashboard.violations() == []

    # Forward, back, and any step by its number; then the stage again.
    panel.get_by_role("button", name="One step forward").click()
    expect(step).to_have_value(str(number + 1))
    expect(panel.get_by_role("heading", name=f"Step {number + 1}, explained")).to_be_visible()
    step.fill("1")
    step.press("Enter")
    expect(told).to_contain_text("It explores")
    expect(panel.get_by_role("heading", name="The whole table before step 1")).to_be_visible()
    expect(panel).to_contain_text("0 % of 1500 moves tried")
    expect(panel.get_by_role("button", name="One step back")).to_be_disabled()
    step.fill("120")
    step.press("Enter")
    expect(panel).to_contain_text(re.compile(r"[1-9] % of 1500"))
    # Its explanation, which comes apart from its table, has the move that was made.
    expect(panel.get_by_role("heading", name="Step 120, explained")).to_be_visible()

    # The table by keys and by pointer; without either it is at the move that was made.
    grid, made = panel.get_by_role("grid"), read.inner_text()
    grid.focus()
    for key in ("Home", "PageUp", "PageDown", "ArrowUp", "End", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
    expect(panel.get_by_role("gridcell")).to_contain_text("legs 3+6 to back left")
    expect(panel.locator(".heat-cell")).to_be_visible()
    page.keyboard.press("Escape")
    expect(read).to_have_text(made)
    grid.hover(position={"x": 3, "y": 3})
    expect(read).to_contain_text("Legs 1+4 to home")

    panel.get_by_role("button", name="Follow the stage").click()
    expect(step).to_have_value(str(number))
    page.set_viewport_size({"width": 360, "height": 780})
    expect(grid).to_be_visible()
    assert dashboard.scroll_width() == 360
    page.emulate_media(color_scheme="dark")
    assert dashboard.violations() == []


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
    dashboard.open(shared_server.address)
    run_id = finished(dashboard, "trainings", {"steps": 40, "agent": "q-learning"})
    panel = explained(dashboard, run_id, 5.0)
    grid, note = panel.get_by_role("grid"), panel.locator(".heat-note")
    view = page.frame(url=re.compile("/viewer/"))
    assert view is not None

    # A click in the table draws the ghost; another moves it, and Escape takes it away.
    grid.click(position={"x": 3, "y": 3})
    expect(note).to_contain_text(
        "The ghost in the scene stands in this state: legs 1+4 home, legs 2+5 home, legs 3+6 home"
    )
    view.wait_for_function(HAS_NODE, arg=f"{GHOST}/0")
    grid.hover(position={"x": 3, "y": 40})
    expect(note).to_contain_text("stands in the chosen state")
    note.hover()
    expect(panel.get_by_test_id("heat-read")).to_contain_text("legs 3+6 home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(note).to_contain_text("legs 3+6 front left")
    assert dashboard.violations() == []
    page.keyboard.press("Escape")
    view.wait_for_function(f"name => !({HAS_NODE})(name)", arg=GHOST)
    expect(note).to_contain_text("A click puts a ghost")

    # A cell in the scene is found in the table, whose panel opens.
    panel.get_by_role("button", name="Close").click()
    dashboard.view.owner.scroll_into_view_if_needed()
    cells = "/world/run/lane0/grid/others/fills"
    place = view.evaluate(PLACE_OF_CELL, [cells, 2 * 4 + 1])
    dashboard.view.owner.click(position=place)
    expect(note).to_contain_text("Clicked in the scene: legs 3+6 to front right.")
    expect(panel.get_by_test_id("heat-read")).to_contain_text("Legs 3+6 to front right: ")
    expect(grid).to_be_in_viewport()
    # It stays in view while the rest of the page loads, which the panel's opening had scrolled to.
    page.evaluate("document.querySelector('main').append(document.createElement('hr'))")
    page.wait_for_timeout(200)
    expect(grid).to_be_in_viewport()


def test_lanes_of_a_race_are_explained(dashboard: Dashboard, shared_server: Serving) -> None:
    dashboard.open(shared_server.address)
    training = finished(dashboard, "trainings", {"steps": 60})
    lanes = [{"agent": "q-learning", "training_id": training}, {"agent": "greedy"}]
    race = finished(dashboard, "races", {"steps": 6, "lanes": lanes})
    panel = explained(dashboard, race, 1.0)

    expect(explanation(panel)).to_contain_text("it does not learn here")
    expect(panel).to_contain_text("at the end of its practice")
    panel.get_by_role("group", name="Lane").get_by_role("button", name="Greedy").click()
    expect(explanation(panel)).to_contain_text("Greedy moved legs")
    expect(explanation(panel)).to_contain_text("It simulated 12 steps before it took this one")
    expect(explanation(panel).get_by_role("row")).to_have_count(6)
    expect(panel).to_contain_text("This lane has no table of a training")
    assert dashboard.violations() == []
