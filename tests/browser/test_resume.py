"""A run that ended early, by a crash or by a person, says where, and goes on at a click."""

import json
import re
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving

ENDLESS = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 10_000_000,
    "pace": 20,
    "evaluate_every": 0,
}


KINDS = ("trainings", "races")


def start(address: str, kind: str = "trainings", body: dict[str, Any] = ENDLESS) -> None:
    assert send(address, "POST", kind, body) == 202


def send(address: str, method: str, path: str, body: dict[str, Any]) -> int:
    headers = {"Content-Type": "application/json"}
    data = json.dumps(body).encode()
    with urlopen(Request(f"{address}api/v1/{path}", data, headers, method=method)) as answer:
        status: int = answer.status
        return status


def test_an_interrupted_training_goes_on_at_a_click(tmp_path: Path, dashboard: Dashboard) -> None:
    page = dashboard.page
    with serving(tmp_path) as server:
        start(server.address)
        dashboard.open(server.address)
        # Its process has begun; only then is there a step to come back to.
        dashboard.eventually(lambda: done(dashboard) > 0, "a first step")
        page.goto("about:blank")
    with serving(tmp_path) as server:
        dashboard.open(server.address)
        note = dashboard.notes.get_by_text("interrupted at step")
        expect(note).to_be_visible()
        is_at_the_step_of_the_picture(dashboard)
        page.goto(f"{server.address}#runs")
        expect(dashboard.runs.get_by_text("interrupted", exact=True)).to_be_visible()
        resume = dashboard.details.get_by_role("button", name="Go on", exact=True)
        expect(resume).to_be_visible()
        page.goto(f"{server.address}#")
        left_at = done(dashboard)
        dashboard.button("Go on").click()
        expect(note).to_have_count(0)
        dashboard.eventually(lambda: done(dashboard) > left_at, "another step")
        dashboard.choose_depth("Try")
        dashboard.button("Stop").click()
        expect(page.get_by_text("The training was stopped at step")).to_be_visible()
        is_at_the_step_of_the_picture(dashboard)


def test_a_practice_that_was_stopped_stays_on_stage_and_goes_on_with_its_race(
    tmp_path: Path, dashboard: Dashboard
) -> None:
    with serving(tmp_path) as server:
        dashboard.open(server.link(steps=1500, pace=20, simulator="kinematic", depth="try"))
        dashboard.primary.click()
        dashboard.eventually(lambda: practised(dashboard) > 40, "steps of practice")
        dashboard.button("Stop").click()
        where = re.compile(r"^Stopped at step (\d+) of 1500$")
        expect(dashboard.headline).to_have_text(where)
        match = where.match(dashboard.headline.inner_text())
        assert match is not None
        assert int(match[1]) == practised(dashboard)
        expect(dashboard.notes).to_contain_text(f"The training was stopped at step {match[1]} of")
        expect(dashboard.shown_run).to_contain_text(f"stopped at step {match[1]} of 1500")
        (training,), (race,) = (dashboard.get(f"api/v1/{kind}")["items"] for kind in KINDS)
        assert (training["state"], race["state"]) == ("stopped", "stopped")
        # The race that was queued behind it never ran: there is nothing of it to see.
        dashboard.page.wait_for_timeout(2000)
        stage = dashboard.get("api/v1/stage")
        assert (stage["run_id"], stage["next_run_id"]) == (training["id"], None)
        expect(dashboard.headline).to_have_text(where)
        dashboard.button("Go on with the race").click()
        expect(dashboard.notes.get_by_text("was stopped")).to_have_count(0)
        dashboard.eventually(lambda: practised(dashboard) > int(match[1]), "another step")
        (training,), (race,) = (dashboard.get(f"api/v1/{kind}")["items"] for kind in KINDS)
        assert (race["state"], race["waiting_for"]) == ("queued", [training["id"]])
        dashboard.button("Stop").click()
        expect(dashboard.headline).to_have_text(where)
        assert dashboard.violations() == []


@pytest.mark.test
def test_a_race_that_was_stopped_has_no_leader_and_goes_on(
    tmp_path: Path, dashboard: Dashboard
) -> None:
    lanes = [{"agent": "greedy"}, {"agent": "random-walk"}]
    body = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 5000, "lanes": lanes}
    with serving(tmp_path) as server:
        dashboard.open(server.link(depth="try", tab="board"))
        start(server.address, "races", body)
        dashboard.eventually(lambda: done(dashboard, "races") > 40, "steps of the race")
        dashboard.button("Stop").click()
        dashboard.eventually(lambda: state(dashboard) == "stopped", "a stopped race")
        send(server.address, "PUT", "stage", {"time_s": 1e6})
        where = re.compile(r"^Stopped at steps? \d+.* of 5000")
        expect(dashboard.headline).to_have_text(where)
        expect(dashboard.reason).not_to_contain_text("steps are longer")
        expect(dashboard.scoreboard).to_contain_text("No ranking: the race was stopped")
        expect(dashboard.rows.first).to_contain_text(re.compile("^–"))
        dashboard.page.goto(f"{server.address}#runs")
        expect(dashboard.details).to_contain_text(re.compile(r"before its time-out: not ranked"))
        expect(dashboard.details).not_to_contain_text("Ranked by")
        dashboard.page.goto(f"{server.address}#")
        dashboard.button("Go on").click()
        dashboard.eventually(lambda: state(dashboard) != "stopped", "the race again")
        expect(dashboard.notes.get_by_text("was stopped")).to_have_count(0)


def is_at_the_step_of_the_picture(dashboard: Dashboard) -> None:
    """The bar counts the steps that the robot's label counts, however many were ordered."""
    label = dashboard.page.get_by_text(re.compile(r"(interrupted|stopped) at step \d+ of")).first
    expect(label).to_be_visible()
    match = re.search(r"at step (\d+) of", label.inner_text())
    assert match is not None
    moment = dashboard.page.get_by_role("slider", name="Moment that is shown")
    expect(moment).to_have_attribute("aria-valuetext", f"step {match[1]} of step {match[1]}")


def done(dashboard: Dashboard, kind: str = "trainings") -> int:
    (run,) = dashboard.get(f"api/v1/{kind}")["items"]
    steps: int = run["progress"]["done"]
    return steps


def practised(dashboard: Dashboard) -> int:
    runs = dashboard.get("api/v1/trainings")["items"]
    return max((run["progress"]["done"] for run in runs), default=0)


def state(dashboard: Dashboard) -> str:
    (race,) = dashboard.get("api/v1/races")["items"]
    race_state: str = race["state"]
    return race_state
