"""Promise 4: a locked database loses nothing.

Promised: another process holds an exclusive lock for 5 s, 0 writes lost. Here 1 s; 5 s by
`make soak`. Eight threads write meanwhile, each its own curve, and all compete for the same runs.
While nothing can be written, `/readyz` says so, also if nobody tries to write.
"""

import threading
import time
from pathlib import Path

import pytest

from app.storage.database.opening import DATABASE_FILE
from app.storage.errors import Conflict
from app.storage.run import QUEUED
from tests.postgresql import PostgresServer
from tests.promises.length import at_length
from tests.promises.processes import start_script
from tests.served import Served, serving_from
from tests.storage.stores import BACKENDS, database_url, opened, training
from tests.timeouts import LONG_S

HELD_S = at_length(1.0, 5.0)
THREADS, WRITES = 8, 25


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_locked_database_loses_nothing(
    backend: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url(backend, postgresql) as url, opened(tmp_path, url) as store:
        contested = [f"c{number:02}" for number in range(WRITES)]
        store.create(*(training(run_id) for run_id in contested))
        store.create(*(training(f"t{thread}") for thread in range(THREADS)))
        won: list[str] = []
        failed: list[BaseException] = []

        def write(thread: int) -> None:
            try:
                for number, run_id in enumerate(contested):
                    row = {"step": number, "distance_m": 0.5, "epsilon": 0.5}
                    store.curves.append(f"t{thread}", [row])
                    store.put_artifact(f"t{thread}", "q-table.npz", bytes([number]) * 1000)
                    try:
                        store.change(run_id, QUEUED, "running", done=thread)
                    except Conflict:
                        continue
                    won.append(run_id)
            except BaseException as error:
                failed.append(error)
                raise

        holder = start_script(
            "tests.promises.database_holder", url or str(tmp_path / DATABASE_FILE), str(HELD_S)
        )
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        began = time.monotonic()
        threads = [threading.Thread(target=write, args=(n,)) for n in range(THREADS)]
        for thread in threads:
            thread.start()
        holder.communicate("go on\n")
        for thread in threads:
            thread.join()
        took_s = time.monotonic() - began

        assert holder.returncode == 0
        assert failed == []
        assert took_s > HELD_S, "the lock must have delayed the writes"
        assert sorted(won) == contested, "each run has exactly one winner"
        for number in range(THREADS):
            assert [row["step"] for row in store.curves.get(f"t{number}")] == list(range(WRITES))
            assert store.artifact(f"t{number}", "q-table.npz") == bytes([WRITES - 1]) * 1000


def wait_until_ready(server: Served, is_ready: bool) -> str:
    """Wait until `/readyz` says that runs can be started, or that they cannot; return its body."""
    deadline = time.monotonic() + LONG_S
    while (answer := server.client.get("/readyz")).status_code != (200 if is_ready else 503):
        assert time.monotonic() < deadline, answer.text
        time.sleep(0.1)
    return answer.text


def test_a_server_that_cannot_write_is_not_ready(tmp_path: Path) -> None:
    with serving_from(tmp_path) as launch:
        server = launch()
        wait_until_ready(server, True)
        holder = start_script("tests.promises.database_holder", str(tmp_path / DATABASE_FILE), "0")
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        assert "another program holds the database" in wait_until_ready(server, False)
        assert server.client.get("/api/v1/runs").status_code == 200, "reading goes on"
        holder.communicate("go on\n")
        wait_until_ready(server, True)
