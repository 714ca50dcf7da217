"""Promise 26: the queue never stops, whatever commands arrive in whatever order.

Model-based test: random verbs (start, pause, resume, stop, delete, PATCH, and kill -9 of a job's
process) against a state machine, while another client deletes further runs in every state. Each
answer must be allowed by the model; at the end no rows or files are left, and the queue moves.

Promised: 100,000 verbs. Here 120, with fewer starts; in full by `make soak`. `/readyz` answers
503 while a queued run waits beside a free core for 5 s, which is shown below by a supervisor that
cannot start it.
"""

import random
import signal
import sqlite3
import threading
import time
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import httpx2
import psutil
import pytest
from starlette.testclient import TestClient

from app.jobs.supervisor import STUCK_S, Supervisor
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import ARTIFACTS_FOLDER, DATABASE_FILE, open_store
from app.storage.errors import StorageFailed
from app.storage.run import LIVE, NOT_ENDED, PAUSED, RESUMABLE, RUNNING, STATES
from tests.api.calls import ADDRESS
from tests.jobs.waiting import wait_until
from tests.promises.length import at_length
from tests.promises.worst_values import OF_RUNS
from tests.served import BODY, ENDLESS, Served
from tests.storage.stores import opened
from tests.timeouts import LONG_S

VERBS = at_length(120, 100_000)
RUNS = 10
STARTS = at_length(0.04, 0.2)
"""Share of starts, each of which takes a process."""
SHORT = {**BODY, "steps": 30, "evaluate_every": 10}
ENDED = frozenset(STATES) - NOT_ENDED
SPONTANEOUS = {"queued": {"running"}, "running": {"finished"}, "paused": {"finished"}}
"""State → the states that a run may have reached by itself.

A paused run may finish: its last step may be done, and the message of its end in transit.
"""
assert SPONTANEOUS.keys() == NOT_ENDED, "each state that a run leaves by itself is in the model"
RESUMED = {**dict.fromkeys(PAUSED, "running"), **dict.fromkeys(RESUMABLE, "queued")}

WEIGHTS = {"look": 4, "pause": 4, "resume": 4, "change": 4, "stop": 1, "delete": 2}


class Model:
    """State-machine model of one run: the set of states that it may be in."""

    def __init__(self, shown: dict[str, Any]) -> None:
        self.path = f"/api/v1/trainings/{shown['id']}"
        self.is_short = shown["config"]["steps"] == SHORT["steps"]
        self.states = {"queued"}
        self.is_killed = False
        """Whether its process may have been killed, so that it may become `failed`."""

    def possible(self) -> set[str]:
        reachable, left = set(), set(self.states)
        while left:
            state = left.pop()
            reachable.add(state)
            further = SPONTANEOUS.get(state, set()) - reachable
            left |= further if self.is_short else further - {"finished"}
        if self.is_killed and reachable & LIVE:
            reachable.add("failed")
        return reachable

    def expect(
        self,
        response: httpx2.Response,
        transitions: Mapping[Any, str],
        refusing_states: Collection[str],
    ) -> None:
        """Check an answer against the model, and update the model.

        Args:
            response: to a verb.
            transitions: state before → state after, where the verb is possible.
            refusing_states: states in which it is refused.
        """
        before = self.possible()
        if response.status_code < 300:
            after = {transitions[state] for state in before & transitions.keys()}
            shown = response.json()["state"] if response.content else "deleted"
            # Meanwhile it may have changed its state by itself, even to its end.
            self.states = after
            ended = {"finished", "failed"} & before
            assert shown in self.possible() | after | ended, (before, response.text)
            self.states = {shown}
            self.is_killed &= shown in LIVE
        elif response.status_code == 409:
            self.states = before & set(refusing_states)
            assert self.states, (before, response.text)
        else:
            assert response.status_code in (429, 503), response.text


def start(client: httpx2.Client, chance: random.Random) -> Model | None:
    body = SHORT if chance.random() < 0.5 else ENDLESS
    response = client.post("/api/v1/trainings", json=body)
    assert response.status_code in (202, 429), response.text
    return Model(response.json()) if response.status_code == 202 else None


def apply_verb(client: httpx2.Client, run: Model, chance: random.Random) -> bool:
    """Send a random verb to a run; return False if it was deleted."""
    # Verbs that need a new process, which takes a second of a core, are rarer.
    (name,) = chance.choices(list(WEIGHTS), list(WEIGHTS.values()))
    if name == "look":
        shown = client.get(run.path).json()["state"]
        assert shown in run.possible(), (run.states, shown)
        run.states = {shown}
    elif name == "pause":
        run.expect(client.post(f"{run.path}/pause"), dict.fromkeys(RUNNING, "paused"), STATES)
    elif name == "resume":
        refusing_states = set(STATES) - RESUMED.keys()
        run.expect(client.post(f"{run.path}/resume"), RESUMED, refusing_states)
    elif name == "stop":
        run.expect(client.post(f"{run.path}/stop"), dict.fromkeys(NOT_ENDED, "stopped"), ENDED)
    elif name == "change":
        changed = client.patch(run.path, json={"settings": {"alpha": 0.5}})
        run.expect(changed, {state: state for state in LIVE}, set(STATES) - LIVE)
    else:
        run.expect(client.delete(run.path), dict.fromkeys(ENDED, "deleted"), NOT_ENDED)
    return run.states != {"deleted"}


def kill_one(server: Served, runs: list[Model], chance: random.Random) -> None:
    """Kill a random job's process; every live run may be the one that fails."""
    jobs = server.jobs()
    if not jobs:
        return
    with_process = [run for run in runs if run.possible() & LIVE]
    try:
        chance.choice(jobs).send_signal(signal.SIGKILL)
    except psutil.NoSuchProcess:
        return
    for run in with_process:
        run.is_killed = True


def delete_continually(address: str, done: threading.Event) -> int:
    """Start runs and request their deletion until it succeeds; return their number.

    The gate has a pause after each: a run that is not stopped takes a process, and a core.
    """
    count, chance = 0, random.Random(27)
    with httpx2.Client(base_url=address, timeout=LONG_S, trust_env=False) as client:
        while not done.is_set():
            response = client.post("/api/v1/trainings", json=SHORT)
            if response.status_code == 429:
                time.sleep(0.1)
                continue
            path = f"/api/v1/trainings/{response.json()['id']}"
            deadline = time.monotonic() + LONG_S
            while (answer := client.delete(path)).status_code != 204:
                assert answer.status_code == 409, answer.text
                assert time.monotonic() < deadline, client.get(path).text
                if done.is_set():
                    client.post(f"{path}/stop")
                time.sleep(chance.uniform(0, 0.02))
            assert client.get(path).status_code == 404
            count += 1
            done.wait(at_length(2.0, 0.0))
    return count


def rows_and_files(data: Path) -> tuple[int, int]:
    """Count the rows and artifact files in a data folder."""
    with closing(sqlite3.connect(data / DATABASE_FILE)) as database:
        rows = sum(database.execute(f"SELECT count(*) FROM {t}").fetchone()[0] for t in OF_RUNS)
    return rows, sum(path.is_file() for path in (data / ARTIFACTS_FOLDER).rglob("*"))


@pytest.mark.timeout(at_length(300, 5 * 3600))
def test_random_verbs_never_block_the_queue(launch: Callable[..., Served], tmp_path: Path) -> None:
    chance = random.Random(26)
    server = launch(HEXAPODS_STARTS_PER_MINUTE="1000000")
    runs: list[Model] = []
    done = threading.Event()
    with ThreadPoolExecutor(1) as pool:
        deleter = pool.submit(delete_continually, server.address, done)
        try:
            for number in range(VERBS):
                if not runs or (len(runs) < RUNS and chance.random() < STARTS):
                    started = start(server.client, chance)
                    runs += [started] if started else []
                elif number % 100 == 99:
                    kill_one(server, runs, chance)
                elif runs:
                    run = chance.choice(runs)
                    if not apply_verb(server.client, run, chance):
                        runs.remove(run)
                assert not deleter.done(), deleter.result()
        finally:
            done.set()
        assert deleter.result(LONG_S) > 0
    for run in runs:
        if server.client.get(run.path).json()["state"] not in ENDED:
            assert server.client.post(f"{run.path}/stop").status_code in (202, 409)
        assert server.client.delete(run.path).status_code == 204
    last = server.start(SHORT)
    assert server.in_state(last, *ENDED)["state"] == "finished", "the queue moves"
    assert server.client.delete(f"/api/v1/trainings/{last['id']}").status_code == 204
    assert server.client.get("/readyz").status_code == 200
    assert server.jobs() == []
    began = time.monotonic()
    assert server.end(signal.SIGTERM) == 0
    assert time.monotonic() - began < at_length(LONG_S, 10.0)
    # As the server does it an hour after a deletion.
    with open_store(Settings(data=tmp_path)) as store:
        store.deletions.now = lambda: datetime.now(UTC) + timedelta(hours=2)
        assert store.deletions.purge() > 0
    assert rows_and_files(tmp_path) == (0, 0)


def test_deleting_a_run_as_it_stops_does_not_block_the_queue(launch: Callable[..., Served]) -> None:
    """Each round stops a run, requests its deletion until it succeeds, and must free its core."""
    server = launch()
    for _ in range(at_length(2, 200)):
        run = server.start(ENDLESS)
        server.in_state(run, "running")
        path = f"/api/v1/trainings/{run['id']}"
        with ThreadPoolExecutor(1) as pool:
            stopping = pool.submit(httpx2.post, f"{server.address}{path}/stop", timeout=LONG_S)
            while (answer := server.client.delete(path)).status_code != 204:
                assert answer.status_code == 409, answer.text
            # The stop is answered with the stopped run, or with 404 once it is deleted.
            assert stopping.result(LONG_S).status_code in (202, 404)
    last = server.start(SHORT)
    assert server.in_state(last, *ENDED)["state"] == "finished"


def test_a_run_that_waits_beside_a_free_core_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise StorageFailed("refused by the test")

    settings = Settings(data=tmp_path, job_niceness=0)
    with (
        opened(tmp_path, None) as store,
        TestClient(create_app(settings, store), base_url=ADDRESS) as client,
    ):
        with monkeypatch.context() as patch:
            patch.setattr(Supervisor, "_start", refuse)
            run = client.post("/api/v1/trainings", json=SHORT).json()
            assert client.get("/readyz").status_code == 200
            time.sleep(STUCK_S - 1)
            wait_until(lambda: client.get("/readyz").status_code == 503)
            assert "beside a free core" in client.get("/readyz").json()["detail"]
        path = f"/api/v1/trainings/{run['id']}"
        wait_until(lambda: client.get(path).json()["state"] == "finished")
        assert client.get("/readyz").status_code == 200
