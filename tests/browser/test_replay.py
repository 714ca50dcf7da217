"""A replay of one's own: a spectator plays a run by a link, and the stage goes on for all."""

import re
import time
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving

TOKEN = "for-the-operator"
RACE = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 20,
    "lanes": [{"agent": "q-learning", "training": {"steps": 60}}, {"agent": "greedy"}],
    "disturbances": [{"kind": "sensor-noise", "sd_m": 0.001, "at_step": 5}],
}


def finished_race(client: httpx2.Client) -> dict[str, Any]:
    """Start a race as the operator, and return it once it has finished."""
    started = client.post("races", json=RACE).raise_for_status().json()
    for _ in range(600):
        race: dict[str, Any] = client.get(f"races/{started['id']}").json()
        if race["state"] == "finished":
            return race
        time.sleep(0.1)
    raise AssertionError(race)


def shown_time(page: Page) -> float:
    time_s: float = page.evaluate(
        "async () => (await import('./static/js/replay.js')).replayTime.value"
    )
    return time_s


@pytest.mark.looks_at_3d
@pytest.mark.timeout(300)
def test_a_spectator_replays_a_race_while_the_stage_goes_on(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    page = dashboard.page
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    with (
        serving(tmp_path, token=TOKEN) as server,
        httpx2.Client(base_url=f"{server.address}api/v1/", headers=bearer) as api,
    ):
        race = finished_race(api)
        ends = api.get(f"runs/{race['id']}/replay").json()["step_ends_s"]
        common = api.put("stage", json={"run_id": race["id"], "playing": False}).json()

        dashboard.open(f"{server.address}?run={race['id']}&t=2.5")
        expect(dashboard.labels.get_by_text("Your own replay")).to_be_visible()
        expect(page.get_by_label("Moment of your replay")).to_have_value("2.5")
        dashboard.eventually(
            lambda: dashboard.has_figures(lanes=2), "the scoreboard follows the replay"
        )
        assert dashboard.violations() == []
        before = dashboard.picture()

        # A step of the robot that the camera follows, and back.
        page.get_by_label("Follow").select_option("2")
        page.keyboard.press(".")
        step = next(number for number, end in enumerate(ends[1]) if end > 2.5)
        dashboard.eventually(lambda: abs(shown_time(page) - ends[1][step]) < 1e-3, "a step on")
        row = dashboard.rows.filter(has_text="Greedy")
        expect(row).to_contain_text(f"Step {step + 2} of 20")
        dashboard.eventually(lambda: dashboard.picture() != before, "another picture")
        dashboard.button("One robot step back").click()
        dashboard.eventually(
            lambda: abs(shown_time(page) - ends[1][step - 1]) < 1e-3, "a step back"
        )
        expect(row).to_contain_text(f"Step {step + 1} of 20")

        # To something that happened, and on from there.
        marks = page.get_by_label("Jump to something")
        marks.select_option(marks.get_by_role("option", name="Time-out").get_attribute("value"))
        time_out = min(lane["clocks"]["paper"]["elapsed_s"] for lane in race["result"]["lanes"])
        dashboard.eventually(lambda: abs(shown_time(page) - time_out) < 0.01, "time-out")
        expect(page).to_have_url(re.compile(rf"run={race['id']}&t={time_out:.1f}"))
        page.get_by_label("Speed").select_option("0.5")
        dashboard.button("Play replay").click()
        dashboard.eventually(lambda: shown_time(page) > time_out + 0.3, "it plays")
        expect(page).to_have_url(re.compile(rf"\?run={race['id']}$"))
        page.get_by_label("Clock").select_option("free")
        dashboard.eventually(lambda: shown_time(page) <= ends[0][-1] + 1, "the same step")

        # No other page has seen any of it.
        after = api.get("stage").json()
        assert {name: after[name] for name in ("run_id", "time_s", "playing", "clock")} == {
            name: common[name] for name in ("run_id", "time_s", "playing", "clock")
        }
        dashboard.button("Live").click()
        expect(dashboard.labels.get_by_text("paused")).to_be_visible()
        expect(page.get_by_label("Moment that is shown")).to_be_disabled()
        assert page.url == server.address
        page.go_back()
        expect(dashboard.labels.get_by_text("Your own replay")).to_be_visible()
        dashboard.button("Live").click()
        dashboard.button("Replay").click()
        expect(page.get_by_label("Moment of your replay")).to_be_enabled()


def test_a_link_that_cannot_be_replayed_says_why(dashboard: Dashboard, shared_server: Any) -> None:
    page = dashboard.page
    page.goto(f"{shared_server.address}?run=gone&t=1")
    alert = page.get_by_role("alert").filter(has_text="gone")
    expect(alert).to_be_visible()
    # The page asks for the run, its replay and its scene.
    dashboard.eventually(lambda: len(dashboard.complaints) == 3, "three answers of 404")
    dashboard.complaints.clear()
    dashboard.button("Watch the stage").click()
    expect(alert).to_have_count(0)
    assert "run=" not in page.url
