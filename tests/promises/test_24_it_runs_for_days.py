"""Promise 24: it runs for days: 24 h of simulated use: memory grows under 5 %, open files stay.

The database has at most `SQLITE_FILES` open files, and of all others there are as many as before.

In full by `make soak`: what a class does in a day, one after another: 1,000 rounds of starting,
watching, dropping, asking and deleting. The gate's shorter form has 6 rounds after 4 that warm the
server up, and allows for 10 MB: so few cannot tell a leak from an allocator.
"""

import time
from typing import Any

import httpx2
import psutil
import pytest

from app.storage.database.engine import SQLITE_FILES
from tests.browser.serving import Serving
from tests.promises.files import database_files
from tests.promises.length import at_length
from tests.promises.test_12_browsers_come_back import Events
from tests.viewer.serving import PATIENCE_S, Viewer

WARM_UP = at_length(4, 50)
ROUNDS = at_length(6, 1000)
SOME_BYTES = at_length(10_000_000, 0)
NOTICED_S = 2.0
BODY = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20, "evaluate_every": 10}


def one_round(server: Serving, api: httpx2.Client) -> None:
    """One training and what belongs to it, and nothing of it left."""
    viewers = [Viewer(f"ws://127.0.0.1:{server.port}/viewer/?view={view}") for view in ("1", "2")]
    events = Events(server.port, None)
    events.next()
    run: dict[str, Any] = api.post("/trainings", json=BODY).json()
    path = f"/trainings/{run['id']}"
    while api.get(path).json()["state"] != "finished":
        time.sleep(0.02)
    for viewer in viewers:
        viewer.frame()
    for asked in ("/curve", "/q-table", "/q-table?format=npz", "/nothing"):
        api.get(path + asked)
    api.put("/stage", json={"run_id": run["id"]})
    api.post("/trainings", json={"gait": "none"})
    events.drop()
    for viewer in viewers:
        viewer.socket.close()
    assert api.delete(path).status_code == 204


def settled(server: Serving) -> tuple[int, int]:
    """Its memory, and its open files beside those of the database, once what was closed is gone."""
    deadline = time.monotonic() + PATIENCE_S
    while "hexapods_viewers 0.0" not in httpx2.get(f"{server.address}metrics").text:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert len(database_files(server.pid, server.data)) <= SQLITE_FILES
    return psutil.Process(server.pid).memory_info().rss, fewest_files(server)


def fewest_files(server: Serving) -> int:
    """A connection that was just closed counts until the server has noticed it."""
    end = time.monotonic() + NOTICED_S
    counts = []
    while time.monotonic() < end:
        ours = database_files(server.pid, server.data)
        counts.append(psutil.Process(server.pid).num_fds() - len(ours))
        time.sleep(0.05)
    return min(counts)


@pytest.mark.timeout(6 * 3600)
def test_nothing_grows(server: Serving) -> None:
    with httpx2.Client(base_url=f"{server.address}api/v1", timeout=PATIENCE_S) as api:
        for _ in range(WARM_UP):
            one_round(server, api)
        memory_before, files_before = settled(server)
        for _ in range(ROUNDS):
            one_round(server, api)
        memory, files = settled(server)

    assert memory <= memory_before * 1.05 + SOME_BYTES
    assert files <= files_before
