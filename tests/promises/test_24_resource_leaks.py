"""Promise 24: it runs for days: 24 h of simulated use: memory grows under 5 %, open files stay.

The database has at most `SQLITE_FILES` open files, and the number of all others does not grow.

In full by `make soak`: the use by a class in a day: 1,000 rounds of starting, watching,
disconnecting, reading and deleting. The gate's shorter form has 2 rounds after 2 warm-up rounds,
and allows 10 MB: so few cannot distinguish a leak from the allocator's behaviour.

The pool of processes for what-ifs and estimates has a test of its own, in full with 300 rounds of
asking, of workers that are killed, and of shutting down when idle.
"""

import threading
import time
from multiprocessing import forkserver
from typing import Any

import httpx2
import psutil
import pytest

from app.jobs.process_pool import ProcessPool
from app.storage.database.engine import SQLITE_FILES
from app.storage.errors import Busy
from tests.browser.serving import Serving
from tests.event_streams import WITH_PICTURE, frames_of
from tests.jobs.waiting import wait_until
from tests.promises.files import database_files
from tests.promises.length import at_length
from tests.promises.test_12_reconnect import Events
from tests.running_app import PATIENCE_S

WARM_UP = at_length(2, 50)
ROUNDS = at_length(2, 1000)
SOME_BYTES = at_length(10_000_000, 0)
NOTICED_S = 2.0
BODY = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20, "evaluate_every": 10}


def use_once(server: Serving, api: httpx2.Client) -> None:
    """Start, watch, read and delete one training, so that nothing of it is left."""
    viewers = [Events(server.port, path=WITH_PICTURE) for _ in range(2)]
    events = Events(server.port)
    events.next()
    run: dict[str, Any] = api.post("/trainings", json=BODY).json()
    path = f"/trainings/{run['id']}"
    while api.get(path).json()["state"] != "finished":
        time.sleep(0.05)
    for viewer in viewers:
        assert frames_of(viewer.until("piece"))
    for path_below in ("/curve", "/q-table", "/q-table?format=npz", "/nothing"):
        api.get(path + path_below)
    api.put("/stage", json={"run_id": run["id"]})
    api.post("/trainings", json={"gait": "none"})
    events.drop()
    for viewer in viewers:
        viewer.drop()
    assert api.delete(path).status_code == 204


def memory_and_files(server: Serving) -> tuple[int, int]:
    """Return resident memory and the number of open files other than the database's.

    Waits until closed connections are cleaned up.
    """
    deadline = time.monotonic() + PATIENCE_S
    while "hexapods_viewers 0.0" not in httpx2.get(f"{server.address}metrics").text:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert len(database_files(server.pid, server.data)) <= SQLITE_FILES
    return psutil.Process(server.pid).memory_info().rss, lowest_file_count(server)


def lowest_file_count(server: Serving) -> int:
    """Return the least number of open files over 2 s, since closed connections linger."""
    end = time.monotonic() + NOTICED_S
    counts = []
    while time.monotonic() < end:
        of_database = database_files(server.pid, server.data)
        counts.append(psutil.Process(server.pid).num_fds() - len(of_database))
        time.sleep(0.05)
    return min(counts)


@pytest.mark.timeout(6 * 3600)
def test_memory_and_open_files_do_not_grow(server: Serving) -> None:
    with httpx2.Client(base_url=f"{server.address}api/v1", timeout=PATIENCE_S) as api:
        for _ in range(WARM_UP):
            use_once(server, api)
        memory_before, files_before = memory_and_files(server)
        for _ in range(ROUNDS):
            use_once(server, api)
        memory, files = memory_and_files(server)

    assert memory <= memory_before * 1.05 + SOME_BYTES
    assert files <= files_before


POOL_ROUNDS = at_length(2, 300)


def use_pool_once(pool: ProcessPool, number: int) -> None:
    """Ask, and let the workers end: in turns since nobody asks, and since one is killed."""
    assert pool.map(abs, range(-20, 0)) == list(range(20, 0, -1))
    workers = [psutil.Process(pid) for pid in pool.pids]
    if number % 2:
        workers[0].kill()
        try:
            pool.map(abs, range(-20, 0))
        except Busy:
            assert pool.map(abs, [-1]) == [1]
    wait_until(lambda: pool.pids == [])
    gone, alive = psutil.wait_procs(workers, timeout=PATIENCE_S)
    assert not alive, f"of {len(gone) + len(alive)} workers"


def used_by_pool() -> tuple[int, int, int]:
    """Return the number of threads, of open files, and of the fork server's files.

    The least of each in 2 s, since what ends a process is cleared up a moment later.
    """
    this_process, fork_server = psutil.Process(), vars(forkserver._forkserver)["_forkserver_pid"]
    end, samples = time.monotonic() + NOTICED_S, []
    while time.monotonic() < end:
        fork_server_files = psutil.Process(fork_server).num_fds()
        samples.append((threading.active_count(), this_process.num_fds(), fork_server_files))
        time.sleep(0.05)
    threads, files, files_of_fork_server = map(min, zip(*samples, strict=True))
    return threads, files, files_of_fork_server


@pytest.mark.timeout(3600)
def test_a_pool_leaves_nothing_behind() -> None:
    pool = ProcessPool(count=2, idle_s=0.2)
    try:
        for number in range(2):
            use_pool_once(pool, number)
        before, memory_before = used_by_pool(), psutil.Process().memory_info().rss
        for number in range(POOL_ROUNDS):
            use_pool_once(pool, number)
        after, memory = used_by_pool(), psutil.Process().memory_info().rss
    finally:
        pool.close()
    assert all(now <= then for now, then in zip(after, before, strict=True)), (before, after)
    assert memory <= memory_before * 1.05 + SOME_BYTES
