"""Opening the store: exclusive ownership, recovery from a crash, and refused databases."""

import sqlite3
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from app.settings import Settings
from app.storage.database import engine
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.opening import DATABASE_FILE, open_store
from app.storage.errors import StorageFailed
from app.storage.run import NOT_ENDED, State
from hexapods.domain.errors import InvalidInput
from tests.postgresql import PostgresServer
from tests.storage.stores import BACKENDS, database_url, opened, training

on_both = pytest.mark.parametrize("backend", BACKENDS)
ROOT = Path(__file__).parents[3]


def database_of(folder: Path, url: str | None) -> Database:
    database_engine = (
        sqlite_engine(folder / DATABASE_FILE) if url is None else postgresql_engine(url)
    )
    return Database(database_engine)


@on_both
def test_unended_runs_of_a_crashed_server_become_interrupted(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    states: list[State] = ["queued", "running", "paused", "finished", "stopped", "failed"]
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            runs = [
                training(state, state=state, eta_s=3.0 if state == "running" else None)
                for state in states
            ]
            store.create(*runs)
            store.update_progress("running", 33)
        before = datetime.now(UTC) - timedelta(seconds=1)
        with opened(tmp_path, url) as store:
            for run in runs:
                recovered = store.get(run.id)
                if run.state in NOT_ENDED:
                    assert (recovered.state, recovered.eta_s) == ("interrupted", None)
                    assert recovered.error == "The server ended before the run did."
                    assert recovered.ended_at is not None
                    assert recovered.ended_at > before
                else:
                    assert recovered == run
            assert store.get("running").done == 33


@on_both
def test_orphaned_files_are_deleted_on_opening(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            store.create(training("a", state="finished"), training("b", state="finished"))
            for run_id in "ab":
                store.put_artifact(run_id, "q-table.npz", b"old")
                store.put_artifact(run_id, "q-table.npz", b"new")
        (folder,) = (tmp_path / "artifacts").iterdir()
        assert len(list(folder.iterdir())) == 2
        (folder / ("0" * 32)).write_bytes(b"written, and then the server died")
        (folder / f".{'1' * 32}.part").write_bytes(b"not even all of it")
        (folder / "notes.txt").write_text("someone's own")
        with opened(tmp_path, url) as store:
            assert store.artifact("a", "q-table.npz") == b"new"
            assert len(list(folder.iterdir())) == 3
            store.delete("a")
            assert len(list(folder.iterdir())) == 2
            assert store.artifact("b", "q-table.npz") == b"new"


def test_files_of_another_database_are_not_deleted(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    with opened(tmp_path, None) as store:
        store.create(training("a"))
        store.put_artifact("a", "q-table.npz", b"kept")
    with postgresql.database() as url, opened(tmp_path, url) as store:
        assert store.list().items == []
    with opened(tmp_path, None) as store:
        assert store.artifact("a", "q-table.npz") == b"kept"


def test_data_folder_is_locked_by_one_server(tmp_path: Path) -> None:
    script = f"from tests.storage.stores import *\nwith opened(Path({str(tmp_path)!r}), None): pass"
    with opened(tmp_path, None):
        with pytest.raises(InvalidInput, match=r"another server .* HEXAPODS_DATA"):
            open_store(Settings(data=tmp_path)).__enter__()
        other = subprocess.run(
            [sys.executable, "-c", script],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )
        assert "another server uses the data folder" in other.stderr
    with opened(tmp_path, None):
        pass


def test_postgresql_database_is_locked_by_one_server(
    postgresql: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.storage.database.ownership._LOCK_WAIT_S", 0.2)
    with postgresql.database() as url:
        with opened(tmp_path / "one", url), pytest.raises(InvalidInput, match="another server"):
            open_store(Settings(data=tmp_path / "two", database_url=url)).__enter__()
        with opened(tmp_path / "two", url):
            pass


@on_both
def test_newer_schema_is_refused(backend: str, postgresql: PostgresServer, tmp_path: Path) -> None:
    with database_url(backend, postgresql) as url:
        with opened(tmp_path, url) as store:
            store.create(training("a"))
        database = database_of(tmp_path, url)
        newer = text("UPDATE alembic_version SET version_num = '9999'")
        database.write(lambda connection: connection.execute(newer))
        with pytest.raises(InvalidInput, match=r"newer version .* 9999.* install") as error:
            open_store(Settings(data=tmp_path, database_url=url)).__enter__()
        assert "\n" not in str(error.value)
        state = text("SELECT state FROM runs")
        stored_state = database.read(lambda connection: connection.execute(state).scalar())
        assert stored_state == "queued"
        database.close()


def test_file_that_is_no_database_is_refused_and_unchanged(tmp_path: Path) -> None:
    (tmp_path / DATABASE_FILE).write_bytes(b"holiday pictures" * 100)
    with pytest.raises(StorageFailed, match="no database"):
        open_store(Settings(data=tmp_path)).__enter__()
    assert (tmp_path / DATABASE_FILE).read_bytes().startswith(b"holiday")


def test_unreachable_postgresql_is_reported_without_the_password(tmp_path: Path) -> None:
    url = f"postgresql://me:sesame@/db?host={tmp_path}"
    with pytest.raises(StorageFailed, match="does not answer") as error:
        open_store(Settings(data=tmp_path, database_url=url)).__enter__()
    assert "sesame" not in str(error.value)


def test_sqlite_pragmas_make_writes_durable(tmp_path: Path) -> None:
    with opened(tmp_path, None):
        database = database_of(tmp_path, None)

        def pragma(name: str) -> object:
            return database.read(lambda c: c.exec_driver_sql(f"PRAGMA {name}").scalar())

        assert pragma("journal_mode") == "wal"
        assert pragma("synchronous") == 2
        assert pragma("foreign_keys") == 1
        assert pragma("busy_timeout") == 10_000
        database.close()


def test_database_locked_by_another_program_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "BUSY_S", 0.3)
    with opened(tmp_path, None) as store:
        store.create(training("a"))
        other = sqlite3.connect(tmp_path / DATABASE_FILE, isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(StorageFailed, match="another program holds the database"):
            store.change("a", NOT_ENDED, "running")
        assert store.get("a").state == "queued"
        other.execute("ROLLBACK")
        other.close()
        assert store.change("a", NOT_ENDED, "running").state == "running"
