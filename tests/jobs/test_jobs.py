"""Jobs in real processes: queue order, commands, crashes, store failures and shutdown."""

import json
import multiprocessing
import os
import signal
import threading
import time
from typing import Any

import psutil
import pytest
from sqlalchemy import text

from app.events.bus import EventBus
from app.jobs.job import SILENT_S, Job
from app.jobs.jobs import Jobs
from app.jobs.queue import MAX_QUEUED, RunQueue
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.jobs.tasks import resumed_runs
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, StorageFailed, StorageFull
from app.storage.recordings import Recordings
from app.storage.run import QUEUED, TABLE, Run
from app.storage.stored_tables import load_table
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import to_json
from hexapods.runs.baseline import baseline_id
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.training import walk
from tests.jobs.waiting import wait_for_progress, wait_until, wait_until_ended
from tests.storage.ended_runs import result_of_race, result_of_training
from tests.storage.stores import of_type
from tests.timeouts import LONG_S

WALK = WalkingProblem(gait="left-right-origin", simulator="kinematic")


def training(**fields: Any) -> TrainingStart:
    return TrainingStart(training_config(**vars(WALK), **{"steps": 10, **fields}))


def endless() -> TrainingStart:
    return training(steps=10_000_000, pace=20, evaluate_every=0)


def pid_of(run: Run) -> int:
    """Return the id of the process that computes a run."""
    name = f"{run.kind} {run.id}"
    (pid,) = (process.pid for process in multiprocessing.active_children() if process.name == name)
    assert pid is not None
    return pid


def test_runs_start_in_order_of_submission(jobs: Jobs, store: RunStore) -> None:
    runs = [jobs.start(training()) for _ in range(3)]
    last = wait_until_ended(store, runs[-1])
    starts = [store.get(run.id).started_at for run in runs]
    assert starts == sorted(starts, key=str)
    ends = [store.get(run.id).ended_at for run in runs]
    assert all(a <= b for a, b in zip(ends, starts[1:], strict=False) if a and b)
    assert last.state == "finished"


def test_queue_is_bounded(jobs: Jobs, store: RunStore) -> None:
    first = jobs.start(endless())
    wait_for_progress(store, first)
    for _ in range(MAX_QUEUED):
        jobs.start(endless())
    with pytest.raises(Busy, match="32") as error:
        jobs.start(endless())
    assert error.value.retry_after_s > 0
    lanes = [LaneStart("greedy")]
    with pytest.raises(Busy):
        jobs.start(RaceStart(WALK, lanes, 50, 0))
    queued = store.list(state="queued").items
    assert len(queued) == MAX_QUEUED
    places = [to_json(jobs.view(run))["queue_position"] for run in reversed(queued)]
    assert places == list(range(1, MAX_QUEUED + 1))
    assert to_json(jobs.view(store.get(first.id)))["queue_position"] is None
    for run in queued:
        assert jobs.stop(run.id).state == "stopped"
    jobs.stop(first.id)


def test_paused_job_frees_its_core(jobs: Jobs, store: RunStore) -> None:
    first = jobs.start(endless())
    wait_for_progress(store, first)
    second = jobs.start(training())
    assert store.get(second.id).state == "queued"
    jobs.pause(first.id)
    assert wait_until_ended(store, second).state == "finished"
    done = store.get(first.id).done
    time.sleep(0.3)
    assert store.get(first.id).done - done <= 1, "it was paused"
    jobs.resume(first.id)
    wait_until(lambda: store.get(first.id).done > done + 1)
    assert jobs.stop(first.id).state == "stopped"


def test_runs_that_live_and_wait_are_renamed_for_good(store: RunStore) -> None:
    bus = EventBus()
    jobs = Jobs(store, Recordings(store), bus, cores=1)
    jobs.open()
    try:
        live, waiting = jobs.start(endless()), jobs.start(training())
        wait_for_progress(store, live)
        for run in (live, waiting):
            assert jobs.annotate(run.id, {"name": "after", "tags": ("ice",)}).name == "after"
        events = bus.subscribe()
        done = store.get(live.id).done
        wait_until(lambda: store.get(live.id).done > done + 3)
        jobs.stop(live.id)
        wait_until_ended(store, waiting)
        run_events = [json.loads(event.data) for event in events.drain() if event.event == "run"]
        assert {run["id"] for run in run_events} == {live.id, waiting.id}
        assert all((run["name"], run["tags"]) == ("after", ["ice"]) for run in run_events)
        assert [run.name for run in store.list().runs] == ["after", "after"]
    finally:
        jobs.close()


def test_change_and_stop_take_effect_between_two_steps(jobs: Jobs, store: RunStore) -> None:
    mujoco = WalkingProblem(gait="left-right-origin")
    start = TrainingStart(training_config(**vars(mujoco), steps=1_000_000, evaluate_every=0))
    run = jobs.start(start)
    wait_for_progress(store, run)
    changed = jobs.change(run.id, {"settings": {"alpha": 0.2}})
    assert changed.changes[0]["settings"]["alpha"] == 0.2
    stopped = jobs.stop(run.id)
    assert (stopped.state, stopped.error) == ("stopped", None)
    assert stopped.result is not None
    assert changed.changes[0]["step"] <= stopped.done < 1_000_000


def test_commands_take_effect_during_a_long_evaluation(jobs: Jobs, store: RunStore) -> None:
    """Its look-ahead baseline would take half a minute at eight divisions."""
    slow = WalkingProblem(gait="left-right-origin", divisions=8, grid_side_m=0.03)
    config = training_config(**vars(slow), steps=100, evaluate_every=1, steps_per_episode=1)
    run = jobs.start(TrainingStart(config))
    wait_for_progress(store, run)
    time.sleep(0.5)
    assert jobs.pause(run.id).state == "paused"
    changed = jobs.change(run.id, {"settings": {"gamma": 0.5}})
    assert changed.changes == ({"step": 1, "settings": {"gamma": 0.5}},)
    stopped = jobs.stop(run.id)
    assert (stopped.state, stopped.done, stopped.error) == ("stopped", 1, None)
    assert result_of_training(stopped).greedy_distance_m is None


def test_stop_interrupts_a_long_decision(jobs: Jobs, store: RunStore) -> None:
    """The second lane would search for ever; greedy's step is kept."""
    lanes = [LaneStart("greedy"), LaneStart("tests.own_agents:Undecided")]
    race = jobs.start(RaceStart(WALK, lanes, 50, 0))
    wait_for_progress(store, race)
    stopped = jobs.stop(race.id)

    assert (stopped.state, stopped.error) == ("stopped", None)
    assert [lane.steps for lane in result_of_race(stopped).lanes] == [1, 0]


def test_race_whose_agent_does_not_let_itself_be_stopped_is_ended(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Job, "stop_grace_s", 0.5)
    lanes = [LaneStart("greedy"), LaneStart("tests.own_agents:Ponderous")]
    race = jobs.start(RaceStart(WALK, lanes, 50, 0))
    wait_for_progress(store, race)
    stopped = jobs.stop(race.id)

    assert stopped.state == "stopped"
    assert stopped.error == (
        "It did not answer when it was to stop, so it was ended after 0 s; what was done is kept."
    )
    assert [lane.steps for lane in result_of_race(stopped).lanes] == [1, 0]


def test_stop_keeps_what_was_learned_although_the_last_evaluation_takes_too_long(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Job, "stop_grace_s", 3.0)
    run = jobs.start(training(steps=1000, agent="tests.own_agents:Slow"))
    wait_for_progress(store, run)
    stopped = jobs.stop(run.id)
    assert (stopped.state, stopped.error) == (
        "stopped",
        "It did not answer when it was to stop, so it was ended after 3 s; what was done is kept.",
    )
    assert load_table(store, run.id).meta["step"] == stopped.done > 0


def test_run_is_stopped_although_the_disk_has_no_room_for_its_table(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    put = store.put_artifact

    def put_all_but_tables(run_id: str, name: str, data: bytes, **fields: Any) -> None:
        if name == TABLE:
            raise StorageFull("the disk is full")
        put(run_id, name, data, **fields)

    monkeypatch.setattr(store, "put_artifact", put_all_but_tables)
    monkeypatch.setattr(Job, "stop_grace_s", 1.0)
    run = jobs.start(training(steps=1000, agent="tests.own_agents:Slow"))
    wait_for_progress(store, run)
    assert jobs.stop(run.id).state == "stopped"
    with pytest.raises(Conflict, match="before it kept a table"):
        load_table(store, run.id)


def test_number_of_live_changes_is_limited(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.jobs.jobs.MAX_CHANGES", 2)
    run = jobs.start(endless())
    wait_for_progress(store, run)
    jobs.change(run.id, {"settings": {"alpha": 0.5}})
    jobs.change(run.id, {"pace": 10})
    with pytest.raises(Conflict, match="was changed 2 times, which is the most"):
        jobs.change(run.id, {"settings": {"alpha": 0.6}})
    assert len(store.get(run.id).changes) == 2
    jobs.stop(run.id)


def test_starting_run_stops_at_once(jobs: Jobs, store: RunStore) -> None:
    # It takes a step in 3 s: the second one would come long after it is seen to run.
    run = jobs.start(training(steps=100, pace=0.1, evaluate_every=0))
    wait_until(lambda: store.get(run.id).state == "running")
    stopped = jobs.stop(run.id)
    assert stopped.state == "stopped"
    assert stopped.done <= 1


def test_killed_process_fails_its_run_and_names_the_signal(jobs: Jobs, store: RunStore) -> None:
    run = jobs.start(endless())
    wait_for_progress(store, run)
    os.kill(pid_of(run), signal.SIGKILL)
    now = wait_until_ended(store, run)
    assert now.state == "failed"
    assert "SIGKILL" in (now.error or "")
    assert wait_until_ended(store, jobs.start(training())).state == "finished", "others go on"


@pytest.mark.parametrize("is_killed", [False, True])
def test_process_that_an_agent_started_ends_with_its_job(
    jobs: Jobs, store: RunStore, is_killed: bool
) -> None:
    run = jobs.start(training(steps=100, pace=20, agent="tests.own_agents:Parent"))
    wait_for_progress(store, run)
    (left,) = psutil.Process(pid_of(run)).children()
    if is_killed:
        os.kill(pid_of(run), signal.SIGKILL)
    assert wait_until_ended(store, run).state == ("failed" if is_killed else "finished")
    assert wait_until_ended(store, jobs.start(training())).state == "finished", "the core is free"
    wait_until(lambda: not left.is_running() or left.status() == psutil.STATUS_ZOMBIE)


def test_jobs_outlive_a_stop_of_the_server_that_stops_them_too(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As Ctrl-Z in a terminal, or a paused container."""
    run = jobs.start(endless())
    wait_for_progress(store, run)
    job, now_s = psutil.Process(pid_of(run)), time.monotonic
    job.suspend()
    # The server's own stop is a jump of its clock. It goes on first, and looks for its jobs.
    time.sleep(0.5)
    monkeypatch.setattr(time, "monotonic", lambda: now_s() + 2 * SILENT_S)
    time.sleep(2.0)
    job.resume()
    done = store.get(run.id).done
    wait_until(lambda: store.get(run.id).done > done + 1)


def test_race_fails_if_its_training_fails(jobs: Jobs, store: RunStore) -> None:
    race = jobs.start(RaceStart(WALK, [LaneStart("q-learning", training=endless())], 50, 0))
    race_training = store.get(race.waiting_for[0])
    wait_for_progress(store, race_training)
    os.kill(pid_of(race_training), signal.SIGSEGV)
    now = wait_until_ended(store, race)
    assert now.state == "failed"
    assert race_training.id in (now.error or "")
    assert "SIGSEGV" in (now.error or "")


def test_one_of_many_concurrent_stops_succeeds(jobs: Jobs, store: RunStore) -> None:
    run = jobs.start(endless())
    wait_for_progress(store, run)
    stopped, conflicts = [], []

    def stop() -> None:
        try:
            stopped.append(jobs.stop(run.id))
        except Conflict as conflict:
            conflicts.append(conflict)

    threads = [threading.Thread(target=stop) for _ in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(stopped), len(conflicts)) == (1, 15)


def test_race_result_reports_a_shared_machine(store: RunStore) -> None:
    jobs = Jobs(store, Recordings(store), EventBus(), cores=2)
    jobs.open()
    try:
        alone = wait_until_ended(store, jobs.start(RaceStart(WALK, [LaneStart("greedy")], 5, 0)))
        other = jobs.start(endless())
        wait_for_progress(store, other)
        shared = wait_until_ended(store, jobs.start(RaceStart(WALK, [LaneStart("greedy")], 5, 0)))
        assert [result_of_race(run).shared_machine for run in (alone, shared)] == [False, True]
    finally:
        jobs.close()


def test_close_leaves_no_process(store: RunStore) -> None:
    jobs = Jobs(store, Recordings(store), EventBus(), cores=2)
    jobs.open()
    runs = [jobs.start(endless()) for _ in range(3)]
    for run in runs[:2]:
        wait_for_progress(store, run)
    children = [psutil.Process(pid_of(run)) for run in runs[:2]]
    jobs.close()
    assert not any(child.is_running() for child in children)
    assert [store.get(run.id).state for run in runs] == ["interrupted"] * 3


def test_close_waits_for_no_decision(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """A race has no checkpoint to write, so that its process is ended at once."""
    monkeypatch.setattr("app.jobs.supervisor._CHECKPOINT_S", 10 * LONG_S)
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
    jobs.open()
    lanes = [LaneStart("greedy"), LaneStart("tests.own_agents:Undecided")]
    race = jobs.start(RaceStart(WALK, lanes, 50, 0))
    wait_for_progress(store, race)
    jobs.close()
    assert store.get(race.id).state == "interrupted"


def test_last_picture_of_a_race_outlives_the_server(
    jobs: Jobs, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a race has recorded is stored while it runs: a server that is killed stores nothing."""
    monkeypatch.setattr("app.jobs.job.CHECKPOINT_EVERY_S", 0.0)
    lanes = [LaneStart("greedy"), LaneStart("tests.own_agents:Undecided")]
    race = jobs.start(RaceStart(WALK, lanes, 50, 0))
    wait_for_progress(store, race)

    wait_until(lambda: any(lane.steps for lane in Recordings(store).race(race.id) or ()))
    jobs.stop(race.id)


def test_worker_process_has_lower_priority_than_the_server(store: RunStore) -> None:
    jobs = Jobs(store, Recordings(store), EventBus(), niceness=15)
    jobs.open()
    try:
        run = jobs.start(endless())
        wait_for_progress(store, run)
        lower = min(psutil.Process().nice() + 15, 19)
        assert psutil.Process(pid_of(run)).nice() == lower
    finally:
        jobs.close()


def test_agent_that_does_not_learn_cannot_be_trained(jobs: Jobs) -> None:
    with pytest.raises(InvalidInput, match="does not learn"):
        jobs.start(training(agent="greedy"))


class FailingStore(RunStore):
    """Fake store that raises `StorageFailed` on some writes."""

    failures = 0
    fail_after: int | None = None
    """Number of writes that succeed before one fails; None for none."""

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


def test_submission_that_fails_halfway_leaves_no_run_queued(store: RunStore) -> None:
    """Two runs are resumed together; the store fails after the first was written."""
    store = of_type(FailingStore, store)
    ids = ["a", "b"]
    config = training_config(**vars(WALK), steps=10)
    for run_id in ids:
        store.create(Run(id=run_id, kind="training", name=run_id, config=config, total=10))
        store.change(run_id, QUEUED, "interrupted")
    queue = RunQueue(store, lambda run, position: None)
    runs = [run for run_id in ids for run in resumed_runs(store.get(run_id), store)]
    store.fail_after = 1
    with pytest.raises(StorageFailed):
        queue.add(runs, 1, resumed=True)
    assert [store.get(run_id).state for run_id in ids] == ["queued", "interrupted"]
    queue.reconcile()
    assert [store.get(run_id).state for run_id in ids] == ["interrupted", "interrupted"]


def test_runs_survive_temporary_store_failures(store: RunStore) -> None:
    store = of_type(FailingStore, store)
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
    jobs.open()
    try:
        store.failures = 1
        late = jobs.start(training())
        assert wait_until_ended(store, late).state == "finished"
        run = jobs.start(endless())
        wait_for_progress(store, run)
        store.failures = 2
        os.kill(pid_of(run), signal.SIGKILL)
        assert "SIGKILL" in (wait_until_ended(store, run).error or "")
        assert wait_until_ended(store, jobs.start(training())).state == "finished"
    finally:
        jobs.close()


class WorkerKillingStore(RunStore):
    """Fake store that kills a run's process just before the run is written as `running`."""

    pid: int | None = None

    def change(self, run_id: str, *args: Any, **fields: Any) -> Run:
        if self.pid is not None and args[1] == "running":
            pid, self.pid = self.pid, None
            os.kill(pid, signal.SIGKILL)
            wait_until(lambda: self.get(run_id).state == "failed")
        return super().change(run_id, *args, **fields)


def test_run_whose_process_dies_during_resume_is_queued_again(store: RunStore) -> None:
    store = of_type(WorkerKillingStore, store)
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
    jobs.open()
    try:
        run = jobs.start(endless())
        wait_for_progress(store, run)
        jobs.pause(run.id)
        store.pid = pid_of(run)
        assert jobs.resume(run.id).state == "queued"
        wait_until(lambda: store.get(run.id).state == "running")
    finally:
        jobs.close()


def test_jobs_share_the_baseline_of_a_problem(jobs: Jobs, store: RunStore) -> None:
    """The first measures it; a stored one is used by the others, whatever they practise."""
    config = training_config(**vars(WALK), steps=20)
    first = wait_until_ended(store, jobs.start(TrainingStart(config)))
    greedy_m = result_of_training(first).greedy_distance_m
    assert greedy_m is not None
    baseline = baseline_id(config, config.world.as_of(0))
    assert store.baselines.get([baseline]) == {baseline: greedy_m}

    measured = build_learner(config)
    assert walk(measured.baseline(config.world.as_of(0)), record=False)[0] == greedy_m
    # That the stored one is used shows by another value of it.
    change = text("UPDATE baselines SET distance_m = 9.5")
    store.database.write(lambda connection: connection.execute(change))
    other = training_config("sarsa", **vars(WALK), steps=30, seed=5)
    run = wait_until_ended(store, jobs.start(TrainingStart(other)))
    assert result_of_training(run).greedy_distance_m == 9.5
