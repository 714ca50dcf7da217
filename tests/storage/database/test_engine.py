"""The connections that SQLite's engine holds."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from sqlalchemy import text

from app.storage.database.engine import SQLITE_FILES, Database, sqlite_engine
from app.storage.database.fair_semaphore import FairSemaphore
from tests.jobs.waiting import wait_until
from tests.promises.files import database_files

THREADS = 40
"""As many as answer requests at once."""


@contextmanager
def reading(database: Database) -> Iterator[None]:
    """Many threads read until the context ends."""
    over = threading.Event()

    def read() -> None:
        while not over.is_set():
            database.read(lambda connection: connection.execute(text("SELECT 1")).scalar_one())

    threads = [threading.Thread(target=read) for _ in range(THREADS)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        over.set()
        for thread in threads:
            thread.join()


def test_places_are_handed_over_in_the_order_in_which_threads_came() -> None:
    semaphore, order = FairSemaphore(1), []

    def take(number: int) -> None:
        with semaphore.taken(60.0, AssertionError):
            order.append(number)

    with semaphore.taken(1.0, AssertionError):
        threads = []
        for number in range(5):
            threads.append(threading.Thread(target=take, args=(number,)))
            threads[-1].start()
            wait_until(lambda: semaphore.waiting == len(threads))
        with pytest.raises(TimeoutError), semaphore.taken(0.01, TimeoutError):
            pass
    for thread in threads:
        thread.join()
    assert order == [*range(5)]


def test_many_threads_open_no_more_files_than_are_stated(tmp_path: Path) -> None:
    with closing(Database(sqlite_engine(tmp_path / "hexapods.db"))) as database:
        database.write(lambda connection: connection.execute(text("CREATE TABLE t (x INTEGER)")))
        most = 0
        with reading(database):
            deadline = time.monotonic() + 1.0
            while time.monotonic() < deadline:
                most = max(most, len(database_files(os.getpid(), tmp_path)))
                database.write(
                    lambda connection: connection.execute(text("INSERT INTO t VALUES (1)"))
                )
        assert 3 <= most <= SQLITE_FILES
        assert len(database_files(os.getpid(), tmp_path)) <= SQLITE_FILES
