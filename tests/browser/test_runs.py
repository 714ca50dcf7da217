"""The list of runs on the server: filters, search, pages; and panels of a run older than them."""

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest
from playwright.sync_api import Page, expect

from app.storage.run_ids import RunIds
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.promises.length import only_whole
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
    rows = dashboard.runs
    expect(rows).to_have_count(50)
    page.get_by_role("button", name="Races").click()
    expect(rows).to_have_count(1)
    expect(rows).to_contain_text("Old race")
    page.get_by_role("link", name="Replay").click()
    expect(dashboard.labels.get_by_text("Your replay", exact=True)).to_be_visible()
    page.go_back()
    expect(rows).to_have_count(1)
    page.get_by_label("More for this race").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="Recording", exact=True).click()
    assert Path(download.value.path()).read_bytes()[:1] == b"{"
    page.get_by_role("button", name="All", exact=True).click()
    page.get_by_label("Search names, ids, tags and notes").fill("OLD")
    expect(rows).to_have_count(2)
    page.get_by_label("Search names, ids, tags and notes").fill("nothing like this")
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
    expect(page.get_by_role("heading", name=re.compile("^Greedy wins by "))).to_be_visible()
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


@pytest.fixture(scope="module")
def walks(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """A server with a dozen runs, which the tests of this module put in order one after another."""
    folder, new_id = tmp_path_factory.mktemp("walks"), RunIds()
    with opened(folder, None) as store:
        store.create(*(training(new_id(), name=f"Walk {n}", state="stopped") for n in range(12)))
    with serving(folder) as server:
        yield server


@pytest.mark.test
def test_a_run_gets_a_name_tags_and_notes_in_its_place(
    dashboard: Dashboard, walks: Serving
) -> None:
    page = dashboard.page
    page.goto(f"{walks.address}#runs?sort=oldest")
    row, names = dashboard.runs.first, dashboard.run_names
    expect(names.first).to_have_text("Walk 0")
    dashboard.button("Walk 3").click()
    dashboard.button("Rename").click()
    page.keyboard.type("Aardvark")
    page.keyboard.press("Enter")
    expect(dashboard.details.get_by_role("heading", name="Aardvark")).to_be_visible()
    expect(dashboard.button("Rename")).to_be_focused()
    choose_order(page, "by name")
    expect(names.first).to_have_text("Aardvark")

    dashboard.button("Walk 0").click()
    row.get_by_label("More for this training").click()
    row.get_by_role("button", name="Add tags").click()
    too_long = "ice, week 3, " + "x" * 31
    page.keyboard.type(too_long)
    page.keyboard.press("Enter")
    alert = dashboard.details.get_by_role("alert")
    expect(alert.filter(has_text="at most 30 characters")).to_be_visible()
    field = page.get_by_label("Tags, with commas between")
    expect(field).to_have_value(too_long)
    assert dashboard.complaints.pop().startswith("422")
    field.fill("ice, week 3")
    dashboard.button("Save").click()
    tags = dashboard.details.get_by_role("group", name="Tags")
    expect(tags.get_by_role("button", name=re.compile("ice|week"))).to_have_text(["ice", "week 3"])
    dashboard.details.get_by_role("button", name="Add notes").click()
    page.keyboard.type("Slips.\nTry again.")
    page.keyboard.press("Control+Enter")
    expect(dashboard.details).to_contain_text("Slips.\nTry again.")
    expect(row).to_contain_text(re.compile("ice.*week 3.*Slips"))
    assert dashboard.violations() == []

    row.get_by_label("More for this training").click()
    row.get_by_role("button", name="As code").click()
    code = page.get_by_role("region", name="Code")
    expect(code).to_contain_text("hexapods train")
    dashboard.button("Python").click()
    expect(code).to_contain_text("hx.train")
    assert dashboard.violations() == []
    dashboard.button("Close").click()
    row.get_by_label("More for this training").click()
    row.get_by_role("button", name="Run again").click()
    expect(page.get_by_role("region", name="Stage", exact=True)).to_be_visible()
    newest = dashboard.get("/api/v1/trainings?sort=newest&limit=1")["items"][0]
    assert (newest["name"], newest["tags"]) == ("Aardvark", ["ice", "week 3"])

    page.goto(f"{walks.address}#runs?sort=size")
    expect(page.get_by_text("sort must be one of newest, oldest, name, distance")).to_be_visible()
    assert dashboard.complaints.pop().startswith("422")


def test_several_runs_are_tagged_and_deleted(dashboard: Dashboard, walks: Serving) -> None:
    page = dashboard.page
    page.goto(f"{walks.address}#runs?sort=name&search=walk%201")
    rows, names = dashboard.runs, dashboard.run_names
    expect(names).to_have_text(["Walk 1", "Walk 10", "Walk 11"])
    boxes = rows.get_by_role("checkbox")
    boxes.nth(0).focus()
    page.keyboard.press("Shift+ArrowDown")
    boxes.nth(2).click(modifiers=["Shift"])
    expect(page.get_by_text("3 runs selected")).to_be_visible()
    expect(dashboard.details.get_by_role("heading", name="3 runs", exact=True)).to_be_visible()
    assert dashboard.violations() == []
    boxes.nth(0).click()
    page.get_by_label("Tag for the selected runs").fill("moved")
    page.keyboard.press("Enter")
    page.get_by_role("group", name="Tag", exact=True).get_by_role("button", name="moved").click()
    expect(names).to_have_text(["Walk 10", "Walk 11"])
    page.get_by_label("Search names, ids, tags and notes").fill("")
    expect(page).to_have_url(re.compile("#runs.selected=[^&]*,[^&]*&tag=moved&sort=name$"))
    page.reload()
    expect(names).to_have_text(["Walk 10", "Walk 11"])
    expect(page.get_by_text("2 runs selected")).to_be_visible()

    page.set_viewport_size({"width": 360, "height": 780})
    assert dashboard.scroll_width() == 360
    assert dashboard.violations() == []
    expect(rows).to_have_count(2)
    page.set_viewport_size({"width": 1280, "height": 800})
    dashboard.button("Delete 2").click()
    expect(page.get_by_text("No run matches these filters.")).to_be_visible()
    # They come back, after a reload of the page too, with the tags that they had.
    page.reload()
    deleted = page.get_by_role("list", name="Deleted")
    expect(deleted).to_contain_text(
        re.compile(r"Deleted 2 runs\. It can be restored until \d\d:\d\d")
    )
    assert dashboard.violations() == []
    deleted.get_by_role("button", name="Undo").click()
    expect(names).to_have_text(["Walk 10", "Walk 11"])
    expect(deleted).to_have_count(0)
    expect(page.get_by_text("Restored 2 runs.")).to_be_visible()
    rows.get_by_label("More for this training").first.click()
    rows.get_by_role("button", name="Delete").click()
    expect(names).to_have_text(["Walk 11"])
    page.get_by_role("status").get_by_role("button", name="Undo").click()
    expect(names).to_have_text(["Walk 10", "Walk 11"])
    assert dashboard.violations() == []


def choose_order(page: Page, order: str) -> None:
    """Choose it in the menu of what is seldom changed, and close that."""
    page.get_by_text("View", exact=True).click()
    page.get_by_label("Order").select_option(order)
    page.keyboard.press("Escape")


LEARNER = "q-learning"
NOTES = "Forgets."


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """A server with trainings that differ in α, one of another learner, and a race of two."""
    with (
        serving(tmp_path_factory.mktemp("sweep")) as server,
        httpx2.Client(base_url=f"{server.address}api/v1") as client,
    ):
        common = {**WALK, "steps": 60, "evaluate_every": 20}
        bodies = [{**common, "settings": {"alpha": alpha}} for alpha in (0.1, 0.5, 0.9)]
        ids = [finished(client, "trainings", body) for body in bodies]
        finished(client, "trainings", {**common, "agent": "dyna-q", "steps": 30})
        lanes = [{"agent": LEARNER, "training_id": ids[0]}, {"agent": "greedy"}]
        finished(client, "races", {**WALK, "lanes": lanes, "steps": 5})
        client.patch(f"/runs/{ids[2]}", json={"notes": f"{NOTES}\nSee page 3."})
        yield server


def finished(client: httpx2.Client, kind: str, body: dict[str, Any]) -> str:
    answer = client.post(f"/{kind}", json=body)
    assert answer.status_code == 202, answer.text
    run_id: str = answer.json()["id"]
    while client.get(f"/{kind}/{run_id}").json()["state"] != "finished":
        time.sleep(0.05)
    return run_id


def test_a_sweep_is_one_group_named_by_what_differs(dashboard: Dashboard, sweep: Serving) -> None:
    page, details = dashboard.page, dashboard.details
    dashboard.open(f"{sweep.address}#runs")
    group = page.get_by_role("list", name="Runs: Sweep of α")
    expect(group.get_by_role("heading")).to_have_text(["α\u00a00.9", "α\u00a00.5", "α\u00a00.1"])
    expect(page.get_by_text("Q-learning · 60 steps · Left-right, opposite")).to_be_visible()
    expect(page.get_by_text(NOTES, exact=True)).to_be_visible()
    expect(group.get_by_role("listitem").first).to_contain_text(
        re.compile(r"Distance −?0\.\d\d\sm")
    )

    # By keys alone: to the first, its details, and a selection of all three.
    first = group.get_by_role("checkbox").first
    first.focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(details.get_by_role("heading", level=2)).to_have_text(
        re.compile(r"^Q-learning, α\s0\.9, 60 steps → −?0\.\d\d\sm$")
    )
    first.focus()
    for _ in range(2):
        page.keyboard.press("Shift+ArrowDown")
    expect(details.get_by_role("heading", level=2)).to_have_text("Sweep of α, 3 runs")
    expect(details.get_by_role("img", name=re.compile("^Learning curves: "))).to_be_visible()
    expect(details.get_by_role("rowheader")).to_have_text(
        ["α\u00a00.1", "α\u00a00.5", "α\u00a00.9"], use_inner_text=True
    )
    expect(details).to_contain_text("One seed each")
    assert dashboard.violations() == []

    details.get_by_role("link", name="Repeat, 12 seeds").click()
    dialog = page.get_by_role("dialog")
    # The estimate of how long they take may be there already.
    expect(dialog.get_by_text(re.compile("^37 trials[.,]"))).to_be_visible()
    assert "alpha=0.1;0.5;0.9" in page.url
    page.go_back()
    expect(page.get_by_text("3 runs selected")).to_be_visible()
    dashboard.button("Race these 3").click()
    expect(page.get_by_role("region", name="Stage", exact=True)).to_be_visible()
    race = dashboard.get("/api/v1/races?sort=newest&limit=1")["items"][0]
    assert race["name"] == "Race of Q-learning: α\u00a00.1, α\u00a00.5 and α\u00a00.9"


def test_groups_and_columns_are_chosen_and_kept(dashboard: Dashboard, sweep: Serving) -> None:
    page = dashboard.page
    dashboard.open(f"{sweep.address}#runs")
    page.get_by_label("Groups").select_option("By race")
    race = page.get_by_role("list", name=re.compile("^Runs: Race: Q-learning, Greedy"))
    expect(race.get_by_role("heading")).to_have_text(
        ["The race", "Q-learning, α\u00a00.1, 60 steps"]
    )
    page.get_by_text("View", exact=True).click()
    page.get_by_label("Seed").check()
    page.get_by_label("Of Greedy").check()
    expect(dashboard.runs.last).to_contain_text(re.compile(r"Seed 0.*Of Greedy −?\d+ %"))
    assert dashboard.violations() == []
    expect(page).to_have_url(
        re.compile("group=race&columns=seed,share,distance,created$|group=race")
    )
    page.goto("about:blank")
    dashboard.open(f"{sweep.address}#runs")
    expect(page.get_by_label("Groups")).to_have_value("race")
    expect(dashboard.runs.last).to_contain_text("Of Greedy")


@pytest.mark.parametrize("theme", ["light", pytest.param("dark", marks=only_whole)])
def test_the_view_fills_the_window_and_a_phone_scrolls_it(
    dashboard: Dashboard, sweep: Serving, theme: str
) -> None:
    page = dashboard.page
    page.emulate_media(color_scheme="light" if theme == "light" else "dark")
    page.set_viewport_size({"width": 1280, "height": 720})
    dashboard.open(f"{sweep.address}#runs?group=sweep")
    expect(dashboard.runs.first).to_be_visible()
    height = "document.documentElement.scrollHeight"
    assert (page.evaluate(height), dashboard.scroll_width()) == (720, 1280)
    assert dashboard.violations() == []

    page.set_viewport_size({"width": 390, "height": 844})
    assert dashboard.scroll_width() == 390
    expect(dashboard.details).to_have_count(0)
    dashboard.button("α\u00a00.5").click()
    expect(dashboard.details.get_by_role("heading", level=2)).to_contain_text("α\u00a00.5")
    expect(dashboard.details.get_by_role("link", name="Replay")).to_be_in_viewport(ratio=1)
    assert dashboard.scroll_width() == 390
    assert dashboard.violations() == []
    page.go_back()
    expect(dashboard.details).to_have_count(0)
    for number in range(2):
        dashboard.runs.get_by_role("checkbox").nth(number).click()
    dashboard.button("Look at these 2").click()
    expect(dashboard.details.get_by_role("link", name="Compare 2")).to_be_in_viewport(ratio=1)
    dashboard.details.get_by_role("button", name="Runs").click()
    expect(dashboard.group("Selection")).to_be_visible()
    assert dashboard.violations() == []


def test_a_lost_connection_is_shown_and_the_list_stays(
    dashboard: Dashboard, tmp_path: Path
) -> None:
    with opened(tmp_path, None) as store:
        store.create(training(RunIds()(), name="Kept", state="stopped"))
    server = Serving(tmp_path)
    try:
        dashboard.open(f"{server.address}#runs")
        expect(dashboard.run_names).to_have_text(["Kept"])
    finally:
        server.stop()
    expect(
        dashboard.page.get_by_text("Reconnecting. This is the last known state.")
    ).to_be_visible()
    expect(dashboard.run_names).to_have_text(["Kept"])
    assert dashboard.violations() == []
    dashboard.complaints.clear()
