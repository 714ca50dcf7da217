"""A replay of one's own: a spectator plays a run by a link, and the stage goes on for all."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import finished, serving

TOKEN = "for-the-operator"
RACE = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 20,
    "lanes": [{"agent": "q-learning", "training": {"steps": 60}}, {"agent": "greedy"}],
    "disturbances": [{"kind": "sensor-noise", "sd_m": 0.001, "at_step": 5}],
}


def shown_time(page: Page) -> float:
    time_s: float = page.evaluate(
        "async () => (await import('./static/js/player.js')).position.value"
    )
    return time_s


@pytest.mark.test
@pytest.mark.looks_at_3d
@pytest.mark.timeout(300)
def test_a_spectator_replays_a_race_while_the_stage_goes_on(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    page = dashboard.page
    with serving(tmp_path, token=TOKEN) as server, server.api(TOKEN) as api:
        race = finished(api, "races", RACE)
        ends = api.get(f"runs/{race['id']}/replay").json()["step_ends_s"]
        common = api.put("stage", json={"run_id": race["id"], "playing": False}).json()

        dashboard.open(server.link(run=race["id"], t=2.5, depth="try", tab="board"))
        expect(dashboard.labels.get_by_text("Your replay", exact=True)).to_be_visible()
        timeline = page.get_by_role("slider", name="Moment of your replay")
        expect(timeline).to_have_value("2.5")
        dashboard.eventually(
            lambda: dashboard.has_figures(lanes=2), "the scoreboard follows the replay"
        )
        assert dashboard.violations() == []
        before = dashboard.picture()

        # A step of the robot that the camera follows, and back.
        page.get_by_role("combobox", name="Follow").select_option("2")
        page.keyboard.press(".")
        step = next(number for number, end in enumerate(ends[1]) if end > 2.5)
        dashboard.eventually(lambda: abs(shown_time(page) - ends[1][step]) < 1e-3, "a step on")
        dashboard.choose_depth("Study")
        row = dashboard.rows.filter(has_text="Greedy")
        expect(row).to_contain_text(f"Step {step + 2} of 20")
        dashboard.eventually(lambda: dashboard.picture() != before, "another picture")
        dashboard.button("One robot step back").click()
        dashboard.eventually(
            lambda: abs(shown_time(page) - ends[1][step - 1]) < 1e-3, "a step back"
        )
        expect(row).to_contain_text(f"Step {step + 1} of 20")

        # To something that happened, and on from there.
        dashboard.button("Go to: time-out").click()
        time_out = min(lane["clocks"]["paper"]["elapsed_s"] for lane in race["result"]["lanes"])
        dashboard.eventually(lambda: abs(shown_time(page) - time_out) < 0.01, "time-out")
        expect(page).to_have_url(re.compile(rf"run={race['id']}&t={time_out:.1f}"))
        page.get_by_role("switch", name="End at time-out").uncheck()
        page.get_by_role("combobox", name="Speed").select_option("0.5")
        dashboard.button("Play your replay").click()
        dashboard.eventually(lambda: shown_time(page) > time_out + 0.3, "it plays")
        expect(page).to_have_url(re.compile(rf"\?run={race['id']}&end=all&depth=study&tab=board"))
        page.get_by_role("combobox", name="Clock").select_option("free")
        dashboard.eventually(lambda: shown_time(page) <= ends[0][-1] + 1, "the same step")

        # No other page has seen any of it.
        after = api.get("stage").json()
        assert {name: after[name] for name in ("run_id", "time_s", "playing", "clock")} == {
            name: common[name] for name in ("run_id", "time_s", "playing", "clock")
        }
        dashboard.button("Back to the stage").click()
        expect(dashboard.labels.get_by_text("paused")).to_be_visible()
        expect(page).not_to_have_url(re.compile("run="))
        page.go_back()
        expect(dashboard.labels.get_by_text("Your replay", exact=True)).to_be_visible()
        dashboard.button("Back to the stage").click()
        time_bar = page.get_by_role("group", name="Time", exact=True)
        time_bar.get_by_role("button", name="Replay", exact=True).click()
        expect(timeline).to_be_enabled()
        # The bar of the stage is the operators'; whoever touches it goes on by themselves.
        dashboard.button("Back to the stage").click()
        dashboard.moment.fill("1")
        dashboard.eventually(lambda: shown_time(page) >= 1, "a replay from there")
        assert api.get("stage").json()["time_s"] == common["time_s"]
