"""Runs compared from the list: side by side, raced against each other, one as ghost of another."""

import re
import time
from typing import NamedTuple

import httpx2
import pytest
from playwright.sync_api import Page, expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}


class Duel(NamedTuple):
    """Ids of two trainings that can race each other, and of one with another gait."""

    calm: str
    bold: str
    turned: str


@pytest.fixture(scope="module")
def duel(shared_server: Serving) -> Duel:
    """Return trainings that have finished."""
    bodies = [
        {"steps": 150, "name": "Duel calm"},
        {"steps": 100, "name": "Duel bold", "agent": "sarsa"},
        {"steps": 20, "name": "Duel turned", "gait": "front-back-origin"},
    ]
    with httpx2.Client(base_url=f"{shared_server.address}api/v1/") as api:
        started = [api.post("trainings", json={**WALK, **body}) for body in bodies]
        ids = [answer.raise_for_status().json()["id"] for answer in started]
        for run_id in ids:
            while api.get(f"trainings/{run_id}").json()["state"] != "finished":
                time.sleep(0.05)
    return Duel(*ids)


def different_states(dashboard: Dashboard, *ids: str) -> int:
    """Return in how many states that both have visited the best moves of two tables differ."""
    tables = [dashboard.get(f"/api/v1/trainings/{run_id}/table") for run_id in ids]
    visited = zip(*(map(any, table["visits"]) for table in tables), strict=True)
    moves = zip(*(table["best"] for table in tables), strict=True)
    return sum(all(seen) and a != b for seen, (a, b) in zip(visited, moves, strict=True))


def marks_what_differs(page: Page) -> None:
    """Settings that differ are marked, and shown alone on request."""
    settings = page.get_by_role("region", name="Settings side by side")
    different = settings.get_by_role("rowheader", name=re.compile(", differs$"))
    expect(different).to_contain_text(["Learner", "Practice"])
    alike = settings.get_by_role("rowheader", name=re.compile("(?<!, differs)$"))
    assert alike.count() > 0
    page.get_by_label("Only differences").focus()
    page.keyboard.press("Space")
    expect(alike).to_have_count(0)
    practised = page.get_by_role("row", name=re.compile("^Practised"))
    expect(practised).to_contain_text("150 steps100 steps")


@pytest.mark.test
def test_runs_are_compared_side_by_side_and_raced(
    dashboard: Dashboard, shared_server: Serving, duel: Duel
) -> None:
    page = dashboard.page
    calm, bold, turned = duel

    # From the list: those that cannot race say why, and two that can are compared.
    page.goto(f"{shared_server.address}#runs?search=duel&sort=oldest")
    expect(dashboard.run_names).to_have_text(["Duel calm", "Duel bold", "Duel turned"])
    page.get_by_label("Select all").click()
    expect(dashboard.details).to_contain_text("they differ in gait (Left-right, opposite")
    expect(dashboard.button("Race these 3")).to_have_attribute("aria-disabled", "true")
    dashboard.runs.nth(2).get_by_role("checkbox").click()
    expect(dashboard.button("Race these 2")).not_to_have_attribute("aria-disabled", "true")
    page.get_by_role("link", name="Compare 2").click()

    # Curves over each other, read at the crosshair by keys.
    expect(page).to_have_url(f"{shared_server.address}#compare?runs={calm},{bold}")
    expect(page.get_by_role("img", name=re.compile("^Learning curves: A: .* B: "))).to_be_visible()
    reading = page.get_by_role("slider", name=re.compile("learning curves"))
    reading.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    expect(reading).to_contain_text(re.compile("A: Duel calm.*B: Duel bold", re.DOTALL))

    marks_what_differs(page)

    # Policies where they differ, as the tables have them.
    differ = different_states(dashboard, calm, bold)
    policies = page.get_by_role("region", name="Policies", exact=True)
    expect(policies).to_contain_text(re.compile(rf"best moves differ in {differ}\b"))
    if differ > 12:
        policies.get_by_role("button", name=f"Show all {differ}").click()
    expect(policies.get_by_role("rowheader")).to_have_count(differ)
    assert dashboard.violations() == []
    page.set_viewport_size({"width": 360, "height": 780})
    page.emulate_media(color_scheme="dark")
    assert dashboard.scroll_width() == 360
    assert dashboard.violations() == []
    page.set_viewport_size({"width": 1280, "height": 720})

    # A run that cannot be compared says why; the rest stays.
    page.goto(f"{shared_server.address}#compare?runs={calm},gone,{bold},{turned}")
    expect(page.get_by_role("alert").filter(has_text="There is no such run")).to_be_visible()
    dashboard.button("Leave out gone").click()
    dashboard.button("Leave out Duel turned").click()
    assert dashboard.complaints.pop().startswith("404")
    dashboard.button("Race these 2").click()
    expect(page.get_by_role("region", name="Stage", exact=True)).to_be_visible()
    race = dashboard.get("/api/v1/races?sort=newest&limit=1")["items"][0]
    assert race["name"] == "Race of Duel calm and Duel bold"
    assert [lane["training_id"] for lane in race["config"]["lanes"]] == [calm, bold]

    page.goto(f"{shared_server.address}#compare?runs={calm}")
    expect(page.get_by_text("It takes two runs to compare.")).to_be_visible()
    assert dashboard.violations() == []


def test_the_robots_of_another_run_walk_along_as_ghosts(
    dashboard: Dashboard, shared_server: Serving, duel: Duel
) -> None:
    page = dashboard.page
    calm, bold, _ = duel
    dashboard.open(f"{shared_server.address}#compare?runs={calm},{bold}")
    page.get_by_role("link", name="Replay A with B as ghost").click()
    expect(page).to_have_url(re.compile(rf"\?run={calm}&ghost={bold}$"))
    expect(dashboard.labels).to_contain_text(re.compile(r"Ghosts: Duel bold \(Sarsa −?0\.\d\d"))
    dashboard.button("Pause your replay").click()
    expect(page).to_have_url(re.compile(rf"run={calm}&ghost={bold}&t="))
    assert dashboard.violations() == []
    page.goto(f"{shared_server.address}?run={calm}&ghost={calm}")
    alert = page.get_by_role("alert").filter(has_text="cannot be its own ghost")
    expect(alert).to_be_visible()
    dashboard.button("Back to the stage").click()
    assert "ghost=" not in page.url
    assert {complaint.split()[0] for complaint in dashboard.complaints} == {"422"}
    dashboard.complaints.clear()
