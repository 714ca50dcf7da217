"""Promise 36: reading is bounded: 25 clients that request the largest table and read nothing of it
cost the server less than 100 MB, and so do 25 of every other heavy answer. So does the longest
race, of 20,000 steps of its lanes: while it runs, when it ends, and whatever is read of it.

The largest table is one of 8 divisions, 52,728,000 values, as JSON, CSV and `.npz`. Beside it a
race's recording, its arrays and its timeline, an experiment's trials, report
and files, curves, and exports. The gate's form has a table of 400,000 values that were visited,
and five of these answers; `make soak` has 2,500,000 values, and all of the answers.
"""

import io
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from hexapods.agents.q_table import QTable
from hexapods.assembly import build_learner
from hexapods.runs.config import training_config
from hexapods.runs.race_config import MAX_RACE_STEPS
from hexapods.runs.tables import Checkpoint, snapshot, to_bytes
from tests.promises.length import at_length
from tests.promises.raw import watched_memory
from tests.served import BODY, Served, serving_from

READERS = 25
MAX_BYTES = 100_000_000
VISITED_STATES = at_length(40_000, 250_000)
SETTLED_S = at_length(0.5, 10.0)
RACE = {**BODY, "steps": 60, "lanes": [{"agent": "greedy"}] * 4}
LONG_RACE: dict[str, Any] = {**BODY, "lanes": [{"agent": "random-walk"}, {"agent": "greedy"}] * 3}
LONG_RACE_STEPS = MAX_RACE_STEPS // len(LONG_RACE["lanes"])
READ_BYTES = at_length(5_000_000, 100_000_000)
EXPERIMENT = {
    "experiment": "sweep",
    "seeds": 30,
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "steps": 40,
    "settings": {"alpha": [0.1, 0.2, 0.3, 0.4, 0.5]},
}
TABLES = at_length(
    ("q-table", "q-table?format=npz", "export"),
    ("q-table", "q-table?format=csv", "q-table?format=npz", "curve", "export"),
)
RACES = at_length(
    ("recording", "timeline"),
    ("recording", "recording?format=npz", "timeline", "export"),
)
EXPERIMENTS = ("trials", "trials?format=csv", "summary", "report", "files/trials.csv", "export")


def large_table() -> bytes:
    """Build the file of a table of 8 divisions as after a long training."""
    config = training_config(gait="left-right-origin", simulator="kinematic", divisions=8, steps=1)
    table, chance = QTable(3, len(config.grid)), np.random.default_rng(0)
    for state in chance.permutation(table.states)[:VISITED_STATES].tolist():
        q, n = table.row(state)
        columns = chance.integers(table.actions, size=10)
        q[columns], n[columns] = chance.normal(size=10), 1
    checkpoint = snapshot(build_learner(config), replace(config, steps=1))
    agent = {f"agent.{name}": array for name, array in table.dump().items()}
    return to_bytes(Checkpoint(checkpoint.meta, {**checkpoint.arrays, **agent}))


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving_from(tmp_path_factory.mktemp("data")) as make:
        yield make()


@pytest.fixture(scope="module")
def paths(server: Served) -> list[str]:
    """The paths of the server's heavy answers."""
    table = large_table()
    answer = server.client.post("/api/v1/trainings/import", content=table)
    assert answer.status_code == 201, answer.text
    runs: list[dict[str, Any]] = [answer.json(), server.start(RACE, "/races")]
    heavy = [TABLES, RACES]
    if at_length(False, True):
        runs.append(server.start(EXPERIMENT, "/experiments"))
        heavy.append(EXPERIMENTS)
    for run in runs:
        server.in_state(run, "finished")
    return [
        f"/api/v1/{run['kind']}s/{run['id']}/{path}"
        for run, paths in zip(runs, heavy, strict=True)
        for path in paths
    ]


@contextmanager
def unread_clients(server: Served, path: str) -> Iterator[list[socket.socket]]:
    """Connect clients that send a request and do not read the answer."""
    host, port = server.address.removeprefix("http://").split(":")
    with ExitStack() as stack:
        clients = []
        for _ in range(READERS):
            client = stack.enter_context(socket.socket())
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.connect((host, int(port)))
            client.sendall(f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n".encode())
            clients.append(client)
        yield clients


def statuses(clients: list[socket.socket]) -> set[bytes]:
    for client in clients:
        client.settimeout(60)
    return {client.recv(12) for client in clients}


def settle(server: Served) -> None:
    """Wait until the server is idle."""
    process, quiet_s = psutil.Process(server.process.pid), 0.0
    deadline = time.monotonic() + 60
    while quiet_s < SETTLED_S and time.monotonic() < deadline:
        busy = process.cpu_percent(0.25)
        quiet_s = quiet_s + 0.25 if busy < 40 else 0.0


@pytest.mark.timeout(1800)
def test_unread_answers_use_bounded_memory(server: Served, paths: list[str]) -> None:
    for path in paths:
        # Warm up, so that modules and caches are loaded before memory is measured.
        with server.client.stream("GET", path) as response:
            assert response.status_code == 200, path
            next(response.iter_bytes())
    grown = {}
    for path in paths:
        settle(server)
        with watched_memory(server.process.pid) as memory, unread_clients(server, path) as clients:
            settle(server)
            answered = statuses(clients)
        assert answered == {b"HTTP/1.1 200"}, path
        grown[path] = memory.grown_bytes

    assert max(grown.values()) < MAX_BYTES, grown


@pytest.mark.timeout(1800)
def test_a_table_read_beside_unread_ones_is_complete(server: Served, paths: list[str]) -> None:
    npz = next(path for path in paths if path.endswith("format=npz"))
    with unread_clients(server, paths[0]), unread_clients(server, npz):
        whole = server.client.get(npz).content

    with np.load(io.BytesIO(whole)) as file:
        assert len(file["agent.where"]) > 9 * VISITED_STATES


@pytest.mark.timeout(1800)
def test_a_training_with_a_large_table_uses_bounded_memory(tmp_path: Path) -> None:
    """The job's process, which needed 1.5 GB before the table was sparse."""
    steps = at_length(2_000, 200_000)
    body = {**BODY, "divisions": 8, "steps": steps, "evaluate_every": steps // 2}
    with serving_from(tmp_path) as make:
        server = make()
        run = server.start(body)
        peak = 0
        while server.look(run)["state"] not in ("finished", "failed"):
            with suppress(psutil.Error):  # the process may end at any moment
                peak = max(peak, *(job.memory_info().rss for job in server.jobs()), 0)
            time.sleep(0.02)
        assert server.look(run)["state"] == "finished"

    assert 0 < peak < 350_000_000


@pytest.mark.timeout(1800)
def test_a_long_race_uses_bounded_memory(tmp_path: Path) -> None:
    with serving_from(tmp_path) as make:
        server = make()
        # So that modules are loaded before memory is measured.
        short = server.start({**LONG_RACE, "steps": 60}, "/races")
        server.in_state(short, "finished")
        read_all(server, short)
        settle(server)
        with watched_memory(server.process.pid) as memory:
            race = server.start({**LONG_RACE, "steps": LONG_RACE_STEPS}, "/races")
            server.after_step(race, LONG_RACE_STEPS)
            assert server.client.get(f"/api/v1/races/{race['id']}/timeline").status_code == 200
            server.in_state(race, "finished")
            alive_bytes = memory.grown_bytes
            read_all(server, race)

    assert memory.grown_bytes < MAX_BYTES, (alive_bytes, memory.grown_bytes)


def read_all(server: Served, race: dict[str, Any]) -> None:
    """Read all that can be read of a race, of long answers the first megabytes."""
    of_race = ["timeline", "timeline?clock=wall", "recording", "recording?format=npz", "export"]
    of_run = ["gait", "gait?from_s=3", "replay", "replay/scene", "replay/segments/0/0"]
    of_run += ["explain?step=7&lane=0", "explain?step=7&lane=1"]
    of_run += ["replay/segments/7/0", "replay/moment?time_s=500", "trajectory?format=csv"]
    paths = [f"races/{race['id']}/{path}" for path in of_race]
    paths += [f"runs/{race['id']}/{path}" for path in of_run]
    for path in paths:
        read = 0
        with server.client.stream("GET", f"/api/v1/{path}") as response:
            assert response.status_code == 200, path
            for chunk in response.iter_raw():
                read += len(chunk)
                if read > READ_BYTES:
                    break
