"""A robot from a file is seen and corrected on the page before it is stored."""

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.conftest import new_page
from tests.features.robots.browser.files import choose_file, hand, panel_of
from tests.features.robots.browser.test_body_editor import NARROW, SHORT, THUMB_PX
from tests.imports.robots import HOME, SIX, bug, dog

pytestmark = pytest.mark.timeout(300)

FRONTLESS = {f"leg{number}": place for number, place in enumerate(SIX.values())}
"""Legs whose names tell nothing of what is in front."""


def opened(dashboard: Dashboard, server: Serving, **state: object) -> None:
    """Open the page without a turning picture."""
    dashboard.page.emulate_media(reduced_motion="reduce")
    fields = {**SHORT, "depth": "study", "tab": "train", "simulator": "mujoco", **state}
    dashboard.open(server.link(**fields))


def stored(dashboard: Dashboard) -> list[Any]:
    robots: list[Any] = dashboard.get("/api/v1/robots")["items"]
    return robots


def keep(dashboard: Dashboard, panel: Locator) -> Any:
    """Keep the robot, under the name that it has, and return it as it is stored."""
    before = len(stored(dashboard))
    button = panel.get_by_role("button", name="Keep")
    expect(button).not_to_have_attribute("aria-disabled", "true")
    button.click()
    expect(panel).to_be_hidden()
    robots = stored(dashboard)
    assert len(robots) == before + 1
    return robots[-1]


def decided(robot: Any) -> dict[str, Any]:
    """Return the decisions with which a robot is stored."""
    return {name: value for name, value in robot["choices"].items() if value is not None}


def told(panel: Locator, words: str | re.Pattern[str]) -> None:
    expect(panel.locator("p.sr-only[role=status]")).to_contain_text(words)


def test_seven_robots_are_corrected_without_typing(
    dashboard: Dashboard, server: Serving, tmp_path: Path
) -> None:
    opened(dashboard, server)
    page = dashboard.page

    # Forward: dropped anywhere on the page.
    panel = hand(dashboard, {"ant.urdf": bug(FRONTLESS)})
    assert dashboard.violations_in_both_themes() == []
    panel.get_by_role("button", name="Forward along −x").click()
    told(panel, "forward along −x")
    assert decided(keep(dashboard, panel))["forward"] == "-x"

    # Feet: of six legs the middle ones are none.
    panel = hand(dashboard, {"six.urdf": bug()})
    page.get_by_role("button", name="Feet", exact=True).click()
    for foot in ("tibia_lm", "tibia_rm"):
        panel.get_by_role("checkbox", name=foot, exact=True).uncheck()
    told(panel, "4 legs")
    robot = keep(dashboard, panel)
    assert sorted(decided(robot)["feet"]) == ["tibia_lf", "tibia_lr", "tibia_rf", "tibia_rr"]
    assert len(robot["legs"]) == 4

    # Groups: each leg by itself.
    panel = hand(dashboard, {"spider.urdf": bug()})
    page.get_by_role("button", name="Groups", exact=True).click()
    groups = panel.get_by_role("group", name="Groups")
    groups.get_by_role("button", name="Leg 2 of group 2").click()
    told(panel, "groups 1+3+5, 4+6, 2")
    groups.get_by_role("button", name="Leg 4 of group 2").click()
    told(panel, "groups 1+3+5, 6, 2+4")
    assert keep(dashboard, panel)["groups"] == [[1, 3, 5], [6], [2, 4]]

    # Stance: lower, by a slider.
    panel = hand(dashboard, {"spot.xml": dog(keyframes={"home": HOME})})
    height = panel.get_by_role("slider", name="Height")
    before_m = float(height.input_value())
    for _ in range(5):
        height.press("ArrowLeft")
    told(panel, re.compile("stands 0.2"))
    assert decided(keep(dashboard, panel))["body_height_m"] < before_m

    # A scale that is offered.
    panel = hand(dashboard, {"huge.urdf": longer(bug(), 10)})
    panel.get_by_role("button", name="Read it at 1:10", exact=True).click()
    told(panel, "stands 0.1")
    assert decided(keep(dashboard, panel)) == {"scale": 0.1}

    # Its lengths are in millimetres: it is shown, too, though it is none yet.
    panel = hand(dashboard, {"large.urdf": longer(bug(), 1000)})
    expect(panel.get_by_role("alert")).to_contain_text("250 m long")
    expect(panel.get_by_role("button", name="Keep")).to_have_attribute("aria-disabled", "true")
    panel.get_by_label("Lengths are in").select_option("millimetres")
    told(panel, "6 legs")
    expect(panel.get_by_role("alert")).to_have_count(0)
    assert decided(keep(dashboard, panel)) == {"scale": 0.001}

    # Another document of the folder.
    panel = hand(dashboard, {"six.urdf": bug(), "spot.xml": dog(keyframes={"home": HOME})})
    document = panel.get_by_label("Document")
    other, words = {"spot.xml": ("six.urdf", "6 legs"), "six.urdf": ("spot.xml", "4 legs")}[
        document.input_value()
    ]
    document.select_option(other)
    told(panel, words)
    assert decided(keep(dashboard, panel)) == {"file": other}

    assert len({robot["name"] for robot in stored(dashboard)}) == len(stored(dashboard)) == 7


def longer(urdf: str, times: float) -> str:
    """Return a URDF with lengths of so many times what they were."""

    def multiplied(match: re.Match[str]) -> str:
        name, values = match.groups()
        return f'{name}="{" ".join(str(times * float(value)) for value in values.split())}"'

    return re.sub(r'((?<=origin )xyz|size|radius|length)="([^"]+)"', multiplied, urdf)


def test_a_refused_robot_is_mended_by_choosing_its_feet(
    dashboard: Dashboard, server: Serving
) -> None:
    opened(dashboard, server)
    # Its legs behind are drawn in: those in front alone reach the ground.
    lame = re.sub(r'(<body name="R._thigh" pos="[^"]+")', r'\1 euler="0 -1.5 0"', dog(limits=False))
    panel = hand(dashboard, {"lame.xml": lame}, "paste")
    expect(panel.get_by_role("alert")).to_contain_text("Found 2 legs")
    expect(panel.get_by_text("Choose its feet, in the picture or below")).to_be_visible()
    for foot in ("FL", "FR", "RL", "RR"):
        panel.get_by_role("checkbox", name=foot, exact=True).check()
    told(panel, "4 legs")
    assert dashboard.violations() == []
    assert sorted(decided(keep(dashboard, panel))["feet"]) == ["FL", "FR", "RL", "RR"]


def test_what_is_decided_can_be_undone_and_what_is_wrong_is_told(
    dashboard: Dashboard, server: Serving, tmp_path: Path
) -> None:
    opened(dashboard, server)
    (tmp_path / "bad.xml").write_text("<mujoco")
    panel = choose_file(dashboard, tmp_path / "bad.xml")
    expect(panel.get_by_role("alert")).to_contain_text("XML")
    assert [complaint.split()[0] for complaint in dashboard.complaints] == ["422"]
    dashboard.complaints.clear()
    expect(panel.get_by_role("button", name="Keep")).to_have_count(0)
    panel.get_by_role("button", name="Leave this robot").click()
    expect(panel).to_be_hidden()
    expect(dashboard.panel.get_by_role("tab", name="Train")).to_be_visible()

    panel = hand(dashboard, {"spot.xml": dog(keyframes={"home": HOME})})
    dashboard.page.get_by_role("button", name="Feet", exact=True).click()
    for foot in ("FL", "FR"):
        panel.get_by_role("checkbox", name=foot, exact=True).uncheck()
    expect(panel.get_by_role("alert")).to_have_text("Choose at least 3 feet; 2 so far.")
    expect(panel.get_by_role("button", name="Train")).to_have_attribute("aria-disabled", "true")
    undo = panel.get_by_role("button", name="Undo")
    undo.click()
    undo.click()
    expect(undo).to_have_attribute("aria-disabled", "true")
    expect(panel.get_by_role("alert")).to_have_count(0)
    expect(panel.get_by_role("button", name="Keep")).not_to_have_attribute("aria-disabled", "true")
    scale = panel.get_by_label("Scale")
    panel.get_by_text("Units and servos").click()
    scale.fill("0")
    scale.press("Enter")
    expect(panel.get_by_text("A number from 0.001 to 1,000.")).to_be_visible()


def test_a_robot_is_read_corrected_and_trained_by_keyboard_alone(
    dashboard: Dashboard, server: Serving
) -> None:
    opened(dashboard, server)
    page = dashboard.page
    panel = hand(dashboard, {"spot.xml": dog(keyframes={"home": HOME})}, "paste")
    panel.get_by_role("button", name="Leave this robot").focus()
    tab_to(page, "Forward along y")
    page.keyboard.press("Enter")
    told(panel, "forward along y")
    tab_to(page, "Leg 1 of group 1: move it to the next")
    page.keyboard.press("Space")
    told(panel, "groups 3, 1+2+4")
    tab_to(page, "Train")
    expect(panel.get_by_role("button", name="Train")).not_to_have_attribute("aria-disabled", "true")
    page.keyboard.press("Enter")
    expect(panel).to_be_hidden()
    (robot,) = stored(dashboard)
    assert decided(robot)["forward"] == "y"
    assert robot["groups"] == [[3], [1, 2, 4]]
    dashboard.eventually(
        lambda: (
            [
                run["config"]["robot"].get("id")
                for run in dashboard.get("/api/v1/trainings")["items"]
            ]
            == [robot["id"]]
        ),
        "a training of the robot",
    )


def tab_to(page: Page, name: str) -> None:
    """Press Tab until the focus is at what has a name."""
    names = []
    for _ in range(40):
        page.keyboard.press("Tab")
        focused = "document.activeElement"
        names.append(page.evaluate(f"{focused}.ariaLabel ?? {focused}.textContent.trim()"))
        if names[-1] == name:
            return
    raise AssertionError(f"{name} is not among: {names}")


def test_a_stored_robot_is_corrected_in_the_same_view(
    dashboard: Dashboard, server: Serving
) -> None:
    opened(dashboard, server)
    robot = keep(dashboard, hand(dashboard, {"spot.xml": dog(keyframes={"home": HOME})}))
    robots = listed(dashboard)
    robots.get_by_role("button", name="Choose").click()
    robots.get_by_role("button", name=f"Correct {robot['name']}").click()
    panel = panel_of(dashboard)
    expect(panel.get_by_label("Name")).to_have_value(robot["name"])
    panel.get_by_role("button", name="Forward along −x").click()
    told(panel, "forward along −x")
    panel.get_by_role("button", name="Save").click()
    expect(panel).to_be_hidden()
    (after,) = stored(dashboard)
    assert (after["name"], decided(after)["forward"]) == (robot["name"], "-x")
    # It is another robot, and is chosen in place of the one before.
    expect(dashboard.page).to_have_url(re.compile(f"robot={after['id']}"))
    expect(dashboard.button("Edit the body…")).to_be_disabled()


def listed(dashboard: Dashboard) -> Locator:
    dashboard.button("Your robots…").first.click()
    return dashboard.page.get_by_role("dialog", name="Your robots")


def test_the_view_on_a_phone(flat_browser: Browser, server: Serving) -> None:
    with new_page(flat_browser, viewport=NARROW, has_touch=True, is_mobile=True) as page:
        dashboard = Dashboard(page, has_3d=False)
        opened(dashboard, server)
        panel = hand(dashboard, {"six.urdf": bug()})
        page.get_by_role("button", name="Feet", exact=True).tap()
        expect(panel.get_by_role("checkbox", name="tibia_lm", exact=True)).to_be_visible()
        assert dashboard.scroll_width() == NARROW["width"]
        assert dashboard.violations() == []
        assert dashboard.small_targets(THUMB_PX) == []
        assert dashboard.complaints == []


@pytest.mark.looks_at_3d
def test_the_picture_is_corrected_by_pointer_and_keys(
    dashboard: Dashboard, server: Serving
) -> None:
    opened(dashboard, server)
    page = dashboard.page
    panel = hand(dashboard, {"spot.xml": dog(keyframes={"home": HOME})})
    forward = page.get_by_role("slider", name="Forward")
    expect(forward).to_have_attribute("aria-valuetext", "along x of its torso")
    assert overlaps(page) == []
    assert dashboard.violations() == []

    forward.press("ArrowLeft")
    forward.press("ArrowLeft")
    expect(forward).to_have_attribute("aria-valuenow", "30")
    told(panel, "forward along 30° from x")
    forward.press("Shift+X")
    told(panel, "forward along −x")
    # By pointer to the other end of the turntable.
    tip, legs = place_at_rest(page, forward), page.get_by_role("group", name="Legs")
    middle = middle_of([box_of(leg) for leg in legs.get_by_role("button").all()])
    page.mouse.move(*tip)
    page.mouse.down()
    page.mouse.move(*middle, steps=3)
    page.mouse.move(*(2 * middle[axis] - tip[axis] for axis in (0, 1)), steps=3)
    page.mouse.up()
    told(panel, re.compile(r"forward along (x|−?(15|30)° from x),"))

    leg = legs.get_by_role("button", name="Leg 2, group 2")
    leg.click()
    told(panel, "4, 2")
    # A click on a link itself, in the 3D view: between the knee and the foot.
    page.get_by_role("button", name="Feet", exact=True).click()
    feet = page.get_by_role("group", name="Possible feet")
    foot = feet.get_by_role("button", name="Foot RL", exact=True)
    knee = feet.get_by_role("button", name="Foot RL_thigh", exact=True)
    expect(foot).to_have_attribute("aria-pressed", "true")
    page.mouse.click(*middle_of([place_at_rest(page, foot), box_of(knee)]))
    told(panel, "3 legs")
    shank = feet.get_by_role("button", name="Foot RL_calf", exact=True)
    expect(shank).to_have_attribute("aria-pressed", "false")
    # Guesses are tags, in the order of the list; one that is clicked is shown there.
    tags = page.get_by_role("list", name="Guesses in the picture")
    tags.get_by_role("button", name=re.compile("^Stance It stands")).click()
    expect(panel.locator(".reading-notes .shown")).to_contain_text("Stance")
    assert overlaps(page) == []


def box_of(locator: Locator) -> tuple[float, float]:
    """Return the middle of an element [px]."""
    box = locator.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def place_at_rest(page: Page, locator: Locator) -> tuple[float, float]:
    """Return the middle of an element once the picture moves no more [px]."""
    before, now = (0.0, 0.0), box_of(locator)
    while now != before:
        page.wait_for_timeout(800)
        before, now = now, box_of(locator)
    return now


def middle_of(points: list[tuple[float, float]]) -> tuple[float, float]:
    xs, ys = zip(*points, strict=True)
    return sum(xs) / len(xs), sum(ys) / len(ys)


def overlaps(page: Page) -> list[str]:
    """Return what of tags, controls and legs lies over each other, by their texts."""
    pairs: list[str] = page.evaluate(_OVERLAPS)
    return pairs


_OVERLAPS = """() => {
  const drawn = ".reading-tags li, .reading-controls > *, .reading-legs button, .arrow-handle";
  const all = [...document.querySelectorAll(drawn)].map(element =>
    ({
      name: element.textContent.trim().slice(0, 20),
      ...element.getBoundingClientRect().toJSON(),
    }));
  const meet = (a, b) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  return all.flatMap((one, n) => all.slice(n + 1)
    .filter(other => meet(one, other)).map(other => `${one.name} | ${other.name}`));
}"""
