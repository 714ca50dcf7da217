"""Disturbances: a leg is broken in practice, and a race goes on from its middle."""

import re
from collections import Counter
from typing import Any
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

BENDS = {"agent": "linear-model", "gait": "left-right-vertical", "evaluate_every": 20}
"""In this gait the learner walks well after 40 steps, and badly without legs 3 and 6."""
LONG = urlencode({"steps": 100_000, "pace": 8, **BENDS})
IDEAL = urlencode({"steps": 100_000, "pace": 8, "simulator": "kinematic"})


def changes(dashboard: Dashboard) -> list[dict[str, Any]]:
    """Return what has happened to the newest training."""
    training = dashboard.get("/api/v1/trainings")["items"][0]
    return [change["disturbance"] for change in training["changes"]]


def disturbances_now(dashboard: Dashboard) -> Locator:
    """Return the region of the disturbances of the robot that practises, with its controls."""
    return dashboard.page.get_by_role("region", name="Disturbances now", exact=True)


def test_a_leg_is_broken_while_a_robot_practises(
    dashboard: Dashboard, flat_browser: Browser, shared_server: Serving
) -> None:
    page = dashboard.page
    page.set_viewport_size({"width": 1920, "height": 1080})
    dashboard.open(f"{shared_server.address}?{LONG}&depth=study&tab=train")
    # Where there is room, the curve stays beside the controls.
    dashboard.button("Pin this tab").click()
    dashboard.open_tab("World")
    expect(page.get_by_role("group", name="Legs, seen from above")).to_have_count(0)
    dashboard.open_tab("Board")
    dashboard.button("Train, don’t race").click()
    dashboard.open_tab("World")
    pinned = page.get_by_role("region", name="Pinned: Train")
    curve = pinned.get_by_role("img", name=re.compile("^Learning curve"))
    walks = re.compile(r"^Learning curve: 0\.[45]\d\sm after.*; best known 0\.5\d\sm\.$")
    expect(curve).to_have_accessible_name(walks)
    leg = page.get_by_role("button", name=re.compile("^Leg 3(?!, in group)"))
    expect(leg).to_have_attribute("aria-pressed", "false")
    leg.press("Space")
    dashboard.button("Leg 6").click()  # before the first is answered
    expect(leg).to_have_accessible_name("Leg 3, limp")
    expect(leg).to_have_attribute("aria-pressed", "true")
    now = disturbances_now(dashboard)
    expect(now).to_contain_text(re.compile(r"Now: legs\s3, 6 limp"))
    happened = pinned.get_by_text(re.compile("^Happened: "))
    expect(happened).to_contain_text(re.compile(r"^Happened: legs?\s3.* limp from step \d+"))
    happenings = page.get_by_role("listitem").filter(has=dashboard.button("Go there"))
    expect(happenings.first).to_contain_text(re.compile(r"^step \d+ Legs?\s3.* limp"))
    expect(curve).to_have_accessible_name(re.compile(r": −?0\.[012]\d\sm after"))

    tells_others(flat_browser, shared_server)
    kind = page.get_by_label("A press on a leg")
    kind.select_option("Stuck joint")
    page.get_by_label("Joint").select_option("tibia")
    # It reaches no further than the tibia.
    expect(page.get_by_role("slider", name="Angle")).to_have_attribute("max", "0")
    page.get_by_label("Angle, as a number").fill("-1.5")
    dashboard.button("Leg 1").click()
    expect(now).to_contain_text("tibia stuck at −1.5\u00a0rad")
    changes_its_ground(dashboard)
    dashboard.button("Leg 1, tibia stuck").click()
    kind.select_option("Repaired legs")
    dashboard.button("Leg 1").click()  # it works already
    for number in (3, 6):
        dashboard.button(f"Leg {number}, limp").click()
    expect(now).to_contain_text("The robot is as it was built")
    expect(curve).to_have_accessible_name(walks)
    kinds = Counter(change["kind"] for change in changes(dashboard))
    assert kinds == {"limp": 2, "stuck": 1, "slope": 3, "friction": 2, "repair": 3}
    dashboard.button("Stop").click()
    page.get_by_role("link", name="Runs").click()
    expect(dashboard.runs.first).to_contain_text(re.compile(r"slope 8°.* from step \d+"))
    only_sensors_of_an_ideal_robot(dashboard, shared_server)


def changes_its_ground(dashboard: Dashboard) -> None:
    """A slope and another friction begin, and end."""
    page, now = dashboard.page, disturbances_now(dashboard)
    page.get_by_role("slider", name="Slope", exact=True).fill("8")
    expect(now).to_contain_text("slope 8°")
    page.get_by_role("slider", name="Slope: Direction").fill("90")
    expect(now).to_contain_text("slope 8°, direction 90°")
    page.get_by_role("slider", name="Friction").fill("0.5")
    words = now.get_by_role("status").first
    expect(words).to_contain_text("friction 0.5")
    assert dashboard.violations() == []
    page.get_by_role("slider", name="Slope", exact=True).fill("0")
    dashboard.button("Friction as built").click()
    expect(words).not_to_contain_text("friction")


def tells_others(browser: Browser, server: Serving) -> None:
    """Conditions are told over the picture, on a phone too."""
    with new_page(browser, viewport={"width": 360, "height": 780}) as page:
        other = Dashboard(page, has_3d=False)
        other.open(server.address)
        expect(other.labels).to_contain_text(re.compile(r"Legs\s3, 6 limp"))
        assert other.scroll_width() == 360
        assert other.complaints == []


def only_sensors_of_an_ideal_robot(dashboard: Dashboard, server: Serving) -> None:
    """It has no ground and no servos."""
    page = dashboard.page
    dashboard.open(f"{server.address}?{IDEAL}&depth=study&tab=train")
    dashboard.button("Train, don’t race").click()
    dashboard.open_tab("World")
    expect(disturbances_now(dashboard)).to_contain_text("only sensor noise can happen there")
    expect(dashboard.button("Leg 1")).to_have_attribute("aria-disabled", "true")
    expect(page.get_by_role("slider", name="Slope", exact=True)).to_be_disabled()
    dashboard.unfold("Ground, load and servos")
    page.get_by_role("slider", name="Sensor noise").fill("0.004")
    expect(disturbances_now(dashboard)).to_contain_text(re.compile(r"sensor noise 4\smm"))
    dashboard.button("Stop").click()
    # The next test on this server starts a race, which cannot be while this one practises.
    expect(dashboard.primary).to_have_text(re.compile("^Train "))


LONGEST_STEP_S = 0.6
"""Of a robot with its thinking; a race parts at the beginning of the step in the picture."""


@pytest.mark.looks_at_3d
def test_a_race_goes_on_from_its_middle(dashboard: Dashboard, shared_server: Serving) -> None:
    with_3d = dashboard
    dashboard = Dashboard(with_3d.page.context.new_page(), has_3d=False)
    page = dashboard.page
    dashboard.open(shared_server.link(lanes="greedy,informed", depth="study", tab="board"))
    race_to_its_end(dashboard)
    board = dashboard.scoreboard
    expect(board.get_by_role("row", name=re.compile(r"Best known 0\.51\sm$"))).to_be_visible()
    chart = page.get_by_role("img", name=re.compile(r"^The race after"))
    expect(chart).to_have_accessible_name(re.compile(r"; best known 0\.51\sm\.$"))
    dashboard.open_tab("World")
    branch = page.get_by_role("region", name="Disturb this race")
    expect(branch).to_contain_text(re.compile(r"From step [45]\d: as it was"))
    dashboard.moment.fill("1")
    has_both_parts_while_it_plays(dashboard)
    dashboard.button("Pause the stage").click()
    expect(branch).to_contain_text(re.compile(r"From step [12]?\d: as it was"))
    step_number = step_of(branch)
    start = dashboard.button("Race on from here")
    expect(start).to_be_disabled()
    dashboard.unfold("Ground, load and servos")
    page.get_by_role("spinbutton", name="Patch: To").fill("0.3")
    dashboard.button("Lay it").click()
    patch = re.compile(rf"From step {step_number}: patch .* to 0\.3\sm, friction 0\.05")
    expect(branch).to_contain_text(patch)
    dashboard.button("Undo all").click()
    expect(start).to_be_disabled()
    for leg in (1, 4):
        dashboard.button(f"Leg {leg}").click()
    expect(branch).to_contain_text(re.compile(rf"From step {step_number}: legs\s1, 4 limp"))
    assert dashboard.violations() == []
    goes_on_from_the_moment(dashboard, start)

    dashboard.open_tab("Board")
    expect(board).to_contain_text(re.compile(rf"The same as Race: .* before step {step_number}\."))
    show_its_end(dashboard)
    expect(board.get_by_text("Best known")).to_have_count(0)
    expect(chart).to_have_accessible_name(re.compile(r"Informed.*\d\sm\.$"))
    with_3d.open(shared_server.address)
    labels = with_3d.view.locator(".labels > div:not([hidden])")
    ghosts = labels.filter(has_text=re.compile(r"original 0\.\d\d\sm"))
    expect(ghosts).to_have_count(2)
    original, branch = (dashboard.get("/api/v1/races")["items"][n] for n in (1, 0))
    assert branch["config"]["branch_from"]["race_id"] == original["id"]
    expect(board.get_by_text(re.compile(r"Original: 0\.\d\d\sm at time-out"))).to_have_count(2)
    expect(board.get_by_text("plans with the nominal model")).to_have_count(2)
    assert dashboard.violations() == []
    page.get_by_role("link", name=original["name"]).click()
    expect(dashboard.runs).to_have_count(1)
    expect(dashboard.runs).to_contain_text(original["name"])
    assert dashboard.complaints == []
    page.close()

    branches_by_a_pick(with_3d, branch)


def has_both_parts_while_it_plays(dashboard: Dashboard) -> None:
    """What can be disturbed stays as it is; a change would hold the picture."""
    expect(dashboard.button("Pause the stage")).to_be_visible()
    for part in ("In this race", "In the next one"):
        expect(dashboard.page.get_by_role("heading", name=part)).to_be_visible()
    branch = dashboard.page.get_by_role("region", name="Disturb this race")
    expect(branch).to_contain_text("From the step shown: as it was")


def goes_on_from_the_moment(dashboard: Dashboard, start: Locator) -> None:
    """Press "Race on from here": the stage shows the new race where the old one was held."""
    stage_before = dashboard.get("/api/v1/stage")
    start.click()
    dashboard.eventually(
        lambda: dashboard.get("/api/v1/stage")["run_id"] != stage_before["run_id"],
        "the branch on stage",
    )
    assert dashboard.get("/api/v1/stage")["time_s"] > stage_before["time_s"] - LONGEST_STEP_S


def step_of(branch: Locator) -> str:
    """Return the step from which a branch would go on."""
    match = re.search(r"From step (\d+)", branch.inner_text())
    assert match is not None
    return match[1]


def branches_by_a_pick(dashboard: Dashboard, race: dict[str, Any]) -> None:
    """Disturb a leg that is picked in the picture, which starts a branch of the race there."""
    picks_a_leg(dashboard)
    dashboard.button("Stuck").click()
    dashboard.page.get_by_role("button", name=re.compile(r"^Race on from \d")).click()

    def newest() -> dict[str, Any]:
        config: dict[str, Any] = dashboard.get("/api/v1/races")["items"][0]["config"]
        return config

    dashboard.eventually(lambda: newest()["branch_from"]["race_id"] == race["id"], "a branch")
    last = newest()["disturbances"][-1]
    assert (last["kind"], last["leg"]) == ("stuck", 3)
    expect(dashboard.scoreboard).to_contain_text(f"The same as {race['name']} before")


def picks_a_leg(dashboard: Dashboard) -> None:
    """Pick a leg in the picture by keys, and then by a click; its menu stays open."""
    page = dashboard.page
    dashboard.choose_depth("Try")
    # The followed robot's legs are numbered: arrows choose, Enter opens, Escape closes.
    page.keyboard.press("2")
    page.keyboard.press("l")
    legs = page.get_by_role("group", name=re.compile("^Legs of Informed"))
    expect(legs.get_by_role("button")).to_have_count(6)
    expect(legs.get_by_role("button", name="Leg 1")).to_be_focused()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    menu = page.get_by_role("region", name=re.compile("^Informed.*, leg 3$"))
    expect(
        menu.get_by_role("group", name="What happens").get_by_role("button").first
    ).to_be_focused()
    assert dashboard.violations() == []
    place = legs.get_by_role("button", name="Leg 3").bounding_box()
    assert place is not None
    page.keyboard.press("Escape")
    expect(menu).to_have_count(0)
    expect(legs).to_have_count(0)

    # The same foot, by the pointer.
    page.mouse.click(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    expect(menu).to_contain_text(re.compile(r"Acts from \d+\.\d\ss, as a new race"))


def race_to_its_end(dashboard: Dashboard) -> None:
    """Start a race, wait until it is simulated, and skip its show."""
    with dashboard.page.expect_response(
        lambda response: response.request.method == "POST"
    ) as started:
        dashboard.primary.click()
    assert started.value.status == 202
    show_its_end(dashboard)


def show_its_end(dashboard: Dashboard) -> None:
    """Wait until the newest race is simulated, and skip its show."""

    def state() -> list[str]:
        return [race["state"] for race in dashboard.get("/api/v1/races?limit=1")["items"]]

    dashboard.eventually(lambda: state() == ["finished"], "its end")
    shown = dashboard.moment
    # Until the page knows where it ends, the key goes to what the page takes for computed: before
    # the photo finish, where the show ends too.
    expect(shown).to_have_attribute("aria-valuetext", re.compile(r"^\S+\ss of \S+\ss$"))
    shown.press("End")
    expect(shown).to_have_attribute("aria-valuetext", re.compile(r"^(\S+)\ss of \1\ss$"))
