"""Promise 1, for the store: kill -9 corrupts no file and loses no acknowledged row.

Promised: 50 kills at random times. Here 2 on SQLite and 1 on PostgreSQL; 50 each by `make soak`.
Each kill hits a process that writes as fast as it can; the store is opened again after each.
"""

import random
import sqlite3
import time
from collections import defaultdict
from contextlib import closing
from pathlib import Path

import pytest

from app.storage.database.opening import DATABASE_FILE
from app.storage.database.store import RunStore
from tests.postgresql import PostgresServer
from tests.promises.length import at_length
from tests.promises.processes import start_script
from tests.promises.writer import CHECKPOINT, checkpoint
from tests.storage.stores import database_url, opened

KILLS = {"sqlite": at_length(2, 50), "postgresql": at_length(1, 50)}


@pytest.mark.timeout(at_length(120, 1200))
@pytest.mark.parametrize("backend", KILLS)
def test_a_killed_server_loses_nothing_that_it_acknowledged(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    chance = random.Random(backend)
    acknowledged: dict[str, dict[str, int]] = defaultdict(dict)
    with database_url(backend, postgresql) as url:
        for _ in range(KILLS[backend]):
            first = 1 + max((int(run_id) for run_id in acknowledged), default=0)
            # The last run may have been created without its acknowledgement.
            write_until_killed(tmp_path, url, first + 1, chance.uniform(0, 0.5), acknowledged)
            with opened(tmp_path, url) as store:
                check(store, acknowledged)
                check_files(store, tmp_path)
        if backend == "sqlite":
            with closing(sqlite3.connect(tmp_path / DATABASE_FILE)) as connection:
                assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    assert len(acknowledged) >= KILLS[backend]


def write_until_killed(
    folder: Path,
    url: str | None,
    first: int,
    after_s: float,
    acknowledged: dict[str, dict[str, int]],
) -> None:
    process = start_script("tests.promises.writer", str(folder), url or "", str(first))
    assert process.stdout is not None
    lines = [process.stdout.readline()]
    time.sleep(after_s)
    process.kill()
    lines += process.stdout.readlines()
    assert process.wait() == -9
    for line in lines:
        what, run_id, *step = line.split()
        acknowledged[run_id][what] = int(step[0]) if step else 1
    process.stdout.close()
    assert process.stdin is not None
    process.stdin.close()


def check(store: RunStore, acknowledged: dict[str, dict[str, int]]) -> None:
    for run_id, lines in acknowledged.items():
        run = store.get(run_id)
        # A write in progress at the kill may have been committed without its acknowledgement.
        assert run.state in (["finished"] if "finished" in lines else ["interrupted", "finished"])
        steps = [row["step"] for row in store.curves.get(run_id)]
        assert steps == list(range(1, len(steps) + 1))
        assert len(steps) >= lines.get("evaluated", 0)
        data = store.artifact(run_id, CHECKPOINT)
        saved = lines.get("saved", 0)
        assert data in ([None] if saved == 0 else []) + [checkpoint(saved), checkpoint(saved + 1)]


def check_files(store: RunStore, folder: Path) -> None:
    """Check that every run has its one file, and that there are no orphaned files."""
    runs = store.list(limit=1_000_000).items
    file_count = sum(store.artifact(run.id, CHECKPOINT) is not None for run in runs)
    assert len([path for path in folder.glob("artifacts/*/*") if path.is_file()]) == file_count
    assert all(run.state in ("finished", "interrupted") for run in runs)
