"""The example of a feature of another package: a route, a table and a row in the menu."""

import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.settings import Settings
from tests.api.conftest import running
from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving
from tests.cli.running import EXAMPLES
from tests.conftest import new_page

_FOLDER = EXAMPLES / "journal_feature"


@pytest.fixture
def installed(tmp_path: Path) -> Iterator[Path]:
    """The folder of an installation of the package, as its `pyproject.toml` declares it."""
    site = tmp_path / "site"
    shutil.copytree(_FOLDER / "hexapods_journal", site / "hexapods_journal")
    project = tomllib.loads((_FOLDER / "pyproject.toml").read_text())["project"]
    about = site / "hexapods_journal-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    lines = [
        line
        for group, points in project["entry-points"].items()
        for line in (f"[{group}]", *(f"{name} = {value}" for name, value in points.items()))
    ]
    (about / "entry_points.txt").write_text("\n".join(lines))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(site))
        patch.setenv("PYTHONPATH", str(site))
        yield site


@pytest.mark.usefixtures("installed")
def test_entries_of_the_journal_are_stored(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with running(Settings(data=data)) as api:
        assert api.get("/journal") == {"items": []}
        written = api.call("POST", "/journal", json={"text": "The tripod slips on ice."})
        assert (written.status_code, written.json()["number"]) == (201, 1)
        assert api.call("POST", "/journal", json={"text": ""}).status_code == 422
    with running(Settings(data=data, without=("journal",))) as api:
        assert api.call("GET", "/journal").status_code == 404
    with running(Settings(data=data)) as api:
        (entry,) = api.get("/journal")["items"]
        assert entry["text"] == "The tripod slips on ice."
        described = api.client.get("/openapi.json").json()
        assert "/api/v1/journal" in described["paths"]


@pytest.mark.usefixtures("installed")
def test_its_row_is_in_the_menu(tmp_path: Path, flat_browser: Browser) -> None:
    with serving(tmp_path / "data") as server, new_page(flat_browser) as page:
        dashboard = Dashboard(page, has_3d=False)
        dashboard.open(server.address)
        page.get_by_label("More", exact=True).first.click()
        page.get_by_role("menuitem", name="Journal…").click()
        journal = page.get_by_role("dialog", name="Journal")
        expect(journal.get_by_text("Nothing is written yet.")).to_be_visible()
        journal.get_by_label("Next entry").fill("Walks again.")
        journal.get_by_role("button", name="Write").click()
        expect(journal.get_by_role("listitem")).to_have_text(["Walks again."])
        assert dashboard.complaints == []
