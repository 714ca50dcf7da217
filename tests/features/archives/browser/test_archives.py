"""Runs are taken away as a file on the page, and brought back; without archives it says nothing."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from app.storage.run_ids import RunIds
from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.storage.stores import opened, training

pytestmark = pytest.mark.timeout(300)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data folder with three trainings that were stopped."""
    folder, new_id = tmp_path / "data", RunIds()
    with opened(folder, None) as store:
        store.create(*(training(new_id(), name=f"Walk {n}", state="stopped") for n in range(3)))
    return folder


@pytest.fixture
def walks(folder: Path) -> Iterator[Serving]:
    with serving(folder) as server:
        yield server


def select(dashboard: Dashboard, *boxes: int) -> None:
    """Select runs of the list by their places."""
    for box in boxes:
        dashboard.runs.get_by_role("checkbox").nth(box).click()


def test_several_runs_are_taken_away_as_a_file_and_brought_back(
    dashboard: Dashboard, walks: Serving, tmp_path: Path
) -> None:
    page, rows, names = dashboard.page, dashboard.runs, dashboard.run_names
    page.goto(f"{walks.address}#runs?sort=name")
    expect(names).to_have_text(["Walk 0", "Walk 1", "Walk 2"])
    rows.first.get_by_label("More for this training").click()
    expect(page.get_by_role("link", name="Archive (zip)")).to_be_visible()
    page.keyboard.press("Escape")
    select(dashboard, 1, 2)
    with page.expect_download() as download:
        page.get_by_role("link", name="Export 2").click()
    archive = download.value.path()  # waits for its end
    dashboard.button("Delete 2").click()
    expect(names).to_have_text(["Walk 0"])
    assert dashboard.violations() == []

    bad = tmp_path / "notes.zip"
    bad.write_text("no zip")
    page.get_by_label("Import…").set_input_files([archive, bad])
    expect(names).to_have_text(["Walk 0", "Walk 1", "Walk 2"])
    expect(page.get_by_text("has brought 2 runs.")).to_be_visible()
    imports = page.get_by_role("list", name="Imports").get_by_role("listitem")
    refused = imports.filter(has_text="is no archive of a run")
    expect(refused).to_have_count(1)
    assert dashboard.violations() == []
    drop(page, "again.zip")
    expect(refused).to_have_count(2)
    assert [complaint[:3] for complaint in dashboard.complaints] == ["422", "422"]
    dashboard.complaints.clear()
    page.set_viewport_size({"width": 360, "height": 780})
    assert dashboard.scroll_width() == 360
    assert dashboard.violations() == []


def test_a_note_says_that_files_can_be_dropped(dashboard: Dashboard, walks: Serving) -> None:
    page = dashboard.page
    page.goto(f"{walks.address}#runs")
    expect(page.get_by_label("Import…")).to_be_attached()
    drag(page, "run.zip", "dragover")
    expect(page.get_by_text("Drop to take in")).to_be_visible()
    outline = page.locator(".runs").evaluate("element => getComputedStyle(element).outlineStyle")
    assert outline == "dashed"


def test_without_archives_the_page_says_nothing_of_them(dashboard: Dashboard, folder: Path) -> None:
    page, names = dashboard.page, dashboard.run_names
    with serving(folder, without="archives") as server:
        page.goto(f"{server.address}#runs?sort=name")
        expect(names).to_have_text(["Walk 0", "Walk 1", "Walk 2"])
        select(dashboard, 0, 1)
        expect(dashboard.button("Delete 2")).to_be_visible()
        dashboard.runs.first.get_by_label("More for this training").click()
        expect(page.get_by_text("Nothing to download.")).to_be_visible()
        for word in ("Import", "Export", "Archive", "None has ended"):
            expect(page.get_by_text(word)).to_have_count(0)


def drop(page: Page, name: str) -> None:
    """Drop a file, whose content is no archive, on the page."""
    drag(page, name, "dragover", "drop")


def drag(page: Page, name: str, *types: str) -> None:
    """Dispatch events of a file that is dragged over the page."""
    page.evaluate(
        """([name, types]) => {
          const dataTransfer = new DataTransfer();
          dataTransfer.items.add(new File(["x"], name));
          for (const type of types) {
            const event = new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true });
            document.body.dispatchEvent(event);
          }
        }""",
        [name, types],
    )
