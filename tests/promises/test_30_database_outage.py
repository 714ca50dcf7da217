"""Promise 30: a database outage loses nothing.

PostgreSQL is stopped, crashes, or hangs with its connections open, at a random moment of a run's
life: the run waits, continues, and ends with the table of an uninterrupted run. Promised: 1 s to
10 min at random moments; here 1 s once in each of the three ways, by `make soak` 1 s to 60 s at 20.
A job that has waited for ten minutes becomes `interrupted`, which is shown with a shorter limit.
"""

import random
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.jobs.submissions import TrainingStart
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from hexapods.runs.config import WalkingProblem, training_config
from tests.jobs.waiting import wait_for_progress, wait_until, wait_until_ended
from tests.postgresql import PostgresServer, postgres_server
from tests.promises.length import at_length
from tests.served import BODY, Served
from tests.storage.stores import opened
from tests.timeouts import LONG_S

MOMENTS = at_length(3, 20)
LONGEST_S = at_length(1.0, 60.0)
STEPS = at_length(120, 300)
PACED = {**BODY, "steps": STEPS, "pace": 20, "evaluate_every": STEPS // 6, "seed": 30}
FAILED_S = at_length(LONG_S, 5.0)
"""Limit for fifty reads: if they waited for a connection, each would take 5 s."""
RUN_S = STEPS / 43
"""Approximate duration of such a run."""


@pytest.fixture(scope="module")
def own_postgresql() -> Iterator[PostgresServer]:
    """A PostgreSQL server for these tests alone, each of which leaves it running."""
    with postgres_server() as server:
        yield server


def outage(server: PostgresServer, kind: str, length_s: float) -> None:
    """Make the database unavailable for a while."""
    if kind == "hangs":
        server.freeze()
        time.sleep(length_s)
        server.thaw()
    else:
        server.stop(signal.SIGINT if kind == "stops" else signal.SIGQUIT)
        time.sleep(length_s)
        server.start()


@pytest.mark.timeout(at_length(300, 7200))
def test_every_run_survives_an_outage_with_the_same_result(
    launch: Callable[..., Served], own_postgresql: PostgresServer
) -> None:
    chance = random.Random(30)
    with own_postgresql.database() as url:
        server = launch(HEXAPODS_DATABASE_URL=url)
        run = server.in_state(server.start({**PACED, "pace": "max"}), "finished", "failed")
        unbroken, curve = run["result"], curve_of(server, run)
        for number in range(MOMENTS):
            kind = ("stops", "crashes", "hangs")[number % 3]
            run = server.start(PACED)
            time.sleep(chance.uniform(0, RUN_S))
            began = time.monotonic()
            outage(own_postgresql, kind, chance.uniform(1, LONGEST_S))
            away_s = time.monotonic() - began
            ended = until_ended(server, run)
            assert ended["state"] == "finished", (kind, away_s, ended)
            assert ended["result"] == unbroken, (kind, away_s)
            assert curve_of(server, run) == curve, (kind, away_s)
            assert ready(server), "the server is ready again"
        assert server.jobs() == []
        assert server.end(signal.SIGTERM) == 0


def test_reads_fail_fast_while_the_database_hangs(
    launch: Callable[..., Served], own_postgresql: PostgresServer
) -> None:
    with own_postgresql.database() as url:
        server = launch(HEXAPODS_DATABASE_URL=url)
        own_postgresql.freeze()
        time.sleep(5)
        began = time.monotonic()
        for _ in range(50):
            answer = server.client.get("/api/v1/trainings")
            assert answer.status_code == 503
            assert "PostgreSQL" in answer.json()["detail"]
        assert server.client.get("/healthz").status_code == 200
        assert server.client.get("/readyz").status_code == 503
        assert time.monotonic() - began < FAILED_S
        own_postgresql.thaw()
        assert ready(server)


def test_after_the_longest_wait_a_job_is_interrupted_and_can_be_resumed(
    own_postgresql: PostgresServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.jobs.job.MAX_OUTAGE_S", 1.0)
    walk = WalkingProblem(gait="left-right-origin", simulator="kinematic")
    config = training_config(**vars(walk), steps=300, pace=20, evaluate_every=0)
    with own_postgresql.database() as url, opened(tmp_path, url) as store:
        jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
        jobs.open()
        try:
            run = jobs.start(TrainingStart(config))
            wait_for_progress(store, run)
            outage(own_postgresql, "stops", 4.0)
            wait_until(lambda: ready_store(store))
            left = wait_until_ended(store, run)
            assert left.state == "interrupted"
            assert "PostgreSQL" in (left.error or "")
            jobs.resume(run.id)
            wait_until(lambda: store.get(run.id).state == "running")
            jobs.change(run.id, {"pace": "max"})
            assert wait_until_ended(store, run).state == "finished"
        finally:
            jobs.close()


def ready_store(store: RunStore) -> bool:
    try:
        store.list(limit=1)
    except Exception:
        return False
    return True


def until_ended(server: Served, run: dict[str, object]) -> dict[str, object]:
    """Wait for a run's end; the server may report it only after the database is back."""
    deadline = time.monotonic() + LONG_S
    while True:
        answer = server.client.get(f"/api/v1/trainings/{run['id']}")
        if answer.status_code == 200 and answer.json()["ended_at"] is not None:
            shown: dict[str, object] = answer.json()
            return shown
        assert time.monotonic() < deadline, answer.text
        time.sleep(0.2)


def curve_of(server: Served, run: dict[str, object]) -> object:
    return server.client.get(f"/api/v1/trainings/{run['id']}/curve").json()


def ready(server: Served) -> bool:
    deadline = time.monotonic() + LONG_S
    while server.client.get("/readyz").status_code != 200:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.1)
    return True
