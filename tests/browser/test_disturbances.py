"""What happens to robots: a leg is broken in practice, and a race goes on from its middle."""

import re
from typing import Any
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

LONG = urlencode({"steps": 100_000, "pace": 8})
IDEAL = urlencode({"steps": 100_000, "pace": 8, "simulator": "kinematic"})


def changes(dashboard: Dashboard) -> list[dict[str, Any]]:
    """Return what has happened to the newest training."""
    training = dashboard.get("/api/v1/trainings")["items"][0]
    return [one["disturbance"] for one in training["changes"]]


def test_a_leg_is_broken_while_a_robot_practises(
    dashboard: Dashboard, browser: Browser, shared_server: Serving
) -> None:
    page = dashboard.page
    dashboard.open(f"{shared_server.address}?{LONG}")
    expect(page.get_by_role("group", name="Legs, seen from above")).to_have_count(0)
    dashboard.button("Train, don’t race").click()
    leg = page.get_by_role("button", name=re.compile("^Leg 1"))
    expect(leg).to_have_attribute("aria-pressed", "false")
    leg.press("Space")
    dashboard.button("Leg 4").click()  # before the first is answered
    expect(leg).to_have_accessible_name("Leg 1, limp")
    expect(leg).to_have_attribute("aria-pressed", "true")
    expect(page.locator(".world-now")).to_contain_text(re.compile(r"Now: legs\s1, 4 limp"))

    happened = page.locator(".chart .happened")
    expect(happened).to_contain_text(re.compile(r"^Happened: legs?\s1.* limp from step \d+"))
    page.get_by_text("Ground, load and servos").click()
    slope = page.get_by_role("slider", name="Slope")
    slope.fill("8")
    expect(page.locator(".world-now")).to_contain_text("slope 8°")
    dashboard.button("Leg 1, limp").click()
    expect(dashboard.button("Leg 1")).to_have_attribute("aria-pressed", "false")
    kinds = [one["kind"] for one in changes(dashboard)]
    assert kinds == ["limp", "limp", "slope", "repair"]
    assert dashboard.violations() == []

    with browser.new_context(viewport={"width": 390, "height": 844}) as context:
        other = Dashboard(context.new_page(), has_3d=False)
        other.open(shared_server.address)
        expect(other.page.locator(".chip.happening")).to_contain_text(re.compile(r"^Leg\s4 limp"))
        assert other.scroll_width() == 390
        assert other.complaints == []
    dashboard.button("Stop").click()
    page.get_by_role("link", name="Runs").click()
    expect(page.locator(".run").first).to_contain_text(re.compile(r"slope 8° from step \d+"))

    # An ideal robot has no servos.
    dashboard.open(f"{shared_server.address}?{IDEAL}")
    dashboard.button("Train, don’t race").click()
    expect(page.locator(".world-now")).to_contain_text("only sensor noise can happen there")
    expect(dashboard.button("Leg 1")).to_have_attribute("aria-disabled", "true")
    page.get_by_text("Ground, load and servos").click()
    expect(page.get_by_role("slider", name="Slope")).to_be_disabled()
    page.get_by_role("slider", name="Sensor noise").fill("0.004")
    expect(page.locator(".world-now")).to_contain_text(re.compile(r"sensor noise 4\smm"))
    dashboard.button("Stop").click()


def test_a_race_goes_on_from_its_middle(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    lanes = {"lanes": "greedy,two-step", "race_steps": 12}
    dashboard.open(f"{shared_server.address}?{urlencode(lanes)}")
    dashboard.primary.click()
    dashboard.button("Play again for everyone").wait_for()
    page.get_by_text("What if something had happened in this race?").click()
    expect(page.locator(".branch")).to_contain_text("From step 7: as it was")
    page.get_by_role("slider", name="Moment that is shown").fill("1")
    dashboard.button("Pause replay for everyone").click()
    expect(page.locator(".branch")).to_contain_text(re.compile(r"From step [2-6]: as it was"))
    start = dashboard.button("Race on from here")
    expect(start).to_be_disabled()
    for leg in (1, 4):
        dashboard.button(f"Leg {leg}").click()
    expect(page.locator(".branch")).to_contain_text(re.compile(r"From step \d: legs\s1, 4 limp"))
    assert dashboard.violations() == []
    start.click()

    board = page.locator(".scoreboard")
    expect(board).to_contain_text(re.compile(r"The same as Race: .* before step [2-6]\."))
    dashboard.button("Play again for everyone").wait_for()
    original, branch = (dashboard.get("/api/v1/races")["items"][n] for n in (1, 0))
    assert branch["config"]["branch_from"]["race_id"] == original["id"]
    expect(board.get_by_text(re.compile(r"Original: 0\.\d\d\sm at time-out"))).to_have_count(2)
    expect(board.get_by_text("plans with the robot as designed, on flat ground")).to_have_count(2)
    assert dashboard.violations() == []
    page.get_by_role("link", name=original["name"]).click()
    expect(page.locator(".run")).to_have_count(1)
    expect(page.locator(".run")).to_contain_text(original["name"])
