"""Files of a walk on the page: offered where a run is, and nowhere where exports are left out."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import PATIENCE_MS, Dashboard
from tests.browser.serving import Serving, serving
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

pytestmark = pytest.mark.timeout(300)

TRAINING, RACED = "00000000000t1", "00000000000r1"
JOINTS, VIDEO = "Joints and feet (CSV)", "Video (MP4)"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data folder with a finished training and race."""
    with opened(tmp_path / "data", None) as store:
        ended_training(store, TRAINING)
        ended_race(store, RACED, TRAINING)
        # As jobs set it; without it a run is one that was imported, of which nothing was recorded.
        store.update(RACED, started_at=datetime.now(UTC))
    return tmp_path / "data"


@pytest.fixture
def raced(folder: Path) -> Iterator[Serving]:
    with serving(folder) as server:
        yield server


def open_menu(dashboard: Dashboard, server: Serving) -> None:
    """Open the menu of the race in the list of runs."""
    dashboard.open(f"{server.address}#runs?kind=race")
    dashboard.runs.first.get_by_label("More for this race").click()
    expect(dashboard.page.get_by_role("link", name="Recording", exact=True)).to_be_visible()


def test_files_of_a_race_are_downloaded_and_rendered(dashboard: Dashboard, raced: Serving) -> None:
    page = dashboard.page
    open_menu(dashboard, raced)
    menu = page.locator(".run-menu[open] .menu-body")
    expect(menu.get_by_role("button", name=VIDEO)).to_be_in_viewport(ratio=1)
    with page.expect_download() as saved:
        menu.get_by_role("link", name=JOINTS).click()
    assert saved.value.suggested_filename == f"race-{RACED}.csv"
    with page.expect_download(timeout=2 * PATIENCE_MS) as saved:
        menu.get_by_role("button", name=VIDEO).click()
    assert Path(saved.value.path()).read_bytes()[4:8] == b"ftyp"

    dashboard.open(raced.link(depth="study", run=RACED))
    page.get_by_text("Download this race").click()
    expect(page.get_by_role("link", name=JOINTS)).to_be_visible()
    assert dashboard.violations() == []


def test_without_exports_the_page_says_nothing_of_them(dashboard: Dashboard, folder: Path) -> None:
    page = dashboard.page
    with serving(folder, without="exports") as server:
        open_menu(dashboard, server)
        for words in (JOINTS, VIDEO, "not installed"):
            expect(page.get_by_text(words)).to_have_count(0)
        dashboard.open(server.link(depth="study", run=RACED))
        page.get_by_text("Download this race").click()
        expect(page.get_by_role("link", name="Recording", exact=True)).to_be_visible()
        expect(page.get_by_role("link", name=JOINTS)).to_have_count(0)
