"""The stage follows its runs by the events of the bus, not by reading the store."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.events.bus import MAX_PENDING, Channel, EventBus
from app.events.event_records import DeletedRun, EvaluationEvent
from app.settings import Settings
from app.stage.stage import Stage
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import LIVE, NOT_ENDED, QUEUED, DamagedRun, Run
from hexapods.domain.errors import HexapodError
from tests.storage.queries import recorded_queries
from tests.storage.stores import experiment, race, training

REST_QPOS = np.zeros(25, np.float32)


class Follower:
    """A stage on a database of its own, whose clock advances with each frame."""

    def __init__(self, store: RunStore) -> None:
        self.store, self.bus, self.now = store, EventBus(), 0.0
        self.recordings = Recordings(store)
        self.stage = Stage(store, self.recordings, Channel(self.bus), now=lambda: self.now)

    def watch(self, frames: int = 60) -> str | None:
        """Draw frames, and return the run that is on stage then."""
        for _ in range(frames):
            self.now += 1 / 30
            self.stage.frame()
        return self.stage.frame().run_id

    def running(self, run_id: str) -> Run:
        """Store a running training whose recording has begun."""
        self.store.create(training(run_id))
        self.recordings.begin_training(run_id, REST_QPOS)
        return self.store.change(run_id, QUEUED, "running")

    def end(self, run: Run) -> None:
        self.publish(self.store.change(run.id, LIVE, "finished"))

    def publish(self, run: Run) -> None:
        self.bus.publish_run(run)


@pytest.fixture
def follower(tmp_path: Path) -> Iterator[Follower]:
    with open_store(Settings(data=tmp_path)) as store:
        yield Follower(store)


def test_stage_reads_no_run_while_one_is_shown(follower: Follower) -> None:
    run = follower.running("a")
    follower.stage.set(run_id=run.id)
    with recorded_queries() as queries:
        for done in range(20):
            follower.publish(replace(run, done=done))
            assert follower.watch() == "a"
            assert follower.stage.state().live
    assert queries == []

    follower.end(run)
    with recorded_queries() as queries:
        assert follower.watch() == "a"
        assert not follower.stage.state().live
    assert queries == []


def test_state_of_the_stage_follows_an_event_without_a_frame(follower: Follower) -> None:
    run = follower.running("a")
    follower.stage.set(run_id=run.id)
    assert follower.stage.state().holder == "a"
    follower.end(run)
    assert follower.stage.state().holder is None
    assert follower.stage.offer(follower.running("b").id)


def test_event_from_before_a_run_was_shown_does_not_undo_what_was_read(follower: Follower) -> None:
    run = follower.running("a")
    follower.publish(run)
    follower.store.change(run.id, NOT_ENDED, "finished")
    follower.stage.set(run_id=run.id)
    assert not follower.stage.state().live


def test_run_that_became_unreadable_leaves_the_stage(follower: Follower) -> None:
    run = follower.running("a")
    follower.stage.set(run_id=run.id)
    damaged = DamagedRun(id=run.id, kind=run.kind, damaged="its result cannot be read")
    follower.bus.publish_run(damaged)
    assert follower.watch(1) is None


def test_stage_that_is_not_drawn_for_long_misses_no_change(follower: Follower) -> None:
    run = follower.running("a")
    follower.stage.set(run_id=run.id)
    evaluated = EvaluationEvent(run_id=run.id, step=1, distance_m=0.1, epsilon=0.5)
    for number in range(MAX_PENDING + 1):
        follower.bus.publish("run-deleted", DeletedRun(id=f"other {number}"), f"other {number}")
        follower.bus.publish("evaluation", evaluated, run.id)
        follower.bus.publish("run-deleted", DeletedRun(id=run.id), run.id)
        follower.publish(run)
    assert follower.stage.state().live
    follower.end(run)
    assert follower.watch(1) == "a"
    assert not follower.stage.state().live
    follower.bus.publish("run-deleted", DeletedRun(id=run.id), run.id)
    assert follower.watch(1) is None


def test_next_run_of_the_playlist_is_shown_without_a_read(follower: Follower) -> None:
    first = follower.running("a")
    follower.store.create(race("b", waiting_for=("a",)))
    assert follower.stage.offer("b")
    assert follower.stage.state().next_run_id == "b"
    follower.end(first)
    with recorded_queries() as queries:
        follower.bus.publish("run-deleted", DeletedRun(id="a"), "a")
        assert follower.stage.state().run_id == "b"
    assert queries == []
    follower.bus.publish("run-deleted", DeletedRun(id="b"), "b")
    assert follower.stage.state().run_id is None


def test_refused_run_leaves_the_stage_to_follow_the_one_before(follower: Follower) -> None:
    run = follower.running("a")
    follower.stage.set(run_id=run.id)
    follower.store.create(experiment("b"))
    for run_id in ("b", "none"):
        with pytest.raises(HexapodError):
            follower.stage.set(run_id=run_id)
    follower.end(run)
    assert follower.watch(1) == "a"
    assert not follower.stage.state().live


def test_stage_of_a_closed_bus_reads_no_store(follower: Follower) -> None:
    follower.stage.set(run_id=follower.running("a").id)
    follower.bus.close()
    with recorded_queries() as queries:
        follower.watch()
    assert queries == []
