"""The list of runs on the server: filters, search, pages; and panels of a run older than them."""

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import expect

from app.storage.run_ids import RunIds
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.storage.stores import opened, training

pytestmark = pytest.mark.timeout(300)

WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
NEWER = 60
"""Runs after the first two: more than a snapshot or a page has."""


@pytest.fixture
def many_runs(tmp_path: Path) -> Iterator[Serving]:
    """A server with a training and its race, and many newer trainings that were stopped."""
    with serving(tmp_path) as server, httpx2.Client(base_url=f"{server.address}api/v1") as client:
        body = {"steps": 20, "name": "Old training"}
        lanes = [{"agent": "q-learning", "training": body}, {"agent": "greedy"}]
        race = client.post("/races", json={**WALK, "lanes": lanes, "steps": 3, "name": "Old race"})
        assert race.status_code == 202, race.text
        path = f"/races/{race.json()['id']}"
        while client.get(path).json()["state"] != "finished":
            time.sleep(0.05)
    new_id = RunIds()
    with opened(tmp_path, None) as store:
        store.create(
            *(training(new_id(), name=f"Newer {n}", state="stopped") for n in range(NEWER))
        )
    with serving(tmp_path) as server:
        yield server


def test_runs_older_than_a_page_are_found_and_shown(
    dashboard: Dashboard, many_runs: Serving
) -> None:
    page = dashboard.page
    dashboard.open(f"{many_runs.address}#runs")
    rows = page.locator(".run")
    expect(rows).to_have_count(50)
    page.get_by_role("button", name="Races").click()
    expect(rows).to_have_count(1)
    expect(rows).to_contain_text("Old race")
    page.get_by_role("button", name="All", exact=True).click()
    page.get_by_label("Search names and ids").fill("OLD")
    expect(rows).to_have_count(2)
    page.get_by_label("Search names and ids").fill("nothing like this")
    expect(page.get_by_text("No run matches these filters.")).to_be_visible()
    assert dashboard.violations() == []
    dashboard.button("Show all runs").click()
    expect(rows).to_have_count(50)
    dashboard.button("Show older runs").click()
    expect(rows).to_have_count(NEWER + 2)
    expect(dashboard.button("Show older runs")).to_have_count(0)

    [race] = dashboard.get("/api/v1/races")["items"]
    put(many_runs, {"run_id": race["id"]})
    # A fresh page gets neither the race nor its training with the snapshot.
    dashboard.open(many_runs.address)
    expect(page.locator(".headline")).to_have_text(re.compile("^Greedy wins: "))
    expect(page.get_by_role("img", name=re.compile("^Learning curve: "))).to_be_visible()
    expect(dashboard.rows).to_have_count(2)


def put(server: Serving, body: dict[str, Any]) -> None:
    answer = httpx2.put(f"{server.address}api/v1/stage", json=body)
    assert answer.status_code < 300, answer.text


def test_a_dead_link_says_so(dashboard: Dashboard, shared_server: Serving) -> None:
    page = dashboard.page
    page.goto(f"{shared_server.address}#experiments?run=gone")
    expect(page.get_by_role("heading", name="This experiment is not here")).to_be_visible()
    expect(page.get_by_role("alert").filter(has_text="gone")).to_be_visible()
    assert dashboard.violations() == []
    dashboard.button("Show the newest experiment").click()
    expect(page.get_by_role("heading", name="This experiment is not here")).to_have_count(0)
    assert [complaint.split()[0] for complaint in dashboard.complaints] == ["404"]
    dashboard.complaints.clear()
