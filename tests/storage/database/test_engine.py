"""Fair queuing of threads, and the number of files that SQLite's engine opens."""

import os
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from sqlalchemy import text

from app.storage.database.engine import SQLITE_FILES, Database, sqlite_engine
from app.storage.database.fifo_semaphore import FifoSemaphore
from tests.jobs.waiting import wait_until
from tests.promises.files import database_files

THREADS = 40
"""Size of the server's thread pool for requests."""


@contextmanager
def reading(database: Database) -> Iterator[None]:
    """Read from many threads until the context ends."""
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


def test_semaphore_is_handed_over_in_order_of_arrival() -> None:
    semaphore, order = FifoSemaphore(1), []

    def take(number: int) -> None:
        with semaphore.acquired(60.0, AssertionError):
            order.append(number)

    with semaphore.acquired(1.0, AssertionError):
        threads = []
        for number in range(5):
            threads.append(threading.Thread(target=take, args=(number,)))
            threads[-1].start()
            wait_until(lambda: semaphore.waiting == len(threads))
        with pytest.raises(TimeoutError), semaphore.acquired(0.01, TimeoutError):
            pass
    for thread in threads:
        thread.join()
    assert order == [*range(5)]


def test_open_files_are_bounded_with_many_threads(tmp_path: Path) -> None:
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
