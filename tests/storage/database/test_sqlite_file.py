"""Checks of the SQLite file: one that has lost its tables is assert_refused, not recreated."""

import json
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from app.settings import Settings
from app.storage.database import sqlite_file
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.read_only import open_read_only
from hexapods.domain.errors import DamagedFile
from tests.cli.running import hexapods
from tests.storage.stores import opened, training


def assert_refused(folder: Path, names: str) -> None:
    before = (folder / DATABASE_FILE).read_bytes()
    with pytest.raises(DamagedFile, match=names), opened(folder, None):
        pass
    with pytest.raises(DamagedFile, match=names), open_read_only(Settings(data=folder)):
        pass
    assert (folder / DATABASE_FILE).read_bytes() == before


@pytest.mark.parametrize("was_used", [False, True])
def test_empty_file_is_refused(was_used: bool, tmp_path: Path) -> None:
    if was_used:
        with opened(tmp_path, None) as store:
            store.create(training("a"))
    (tmp_path / DATABASE_FILE).write_bytes(b"")
    assert_refused(tmp_path, "is empty.*put a backup of it back.*move it away")
    done = hexapods("doctor", "--data", ".", "--json", folder=tmp_path, HEXAPODS_PORT="0")
    checks = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    assert not checks["data"]["ok"]
    assert "move it away" in checks["data"]["said"]
    (tmp_path / DATABASE_FILE).rename(tmp_path / "moved away")
    with opened(tmp_path, None) as store:
        assert store.list().items == []


@pytest.mark.parametrize("tables", [["runs"], None])
def test_file_without_its_tables_is_refused(tables: list[str] | None, tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        store.create(training("a", state="finished"))
        store.put_artifact("a", "q-table.npz", b"x")
    with closing(sqlite3.connect(tmp_path / DATABASE_FILE)) as file:
        query = "SELECT name FROM sqlite_master WHERE type = 'table'"
        for name in tables or [name for (name,) in file.execute(query).fetchall()]:
            file.execute(f"DROP TABLE {name}")
        file.commit()
    assert_refused(tmp_path, "has lost its tables .*runs")
    assert len(list(tmp_path.glob("artifacts/*/*"))) == 1, "the files are left for the backup"


def test_killed_first_start_leaves_no_database_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def die(database: object) -> None:
        raise SystemExit("killed")

    with monkeypatch.context() as patch:
        patch.setattr(sqlite_file, "migrate", die)
        with pytest.raises(SystemExit), opened(tmp_path, None):
            pass
    assert not (tmp_path / DATABASE_FILE).exists()
    (tmp_path / f"{DATABASE_FILE}.new").write_bytes(b"half")
    with opened(tmp_path, None) as store:
        store.create(training("a"))
    assert not (tmp_path / f"{DATABASE_FILE}.new").exists()
