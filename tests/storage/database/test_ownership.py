"""Ownership of a SQLite database whose file is removed or replaced, and of one of PostgreSQL that
ends a connection; see also promise 31."""

import shutil
import time
from collections.abc import Callable
from pathlib import Path

import psycopg
import pytest

from app.storage.database.opening import DATABASE_FILE
from app.storage.database.ownership import WATCH_EVERY_S
from app.storage.errors import StorageFailed
from tests.postgresql import PostgresServer
from tests.storage.stores import database_url, opened, training

REPLACED = f"the database file {DATABASE_FILE} was removed or replaced while the server runs"


def eventually_refused(read: Callable[[], object]) -> str:
    """Read until it is refused, and return the reason."""
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            read()
        except StorageFailed as error:
            return str(error)
        time.sleep(0.05)
    raise AssertionError("it was not refused")


def eventually_accepted(read: Callable[[], object]) -> None:
    """Read until it is not refused any more."""
    deadline = time.monotonic() + 30
    while True:
        try:
            read()
            return
        except StorageFailed:
            assert time.monotonic() < deadline
            time.sleep(0.05)


def test_nothing_is_written_into_a_file_that_was_moved_away(tmp_path: Path) -> None:
    file, elsewhere = tmp_path / DATABASE_FILE, tmp_path / "elsewhere.db"
    with opened(tmp_path, None) as store:
        store.create(training("kept"))
        file.rename(elsewhere)
        reason = eventually_refused(store.list)
        assert reason.startswith(REPLACED)
        assert str(tmp_path) not in reason
        with pytest.raises(StorageFailed, match=REPLACED):
            store.create(training("refused"))

        elsewhere.rename(file)
        eventually_accepted(store.list)
        store.create(training("later"))
    with opened(tmp_path, None) as store:
        assert {run.id for run in store.list().runs} == {"kept", "later"}


def test_a_copy_is_another_file(tmp_path: Path) -> None:
    file = tmp_path / DATABASE_FILE
    with opened(tmp_path, None) as store:
        backup = shutil.copy(file, tmp_path / "backup.db")
        Path(backup).replace(file)
        assert REPLACED in eventually_refused(store.list)


def test_a_connection_that_the_database_has_ended_is_no_outage(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    """The lock is taken again by a new one."""
    locks = "FROM pg_locks WHERE locktype = 'advisory' AND granted"
    with database_url("postgresql", postgresql) as url, opened(tmp_path, url) as store:
        assert url is not None
        with psycopg.connect(url, autocommit=True) as connection:
            connection.execute(f"SELECT pg_terminate_backend(pid, 30000) {locks}")
            deadline = time.monotonic() + 3 * WATCH_EVERY_S
            store.create(training("a"))
            while time.monotonic() < deadline:
                store.update("a", name="b")
                time.sleep(0.02)
            assert connection.execute(f"SELECT count(*) {locks}").fetchone() == (1,)
