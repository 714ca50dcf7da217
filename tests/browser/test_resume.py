"""A run that a dead server left interrupted is offered on the page and resumes at a click."""

import json
import re
from pathlib import Path
from urllib.request import Request, urlopen

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


def start(address: str) -> None:
    body = json.dumps(ENDLESS).encode()
    headers = {"Content-Type": "application/json"}
    with urlopen(Request(f"{address}api/v1/trainings", body, headers)) as answer:
        assert answer.status == 202


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
        resume = dashboard.details.get_by_role("button", name="Resume", exact=True)
        expect(resume).to_be_visible()
        page.goto(f"{server.address}#")
        left_at = done(dashboard)
        dashboard.button("Resume").click()
        expect(note).to_have_count(0)
        dashboard.eventually(lambda: done(dashboard) > left_at, "another step")
        dashboard.choose_depth("Try")
        dashboard.button("Stop").click()
        expect(page.get_by_text("The training was stopped at step")).to_be_visible()
        is_at_the_step_of_the_picture(dashboard)


def is_at_the_step_of_the_picture(dashboard: Dashboard) -> None:
    """The bar counts the steps that the robot's label counts, however many were ordered."""
    label = dashboard.page.get_by_text(re.compile(r"(interrupted|stopped) at step \d+ of")).first
    expect(label).to_be_visible()
    found = re.search(r"at step (\d+) of", label.inner_text())
    assert found is not None
    moment = dashboard.page.get_by_role("slider", name="Moment that is shown")
    expect(moment).to_have_attribute("aria-valuetext", f"step {found[1]} of step {found[1]}")


def done(dashboard: Dashboard) -> int:
    (run,) = dashboard.get("api/v1/trainings")["items"]
    steps: int = run["progress"]["done"]
    return steps
