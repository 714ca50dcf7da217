"""The editor of the robot's body: by pointer, keys and fields, on a desk and on a phone."""

import re
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, ViewportSize, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.conftest import new_page

pytestmark = pytest.mark.timeout(300)

SHORT = {"steps": 6, "evaluate_every": 0, "simulator": "kinematic"}
NARROW: ViewportSize = {"width": 360, "height": 780}
THUMB_PX = 40


def opened(dashboard: Dashboard) -> Locator:
    dashboard.button("Edit the body…").click()
    editor = dashboard.page.get_by_role("dialog", name="Edit the body")
    expect(leg(editor, 1)).to_be_visible()
    return editor


def leg(editor: Locator, number: int) -> Locator:
    return editor.get_by_role("button", name=re.compile(rf"^Leg {number} of group"))


def preview_in(editor: Locator) -> Locator:
    return editor.get_by_role("group", name="Known before it walks")


def drag(page: Page, handle: Locator, right_px: float, down_px: float) -> None:
    box = handle.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right_px / 2, y + down_px / 2)
    page.mouse.move(x + right_px, y + down_px)
    page.mouse.up()


def robot_in(link: str) -> Any:
    return parse_qs(urlsplit(link).query)["robot"][0]


def finished(dashboard: Dashboard) -> list[Any]:
    """Return the robots of trainings that have ended, the newest first."""
    items = dashboard.get("/api/v1/trainings")["items"]
    return [run["config"]["robot"] for run in items if run["state"] == "finished"]


def use(editor: Locator) -> Locator:
    return editor.get_by_role("button", name="Use this body")


@pytest.mark.test
def test_a_body_is_edited_used_trained_and_opened_again(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    page = dashboard.page
    link = {**SHORT, "robot": "dog", "gait": "trot", "depth": "study", "tab": "train"}
    dashboard.open(shared_server.link(**link))
    editor = opened(dashboard)
    is_told_and_accessible(dashboard, editor)
    moved_m = move_legs(page, editor)
    add_legs_and_shorten_one(dashboard, editor)
    use(editor).click()
    expect(editor).to_be_hidden()
    expect(dashboard.button("Edit the body…")).to_be_focused()
    written = robot_in(page.url)
    assert written.count("tibia_m") == 2

    dashboard.button("Train, don’t race").click()
    dashboard.eventually(
        lambda: any(len(robot.get("legs", [])) == 6 for robot in finished(dashboard)),
        "a training with six legs of its own",
    )
    page.reload()
    editor = opened(dashboard)
    expect(preview_in(editor)).to_contain_text("6 legs: 25 states")
    expect(leg(editor, 1)).to_have_accessible_name(re.compile(f"{moved_m} m right, 0.11 m ahead"))
    # What is left with Escape changes nothing.
    leg(editor, 3).press("ArrowLeft")
    page.keyboard.press("Escape")
    expect(editor).to_be_hidden()
    assert robot_in(page.url) == written


def is_told_and_accessible(dashboard: Dashboard, editor: Locator) -> None:
    """The robot of the form is there, with what is known of it."""
    expect(leg(editor, 1)).to_have_accessible_name(
        "Leg 1 of group 1: 0.06 m right, 0.11 m ahead, points to 20°"
    )
    expect(preview_in(editor)).to_contain_text("4 legs: 25 states, 8 moves · stands by 0 mm")
    assert dashboard.violations_in_both_themes() == []


@pytest.mark.looks_at_3d
def test_the_body_stands_on_a_turntable_and_follows_what_is_edited(
    dashboard: Dashboard, shared_server: Serving
) -> None:
    dashboard.open(shared_server.link(robot="dog", gait="trot", depth="study", tab="train"))
    editor = opened(dashboard)
    picture = editor.get_by_role("slider", name="Direction from which the robot is seen")
    numbers = picture.locator(".body-marks text")
    expect(numbers).to_have_text(["1", "2", "3", "4"])
    expect(picture.locator(".body-marks polygon")).to_have_count(1)
    before = picture.get_attribute("aria-valuenow")
    picture.press("ArrowRight")
    expect(picture).not_to_have_attribute("aria-valuenow", str(before))
    editor.get_by_role("button", name="Add a leg").click()
    expect(numbers).to_have_count(6)
    assert dashboard.violations() == []


def move_legs(page: Page, editor: Locator) -> float:
    """Move by pointer, with the leg at the mirror image; by keys, and back. Return its place."""
    drag(page, leg(editor, 1), 40, 0)
    right = editor.get_by_role("spinbutton", name="To the right, as a number")
    moved_m = float(right.input_value())
    assert moved_m > 0.07
    expect(leg(editor, 2)).to_have_accessible_name(re.compile(f"{moved_m} m left, 0.11 m ahead"))
    for key in ("ArrowUp", "Shift+ArrowUp", "PageUp"):
        leg(editor, 1).press(key)
    expect(leg(editor, 2)).to_have_accessible_name(re.compile("0.116 m ahead, points to 155°"))
    undo = editor.get_by_role("button", name="Undo")
    undo.click()
    expect(leg(editor, 1)).to_have_accessible_name(re.compile("0.116 m ahead, points to 20°"))
    undo.click()
    expect(leg(editor, 1)).to_have_accessible_name(re.compile("0.11 m ahead, points to 20°"))
    expect(right).to_have_value(str(moved_m))
    return moved_m


def add_legs_and_shorten_one(dashboard: Dashboard, editor: Locator) -> None:
    """Add legs, and shorten one until the server refuses it at that leg; then mend it."""
    editor.get_by_role("button", name="Add a leg").click()
    expect(preview_in(editor)).to_contain_text("6 legs: 25 states")
    tibia = editor.get_by_role("spinbutton", name="Tibia, as a number")
    tibia.fill("0.03")
    expect(editor.get_by_role("alert")).to_have_text(re.compile(r"^Leg 6 cannot reach cell"))
    expect(editor.get_by_role("button", name=re.compile("Impossible: Leg"))).to_have_count(2)
    tibia.fill("three")
    expect(use(editor)).to_have_attribute("aria-disabled", "true")
    expect(editor.get_by_role("button", name="Leg 6, tibia")).to_be_visible()
    assert dashboard.violations() == []
    tibia.fill("0.14")
    expect(editor.get_by_role("alert")).to_have_count(0)


def test_the_editor_on_a_phone(flat_browser: Browser, shared_server: Serving) -> None:
    link = urlencode({"robot": "dog", "gait": "bound", "depth": "study", "tab": "train"})
    with new_page(flat_browser, viewport=NARROW, has_touch=True, is_mobile=True) as page:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(f"{shared_server.address}?{link}")
        editor = opened(dashboard)
        assert dashboard.scroll_width() == NARROW["width"]
        assert dashboard.violations() == []
        assert dashboard.small_targets(THUMB_PX) == []
        expect(preview_in(editor)).to_contain_text("It tips while legs")
        editor.get_by_role("button", name="Take groups with which it stands").tap()
        expect(preview_in(editor)).to_contain_text("stands by")
        leg(editor, 2).tap()
        # With its mirror image two would be left.
        removing = editor.get_by_role("button", name=re.compile("^Remove leg"))
        expect(removing).to_have_text("Remove legs 1 and 2")
        expect(removing).to_have_attribute("title", "A robot has at least 3 legs.")
        editor.get_by_role("checkbox", name="Mirrored").uncheck()
        removing.tap()
        expect(preview_in(editor)).to_contain_text("3 legs")
        editor.get_by_role("button", name="Cancel").tap()
        assert "robot=dog" in page.url
        assert dashboard.complaints == []
