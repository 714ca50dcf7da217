"""Events of a running job: their order, and what the database is asked for them."""

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.jobs import Jobs
from app.jobs.messages import Batch, Message, TrainingTask
from app.jobs.submissions import TrainingStart
from app.settings import Settings
from app.storage.database import progress
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import QUEUED, AnyRun
from hexapods.runs.config import TrainingConfig
from tests.jobs.played import played_job
from tests.jobs.waiting import wait_for_progress
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


class StatesBus(EventBus):
    """Keeps the state in which a run was each time it was published: subscribers get the newest."""

    def __init__(self) -> None:
        super().__init__()
        self.states: list[str | None] = []

    def publish_run(self, run: AnyRun, queue_position: int | None = None) -> None:
        self.states.append(run.state)
        super().publish_run(run, queue_position)


def running_job(store: RunStore, bus: EventBus) -> tuple[Job, Callable[[Message], None]]:
    """Return a job, and what gives it the messages of its process, which the test plays."""
    store.create(training("a"))
    return played_job(store.change("a", QUEUED, "running"), TrainingTask(PLAIN), store, bus)


def test_progress_is_written_once_in_an_interval_and_read_never(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "WRITE_EVERY_S", 60.0)
    bus = EventBus()
    (job, send), events = running_job(store, bus), bus.subscribe()
    send(Batch((), 1))
    with recorded_queries() as queries:
        for done in range(2, 32):
            send(Batch((), done))
    assert queries == []
    assert store.get("a").done == 31
    assert job.last.done == 31
    assert json.loads(events.drain()[-1].data)["progress"]["done"] >= 1


def test_late_progress_of_a_paused_run_has_no_estimate(store: RunStore) -> None:
    bus = EventBus()
    (job, send), events = running_job(store, bus), bus.subscribe()
    send(Batch((), 1))
    job.change_state({"running"}, "paused")
    send(Batch((), 2))
    job.publish()
    shown = json.loads(events.drain()[-1].data)
    assert (shown["state"], shown["progress"]["done"], shown["eta_s"]) == ("paused", 2, None)


def test_progress_reported_while_a_run_is_paused_does_not_undo_the_pause(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The job's thread is held between the write of progress and its event."""
    monkeypatch.setattr(Job, "events_per_s", 1_000_000)
    bus, write = StatesBus(), store.update_progress
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
        run = jobs.start(TrainingStart(ENDLESS))
        wait_for_progress(store, run)
        hold.set()
        assert arrived.wait(LONG_S)
        assert jobs.pause(run.id).state == "paused"
        hold.clear()
        go_on.set()
        # It has ended once all that its process has reported was published.
        assert jobs.stop(run.id).state == "stopped"
        since = bus.states[bus.states.index("paused") :]
        assert since == ["paused"] * (len(since) - 1) + ["stopped"]
        assert len(since) > 2, "progress was published after the pause"
    finally:
        jobs.close()
