"""Jobs in real processes: their order, their end, and what becomes of one that dies."""

import os
import signal
import threading
import time
from typing import Any

import psutil
import pytest

from app.domain.errors import InvalidInput
from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.jobs.queue import MAX_QUEUED, RunQueue
from app.jobs.resume import resumed_runs
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.runs.config import TrainingConfig, WalkingProblem
from app.storage.errors import Busy, Conflict, StorageFailed
from app.storage.memory_store import MemoryStore
from app.storage.recordings import Recordings
from app.storage.store import QUEUED, Run
from tests.jobs.waiting import ended, moving, until

WALK = WalkingProblem(gait="left-right-origin", simulator="kinematic")


def training(**fields: Any) -> TrainingStart:
    return TrainingStart(TrainingConfig(**vars(WALK), **{"steps": 10, **fields}))


def endless() -> TrainingStart:
    return training(steps=10_000_000, pace=20, evaluate_every=0)


def pid_of(jobs: Jobs, run: Run) -> int:
    job = jobs._supervisor.find(run.id)
    assert job is not None
    assert job.process.pid is not None
    return job.process.pid


def test_they_start_in_the_order_in_which_they_were_asked_for(
    jobs: Jobs, store: MemoryStore
) -> None:
    runs = [jobs.train(training()) for _ in range(3)]
    last = ended(store, runs[-1])
    starts = [store.get(run.id).started_at for run in runs]
    assert starts == sorted(starts, key=str)
    ends = [store.get(run.id).ended_at for run in runs]
    assert all(a <= b for a, b in zip(ends, starts[1:], strict=False) if a and b)
    assert last.state == "finished"


def test_the_queue_is_bounded(jobs: Jobs, store: MemoryStore) -> None:
    first = jobs.train(endless())
    moving(store, first)
    for _ in range(MAX_QUEUED):
        jobs.train(endless())
    with pytest.raises(Busy, match="32") as error:
        jobs.train(endless())
    assert error.value.retry_after_s > 0
    lanes = [LaneStart("greedy")]
    with pytest.raises(Busy):
        jobs.race(RaceStart(WALK, lanes, 50, 0))
    queued = store.list(state="queued").items
    assert len(queued) == MAX_QUEUED
    places = [jobs.view(run)["queue_position"] for run in reversed(queued)]
    assert places == list(range(1, MAX_QUEUED + 1))
    assert jobs.view(store.get(first.id))["queue_position"] is None
    for run in queued:
        assert jobs.stop(run.id).state == "stopped"
    jobs.stop(first.id)


def test_a_paused_job_gives_its_place_away(jobs: Jobs, store: MemoryStore) -> None:
    first = jobs.train(endless())
    moving(store, first)
    second = jobs.train(training())
    assert store.get(second.id).state == "queued"
    jobs.pause(first.id)
    assert ended(store, second).state == "finished"
    done = store.get(first.id).done
    time.sleep(0.3)
    assert store.get(first.id).done - done <= 1, "it was paused"
    jobs.resume(first.id)
    until(lambda: store.get(first.id).done > done + 1)
    assert jobs.stop(first.id).state == "stopped"


def test_words_are_obeyed_between_two_steps(jobs: Jobs, store: MemoryStore) -> None:
    mujoco = WalkingProblem(gait="left-right-origin")
    start = TrainingStart(TrainingConfig(**vars(mujoco), steps=1_000_000, evaluate_every=0))
    run = jobs.train(start)
    moving(store, run)
    began = time.monotonic()
    changed = jobs.change(run.id, {"alpha": 0.2})
    assert changed.changes[0]["alpha"] == 0.2
    stopped = jobs.stop(run.id)
    assert stopped.state == "stopped"
    assert stopped.result is not None
    # The promise is one second; a step takes 2 ms, so whatever is over this is no busy machine.
    assert time.monotonic() - began < 10


def test_an_evaluation_is_no_excuse(jobs: Jobs, store: MemoryStore) -> None:
    """Its look-ahead rival would take half a minute at eight divisions."""
    slow = WalkingProblem(gait="left-right-origin", divisions=8, grid_side_m=0.03)
    config = TrainingConfig(**vars(slow), steps=100, evaluate_every=1, steps_per_episode=1)
    run = jobs.train(TrainingStart(config))
    moving(store, run)
    time.sleep(0.5)
    assert jobs.pause(run.id).state == "paused"
    changed = jobs.change(run.id, {"gamma": 0.5})
    assert changed.changes == ({"step": 1, "gamma": 0.5},)
    stopped = jobs.stop(run.id)
    assert (stopped.state, stopped.done, stopped.error) == ("stopped", 1, None)
    assert stopped.result is not None
    assert stopped.result["greedy_distance_m"] is None


def test_one_that_has_not_begun_stops_at_once(jobs: Jobs, store: MemoryStore) -> None:
    run = jobs.train(endless())
    until(lambda: store.get(run.id).state == "running")
    stopped = jobs.stop(run.id)
    assert stopped.state == "stopped"
    assert stopped.done <= 1


def test_a_killed_process_is_a_failed_run_that_names_the_signal(
    jobs: Jobs, store: MemoryStore
) -> None:
    run = jobs.train(endless())
    moving(store, run)
    began = time.monotonic()
    os.kill(pid_of(jobs, run), signal.SIGKILL)
    now = ended(store, run)
    assert time.monotonic() - began < 5
    assert now.state == "failed"
    assert "SIGKILL" in (now.error or "")
    assert ended(store, jobs.train(training())).state == "finished", "others go on"


def test_a_race_fails_with_its_practice(jobs: Jobs, store: MemoryStore) -> None:
    race = jobs.race(RaceStart(WALK, [LaneStart("q-learning", training=endless())], 50, 0))
    practice = store.get(race.waiting_for[0])
    moving(store, practice)
    os.kill(pid_of(jobs, practice), signal.SIGSEGV)
    now = ended(store, race)
    assert now.state == "failed"
    assert practice.id in (now.error or "")
    assert "SIGSEGV" in (now.error or "")


def test_one_of_many_that_stop_it_wins(jobs: Jobs, store: MemoryStore) -> None:
    run = jobs.train(endless())
    moving(store, run)
    won, lost = [], []

    def stop() -> None:
        try:
            won.append(jobs.stop(run.id))
        except Conflict as conflict:
            lost.append(conflict)

    threads = [threading.Thread(target=stop) for _ in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(won), len(lost)) == (1, 15)


def test_a_race_says_if_it_shared_the_machine(store: MemoryStore) -> None:
    jobs = Jobs(store, Recordings(), EventBus(), cores=2)
    jobs.open()
    try:
        alone = ended(store, jobs.race(RaceStart(WALK, [LaneStart("greedy")], 5, 0)))
        other = jobs.train(endless())
        moving(store, other)
        shared = ended(store, jobs.race(RaceStart(WALK, [LaneStart("greedy")], 5, 0)))
        assert alone.result is not None
        assert shared.result is not None
        assert (alone.result["shared_machine"], shared.result["shared_machine"]) == (False, True)
    finally:
        jobs.close()


def test_closing_leaves_no_process(store: MemoryStore) -> None:
    jobs = Jobs(store, Recordings(), EventBus(), cores=2)
    jobs.open()
    runs = [jobs.train(endless()) for _ in range(3)]
    for run in runs[:2]:
        moving(store, run)
    children = [psutil.Process(pid_of(jobs, run)) for run in runs[:2]]
    jobs.close()
    assert not any(child.is_running() for child in children)
    assert [store.get(run.id).state for run in runs] == ["interrupted"] * 3


def test_the_server_goes_before_its_jobs(store: MemoryStore) -> None:
    jobs = Jobs(store, Recordings(), EventBus(), niceness=15)
    jobs.open()
    try:
        run = jobs.train(endless())
        moving(store, run)
        assert psutil.Process(pid_of(jobs, run)).nice() == psutil.Process().nice() + 15
    finally:
        jobs.close()


def test_an_agent_without_rates_has_none_to_change(jobs: Jobs) -> None:
    with pytest.raises(InvalidInput, match="does not learn"):
        jobs.train(training(agent="greedy"))


class ShakyStore(MemoryStore):
    """A store that cannot be used for a while."""

    failures = 0
    fail_after: int | None = None
    """So many changes are made before one fails."""

    def change(self, *args: Any, **fields: Any) -> Run:
        if self.fail_after == 0:
            self.fail_after = None
            raise StorageFailed("another program holds the database")
        if self.fail_after is not None:
            self.fail_after -= 1
        if self.failures:
            self.failures -= 1
            raise StorageFailed("another program holds the database")
        return super().change(*args, **fields)


def test_a_start_that_fails_halfway_leaves_no_run_in_the_queue() -> None:
    """A race that goes on after its practice: the practice is queued, then the store fails."""
    store = ShakyStore()
    ids = ["a", "b"]
    config = TrainingConfig(**vars(WALK), steps=10)
    for run_id in ids:
        store.create(Run(id=run_id, kind="training", name=run_id, config=config, total=10))
        store.change(run_id, QUEUED, "interrupted")
    queue = RunQueue(store, lambda run: None)
    entries = [entry for run_id in ids for entry in resumed_runs(store.get(run_id), store)]
    store.fail_after = 1
    with pytest.raises(StorageFailed):
        queue.add(entries, 1)
    assert [store.get(run_id).state for run_id in ids] == ["queued", "interrupted"]
    queue.reconcile()
    assert [store.get(run_id).state for run_id in ids] == ["interrupted", "interrupted"]


def test_a_store_that_cannot_be_used_for_a_while_costs_no_run() -> None:
    store = ShakyStore()
    jobs = Jobs(store, Recordings(), EventBus(), cores=1)
    jobs.open()
    try:
        store.failures = 1
        late = jobs.train(training())
        assert ended(store, late).state == "finished"
        run = jobs.train(endless())
        moving(store, run)
        store.failures = 2
        os.kill(pid_of(jobs, run), signal.SIGKILL)
        assert "SIGKILL" in (ended(store, run).error or "")
        assert ended(store, jobs.train(training())).state == "finished"
    finally:
        jobs.close()


class DyingStore(MemoryStore):
    """Kills a run's process, and sees it fail, just before the run is marked as running."""

    pid: int | None = None

    def change(self, run_id: str, *args: Any, **fields: Any) -> Run:
        if self.pid is not None and args[1] == "running":
            pid, self.pid = self.pid, None
            os.kill(pid, signal.SIGKILL)
            until(lambda: self.get(run_id).state == "failed")
        return super().change(run_id, *args, **fields)


def test_one_that_dies_as_it_is_resumed_is_queued_again() -> None:
    store = DyingStore()
    jobs = Jobs(store, Recordings(), EventBus(), cores=1)
    jobs.open()
    try:
        run = jobs.train(endless())
        moving(store, run)
        jobs.pause(run.id)
        store.pid = pid_of(jobs, run)
        assert jobs.resume(run.id).state == "queued"
        until(lambda: store.get(run.id).state == "running")
    finally:
        jobs.close()
