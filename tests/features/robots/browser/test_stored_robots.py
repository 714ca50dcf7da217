"""Stored robots on the page: saved from the editor, chosen, managed, and taken in from files."""

import json
import re
from pathlib import Path
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Locator, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.conftest import new_page
from tests.features.robots.browser.test_body_editor import (
    NARROW,
    SHORT,
    THUMB_PX,
    leg,
    opened,
    robot_in,
)
from tests.imports.robots import dog

pytestmark = pytest.mark.timeout(300)


def listed(dashboard: Dashboard) -> Locator:
    dashboard.button("Your robots…").first.click()
    robots = dashboard.page.get_by_role("dialog", name="Your robots")
    expect(robots).to_be_visible()
    return robots


def save_longer_legs(dashboard: Dashboard, name: str) -> None:
    """Move a leg of the robot that is chosen, and save the body."""
    editor = opened(dashboard)
    leg(editor, 1).press("ArrowUp")
    editor.get_by_role("button", name="Save as…").click()
    field = editor.get_by_label("Name", exact=True)
    expect(field).to_be_focused()
    save = editor.get_by_role("button", name="Save", exact=True)
    expect(save).to_have_attribute("aria-disabled", "true")
    field.fill(name)
    expect(save).not_to_have_attribute("aria-disabled", "true")
    assert dashboard.violations() == []
    save.click()
    expect(editor).to_be_hidden()


def test_a_body_is_saved_raced_renamed_hidden_and_kept_while_runs_use_it(
    dashboard: Dashboard, server: Serving
) -> None:
    page = dashboard.page
    link = {**SHORT, "robot": "dog", "gait": "trot", "depth": "study", "tab": "train"}
    dashboard.open(server.link(**link, race_steps="3"))
    save_longer_legs(dashboard, "Rex")
    expect(dashboard.panel.get_by_text("Rex", exact=True)).to_be_visible()
    in_link = json.loads(robot_in(page.url))
    (stored,) = dashboard.get("/api/v1/robots")["items"]
    assert (stored["name"], stored["gait"], in_link["id"]) == ("Rex", "trot", stored["id"])
    assert in_link["body"]["legs"]

    page.reload()
    expect(dashboard.panel.get_by_text("Rex", exact=True)).to_be_visible()
    dashboard.choose_depth("Try")
    expect(page.get_by_label("Robot", exact=True)).to_have_value(stored["id"])
    dashboard.primary.click()
    expect(dashboard.headline).to_have_text(re.compile(r"wins|level"))
    race, _ = dashboard.get("/api/v1/runs")["items"]
    assert race["config"]["robot"] == {"id": stored["id"], "name": "Rex"}

    dashboard.choose_depth("Study")
    dashboard.open_tab("Train")
    robots = listed(dashboard)
    assert dashboard.violations_in_both_themes() == []
    robots.get_by_label("Name of Rex").fill("Max")
    robots.get_by_label("Name of Rex").press("Enter")
    expect(robots.get_by_label("Name of Max")).to_be_visible()
    robots.get_by_role("button", name="Delete Max").click()
    expect(robots.get_by_role("alert")).to_contain_text("2 runs use Max")
    expect(robots.get_by_role("alert")).to_contain_text("hide it instead")
    assert [complaint.split()[0] for complaint in dashboard.complaints] == ["409"]
    dashboard.complaints.clear()
    robots.get_by_role("button", name="Hide Max").click()
    expect(robots.get_by_role("button", name="Show Max")).to_be_visible()
    page.keyboard.press("Escape")
    # What is chosen stays, and is offered no longer once another one is chosen.
    dashboard.choose_depth("Try")
    choice = page.get_by_label("Robot", exact=True)
    expect(choice).to_have_value(stored["id"])
    choice.select_option("dog")
    expect(choice.get_by_role("option", name="Max")).to_have_count(0)


def test_one_that_was_deleted_comes_back(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(server.link(depth="study", tab="train"))
    store = """femur_m => fetch("api/v1/robots", { method: "POST",
      headers: { "X-Requested-With": "x" },
      body: JSON.stringify({ name: "Bo", robot: { preset: "dog", femur_m } }) })"""
    page.evaluate(store, 0.085)
    robots = listed(dashboard)
    robots.get_by_role("button", name="Delete Bo").click()
    deleted = robots.get_by_role("list", name="Deleted")
    words = re.compile(r"Deleted “Bo”\. It can be restored until \d\d:\d\d")
    expect(deleted).to_contain_text(words)
    expect(robots.get_by_label("Name of Bo")).to_have_count(0)
    assert dashboard.violations_in_both_themes() == []
    page.reload()
    robots = listed(dashboard)
    expect(deleted).to_contain_text(words)
    # Its name is taken meanwhile, until that robot has another one.
    page.evaluate(store, 0.086)
    deleted.get_by_role("button", name="Undo").click()
    expect(robots.get_by_role("alert")).to_contain_text("give that one another name")
    assert [complaint.split()[0] for complaint in dashboard.complaints] == ["409"]
    dashboard.complaints.clear()
    robots.get_by_label("Name of Bo").fill("Max")
    robots.get_by_label("Name of Bo").press("Enter")
    expect(robots.get_by_label("Name of Max")).to_be_visible()
    deleted.get_by_role("button", name="Undo").click()
    expect(robots.get_by_label("Name of Bo")).to_be_visible()
    expect(deleted).to_have_count(0)
    for name in ("Bo", "Max"):
        robots.get_by_role("button", name=f"Delete {name}").click()


def test_a_link_brings_the_body_to_a_server_that_does_not_have_it(
    dashboard: Dashboard, server: Serving
) -> None:
    body = {"preset": "stiff", "femur_m": 0.09}
    robot = json.dumps({"id": "0" * 16, "name": "Rex", "body": body})
    dashboard.open(
        f"{server.address}?{urlencode({'robot': robot, 'depth': 'study', 'tab': 'train'})}"
    )
    expect(dashboard.panel.get_by_text("Custom: stiff, femur 0.09")).to_be_visible()


def test_another_page_learns_of_a_new_robot(dashboard: Dashboard, server: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{server.address}?depth=try&tab=train")
    choice = page.get_by_label("Robot", exact=True)
    expect(choice.get_by_role("option", name="Fido")).to_have_count(0)
    store = """() => fetch("api/v1/robots", { method: "POST", headers: { "X-Requested-With": "x" },
      body: JSON.stringify({ name: "Fido", robot: { preset: "dog", femur_m: 0.09 } }) })"""
    page.evaluate(store)
    expect(choice.get_by_role("option", name="Fido")).to_have_count(1)


def test_a_robot_that_was_saved_elsewhere_is_stored_as_it_is(
    dashboard: Dashboard, server: Serving, tmp_path: Path
) -> None:
    (tmp_path / "rex.json").write_text(json.dumps({"robot": {"preset": "dog", "femur_m": 0.09}}))
    (tmp_path / "bad.json").write_text("{}")
    dashboard.open(server.link(depth="study", tab="train"))
    robots = listed(dashboard)
    chooser = robots.get_by_label("Robot from a file…")
    chooser.set_input_files(tmp_path / "bad.json")
    expect(robots.get_by_role("alert")).to_contain_text("bad.json")
    assert [complaint.split()[0] for complaint in dashboard.complaints] == ["422"]
    dashboard.complaints.clear()
    robots.get_by_role("button", name="Dismiss bad.json").click()
    chooser.set_input_files(tmp_path / "rex.json")
    expect(robots.get_by_role("status")).to_contain_text("rex.json is rex here.")
    expect(robots.get_by_label("Name of rex")).to_be_visible()
    assert dashboard.violations() == []


def test_the_list_on_a_phone(flat_browser: Browser, server: Serving) -> None:
    with new_page(flat_browser, viewport=NARROW, has_touch=True, is_mobile=True) as page:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(f"{server.address}?depth=study&tab=train")
        page.evaluate(
            """text => fetch("api/v1/robots?name=Spot", { method: "POST", body: text,
              headers: { "X-Requested-With": "x" } })""",
            dog(),
        )
        robots = listed(dashboard)
        expect(robots.get_by_role("button", name="Correct Spot")).to_be_visible()
        assert dashboard.scroll_width() == NARROW["width"]
        assert dashboard.violations() == []
        assert dashboard.small_targets(THUMB_PX) == []
        assert dashboard.complaints == []
