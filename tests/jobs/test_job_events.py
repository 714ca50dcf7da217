"""Events of a running job: their order, and what the database is asked for them."""

import json
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.jobs import Jobs
from app.jobs.messages import Batch, TrainingTask
from app.jobs.submissions import TrainingStart
from app.settings import Settings
from app.storage.database import progress
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import QUEUED
from hexapods.runs.config import TrainingConfig
from tests.jobs.waiting import wait_for_progress, wait_until
from tests.storage.queries import recorded_queries
from tests.storage.stores import PLAIN, training
from tests.timeouts import LONG_S

ENDLESS = TrainingConfig(
    gait="left-right-origin", simulator="kinematic", steps=10_000_000, pace=20, evaluate_every=0
)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    with open_store(Settings(data=tmp_path)) as store:
        yield store


def running_job(store: RunStore, bus: EventBus) -> Job:
    """Return a job whose process was never started; the test plays the process."""
    store.create(training("a"))
    run = store.change("a", QUEUED, "running")
    parts = store, Recordings(store), bus
    return Job(run, TrainingTask(PLAIN), *parts, shutdown=threading.Event(), niceness=0)


def test_progress_is_written_once_in_an_interval_and_read_never(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "WRITE_EVERY_S", 60.0)
    bus = EventBus()
    job, events = running_job(store, bus), bus.subscribe()
    job._handle_with_retry(Batch((), 1))
    with recorded_queries() as queries:
        for done in range(2, 32):
            job._handle_with_retry(Batch((), done))
    assert queries == []
    assert store.get("a").done == 31
    assert job.last.done == 31
    assert json.loads(events.drain()[-1].data)["progress"]["done"] >= 1


def test_late_progress_of_a_paused_run_has_no_estimate(store: RunStore) -> None:
    bus = EventBus()
    job, events = running_job(store, bus), bus.subscribe()
    job._handle_with_retry(Batch((), 1))
    job.change_state({"running"}, "paused")
    job._handle_with_retry(Batch((), 2))
    job.publish()
    shown = json.loads(events.drain()[-1].data)
    assert (shown["state"], shown["progress"]["done"], shown["eta_s"]) == ("paused", 2, None)


def test_progress_reported_while_a_run_is_paused_does_not_undo_the_pause(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The job's thread is held between the write of progress and its event."""
    bus, write = EventBus(), store.update_progress
    arrived, go_on, hold = threading.Event(), threading.Event(), threading.Event()

    def slow_write(run_id: str, done: int, eta_s: float | None = None) -> None:
        write(run_id, done, eta_s)
        if hold.is_set():
            arrived.set()
            assert go_on.wait(LONG_S)

    monkeypatch.setattr(store, "update_progress", slow_write)
    jobs = Jobs(store, Recordings(store), bus, cores=1)
    jobs.open()
    try:
        run = jobs.train(TrainingStart(ENDLESS))
        wait_for_progress(store, run)
        hold.set()
        assert arrived.wait(LONG_S)
        events = bus.subscribe(names={"run"})
        assert jobs.pause(run.id).state == "paused"
        hold.clear()
        go_on.set()
        job = jobs._supervisor.find(run.id)
        assert job is not None
        done = store.get(run.id).done
        wait_until(lambda: job.process.silent_s() > 0.2 or store.get(run.id).done > done + 1)
        assert json.loads(events.drain()[-1].data)["state"] == "paused"
    finally:
        jobs.close()
