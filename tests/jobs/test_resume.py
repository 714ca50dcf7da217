"""Resuming unfinished runs: trainings from their checkpoint, races from their start."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace

import pytest

from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.jobs import Jobs
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.jobs.worker_process import Exit
from app.storage.database.store import RunStore
from app.storage.errors import Conflict
from app.storage.recordings import Recordings
from app.storage.run import CHECKPOINT, TABLE, Run
from hexapods.agents.protocol import Tabular
from hexapods.assembly import build_learner, rebuild_learner
from hexapods.domain.disturbance_documents import disturbance_from
from hexapods.domain.disturbances import Limp, SensorNoise
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.runs.config import TrainingConfig, WalkingProblem, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.results import RaceResult, training_result
from hexapods.runs.tables import snapshot, to_bytes
from hexapods.runs.training import train
from tests.jobs.test_jobs import WALK, pid_of
from tests.jobs.waiting import wait_for_progress, wait_until, wait_until_ended
from tests.storage.ended_runs import ended_training, result_of_training
from tests.storage.stores import training

SLOW = training_config(**vars(WALK), steps=100_000, pace=30, evaluate_every=20)
SHORT = training_config(**vars(WALK), steps=60, evaluate_every=20)


@pytest.fixture
def open_jobs(store: RunStore) -> Iterator[Callable[[], Jobs]]:
    """Return a function that opens the jobs of another server on the same store."""
    with ExitStack() as stack:

        def make() -> Jobs:
            jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
            jobs.open()
            stack.callback(jobs.close)
            return jobs

        yield make


def start_race_and_practise(jobs: Jobs, store: RunStore) -> tuple[Run, str]:
    """Start a race that waits for a long training; return both once the training gets on."""
    lanes = [LaneStart("q-learning", training=TrainingStart(SLOW)), LaneStart("greedy")]
    race = jobs.start(RaceStart(WALK, lanes, steps=5, seed=0))
    (practice_id,) = race.waiting_for
    wait_for_progress(store, store.get(practice_id))
    return race, practice_id


def create(store: RunStore, run: Run) -> Run:
    store.create(run)
    return run


def test_training_resumes_from_its_checkpoint(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    first = open_jobs()
    run = first.start(TrainingStart(SLOW))
    wait_until(lambda: store.get(run.id).done > 45)
    first.close()
    before = store.get(run.id)
    assert (before.state, before.done > 45) == ("interrupted", True)
    assert before.ended_at is not None
    store.curves.append(run.id, [{"step": 10_000, "distance_m": 9.0, "epsilon": 0.0}])

    second = open_jobs()
    resumed = second.resume(run.id)
    assert (resumed.state, resumed.done, resumed.error, resumed.ended_at) == (
        "queued",
        before.done,
        None,
        None,
    )
    wait_until(lambda: store.get(run.id).done > before.done)
    assert [row["step"] for row in store.curves.get(run.id)][:2] == [20, 40]
    assert max(row["step"] for row in store.curves.get(run.id)) < 10_000
    assert store.get(run.id).started_at == before.started_at
    stopped = second.stop(run.id)
    assert stopped.state == "stopped"
    recording = Recordings(store).training(run.id)
    assert recording is not None
    steps = [step.step for step in recording.steps]
    assert steps == sorted(set(steps)), "no step twice"


def test_training_that_was_stopped_goes_on_to_the_last_bit(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    config = training_config(**vars(WALK), steps=400, pace=30, evaluate_every=20)
    jobs = open_jobs()
    run = jobs.start(TrainingStart(config))
    wait_until(lambda: store.get(run.id).done > 30)
    stopped = jobs.stop(run.id)
    assert stopped.state == "stopped"
    assert 30 < stopped.done < 400
    resumed = jobs.resume(run.id)
    assert (resumed.state, resumed.done, resumed.result) == ("queued", stopped.done, None)
    wait_until(lambda: store.get(run.id).state == "running")
    jobs.change(run.id, {"pace": "max"})
    ended = wait_until_ended(store, run)

    unbroken = build_learner(config)
    distances = [
        (record.step, record.distance_m)
        for record in train(unbroken, config)
        if isinstance(record, Evaluated)
    ]
    assert (ended.state, ended.done) == ("finished", 400)
    assert ended.result == training_result(unbroken, config)
    assert [(row["step"], row["distance_m"]) for row in store.curves.get(run.id)] == distances
    log = Recordings(store).transitions(run.id)
    assert log is not None
    assert len(log) == 400
    with pytest.raises(Conflict, match="it can be resumed while it is"):
        jobs.resume(run.id)


def test_race_that_was_stopped_is_repeated_to_its_end(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    jobs = open_jobs()
    lanes = [LaneStart("greedy"), LaneStart("random-walk")]
    unbroken = wait_until_ended(store, jobs.start(RaceStart(WALK, lanes, steps=400, seed=0)))
    race = jobs.start(RaceStart(WALK, lanes, steps=400, seed=0))
    wait_for_progress(store, race)
    assert jobs.stop(race.id).state in ("stopped", "finished")
    if store.get(race.id).state == "stopped":
        jobs.resume(race.id)
    ended = wait_until_ended(store, race)
    assert ended.state == "finished"
    results = [finished_run.result for finished_run in (ended, unbroken)]
    assert all(isinstance(result, RaceResult) for result in results)
    first, second = (
        result.recording_sha256 for result in results if isinstance(result, RaceResult)
    )
    assert first == second


def test_race_whose_training_was_stopped_goes_on_with_it(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    """The race was queued behind the training, and was stopped with it before it ran."""
    jobs = open_jobs()
    race, practice_id = start_race_and_practise(jobs, store)
    jobs.stop(race.id)
    assert wait_until_ended(store, store.get(practice_id)).state == "stopped"
    assert store.get(race.id).state == "stopped"
    resumed = jobs.resume(race.id)
    assert (resumed.state, resumed.waiting_for) == ("queued", (practice_id,))
    wait_until(lambda: store.get(practice_id).state == "running")
    jobs.stop(race.id)
    wait_until_ended(store, store.get(practice_id))


def test_race_is_not_queued_behind_a_training_that_is_still_ending(
    store: RunStore, open_jobs: Callable[[], Jobs], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The end of the training is settled after it is stored: it must not end the new race."""
    jobs = open_jobs()
    race, practice_id = start_race_and_practise(jobs, store)
    may_settle = threading.Event()
    process_ended = Job.process_ended

    def store_end_and_wait(job: Job, end: Exit) -> None:
        process_ended(job, end)
        may_settle.wait(30.0)

    with monkeypatch.context() as patch:
        patch.setattr(Job, "process_ended", store_end_and_wait)
        patch.setattr("app.jobs.jobs._EXIT_S", 0.1)
        jobs.stop(race.id)
        assert wait_until_ended(store, store.get(practice_id)).state == "stopped"
        with pytest.raises(Conflict, match=f"training {practice_id} is still ending"):
            jobs.resume(race.id)
    may_settle.set()
    assert jobs.resume(race.id).waiting_for == (practice_id,)
    wait_until(lambda: store.get(practice_id).state == "running")
    assert jobs.stop(race.id).state == "stopped"
    wait_until_ended(store, store.get(practice_id))


def test_race_is_not_queued_behind_a_training_that_is_being_stopped(
    store: RunStore, open_jobs: Callable[[], Jobs], monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = open_jobs()
    race, practice_id = start_race_and_practise(jobs, store)
    pid = pid_of(store.get(practice_id))
    os.kill(pid, signal.SIGSTOP)  # so that it cannot obey
    jobs.stop(race.id)
    assert store.get(practice_id).state == "running"
    with monkeypatch.context() as patch:
        patch.setattr("app.jobs.jobs._EXIT_S", 0.1)
        with pytest.raises(Conflict, match=f"training {practice_id} is still ending"):
            jobs.resume(race.id)
    assert store.get(race.id).state == "stopped"
    os.kill(pid, signal.SIGCONT)
    assert jobs.resume(race.id).waiting_for == (practice_id,)
    wait_until(lambda: store.get(practice_id).state == "running")
    assert jobs.stop(race.id).state == "stopped"
    wait_until_ended(store, store.get(practice_id))


def test_race_with_the_table_of_a_stopped_training_does_not_train_it_further(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    ended_training(store, "t")
    store.change("t", {"finished"}, "stopped")
    config = RaceConfig(**vars(WALK), lanes=(LaneConfig(agent="q-learning"),), steps=5)
    run = Run(id="r", kind="race", name="r", config=config, total=5, lane_training_ids=("t",))
    create(store, replace(run, state="interrupted"))
    assert open_jobs().resume("r").waiting_for == ()
    assert wait_until_ended(store, run).state == "finished"
    assert store.get("t").state == "stopped"


def test_stopped_training_whose_table_was_used_does_not_go_on(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    """Its table would be another one, from which what was made with it could not be repeated."""
    ended_training(store, "t")
    store.change("t", {"finished"}, "stopped")
    config = RaceConfig(**vars(WALK), lanes=(LaneConfig(agent="q-learning"),), steps=5)
    race = Run(id="r", kind="race", name="r", config=config, total=5, lane_training_ids=("t",))
    create(store, replace(race, state="finished", done=5))
    with pytest.raises(Conflict, match="table of training t is used by r; continue it"):
        open_jobs().resume("t")
    store.delete("r")
    create(store, training("u", state="finished", continued_from="t", done=1))
    with pytest.raises(Conflict, match="used by u"):
        open_jobs().resume("t")
    store.delete("u")
    assert open_jobs().resume("t").state == "queued"


@pytest.mark.promises
def test_disturbed_training_that_was_killed_equals_the_unbroken_one(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    """It is killed after a checkpoint that has the first disturbance, and before the second's."""
    walk = WalkingProblem(gait="left-right-origin")
    config = training_config(**vars(walk), steps=200, pace=10, evaluate_every=0)
    jobs = open_jobs()
    run = jobs.start(TrainingStart(config))
    wait_for_progress(store, run)
    happened = [jobs.disturb(run.id, Limp(legs=(1, 4)))]
    wait_until(lambda: store.artifact(run.id, CHECKPOINT))
    happened.append(jobs.disturb(run.id, SensorNoise(sd_m=0.004)))
    os.kill(pid_of(run), signal.SIGKILL)
    assert wait_until_ended(store, run).state == "failed"
    resumed = jobs.resume(run.id)
    wait_until(lambda: store.get(run.id).state == "running")
    jobs.change(run.id, {"pace": "max"})
    ended = wait_until_ended(store, resumed)

    unbroken = build_learner(config)
    for record in train(unbroken, config):
        if isinstance(record, StepTaken):
            for change in ended.changes:
                if change["step"] == record.step and "disturbance" in change:
                    unbroken.disturb(disturbance_from(change["disturbance"]), config)
    disturbances = [
        disturbance_from(change["disturbance"])
        for change in ended.changes
        if "disturbance" in change
    ]
    assert disturbances == happened == list(unbroken.world.disturbances)
    assert 0 < happened[0].at_step < happened[1].at_step < 200
    assert ended.result == training_result(unbroken, config)

    # Its log has each step once, so that its learner can be built again from it.
    log = Recordings(store).transitions(run.id)
    assert log is not None
    whole, rebuilt = log.part(0, 200), rebuild_learner(config)
    for number in range(200):
        rebuilt.take(whole.step(number))
    assert isinstance(rebuilt.agent, Tabular)
    assert rebuilt.agent.table.sha256() == result_of_training(ended).q_table_sha256


def test_training_without_a_checkpoint_restarts_from_its_table(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    jobs = open_jobs()
    table = wait_until_ended(store, jobs.start(TrainingStart(SHORT)))
    direct = wait_until_ended(store, jobs.start(TrainingStart(SHORT, continue_from=table.id)))
    unfinished = training(
        "zz", config=SHORT, total=60, state="interrupted", continued_from=table.id
    )
    create(store, unfinished)
    assert jobs.resume(unfinished.id).state == "queued"
    assert wait_until_ended(store, unfinished).state == "finished"
    assert store.artifact(unfinished.id, TABLE) == store.artifact(direct.id, TABLE)


def test_training_whose_table_was_deleted_cannot_resume(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    run = create(store, training("a", state="interrupted", continued_from="gone"))
    with pytest.raises(InvalidInput, match="gone"):
        open_jobs().resume(run.id)
    assert store.get(run.id).state == "interrupted"


def test_table_that_a_queued_run_needs_cannot_be_deleted(store: RunStore) -> None:
    """A run's table is loaded when it starts, so it must still be there then."""
    source = ended_training(store, "a")
    assert isinstance(source.config, TrainingConfig)
    jobs = Jobs(store, Recordings(store), EventBus())  # not opened, so that all runs stay queued
    practice = jobs.start(TrainingStart(source.config, continue_from="a"))
    race = jobs.start(RaceStart(WALK, [LaneStart("q-learning", training_id="a")], steps=5, seed=0))
    for run in (practice, race):
        with pytest.raises(Conflict, match=f"{run.kind} {run.id} waits, and needs its table"):
            jobs.delete("a")
        jobs.stop(run.id)
    jobs.delete("a")


def test_damaged_checkpoint_is_rejected_by_name(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    run = create(store, training("a", state="interrupted"))
    store.put_artifact(run.id, CHECKPOINT, b"nonsense")
    with pytest.raises(DamagedFile, match="checkpoint of training a"):
        open_jobs().resume(run.id)
    assert store.get(run.id).state == "interrupted"


@pytest.mark.parametrize(
    "meta", [{"changes": None}, {"step": 10**9}, {"step": "1"}, {"agent": "greedy"}, {"legs": 4}]
)
def test_checkpoint_that_does_not_fit_its_training_is_rejected(
    meta: dict[str, object], store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    run = create(store, training("a", config=SHORT, total=60, state="interrupted"))
    good = snapshot(build_learner(SHORT), SHORT, changes=[])
    data = to_bytes(replace(good, meta={**good.meta, **meta}))
    store.put_artifact(run.id, CHECKPOINT, data)
    with pytest.raises(InvalidInput):
        open_jobs().resume(run.id)
    store.put_artifact(run.id, CHECKPOINT, to_bytes(good))
    assert open_jobs().resume(run.id).state == "queued"


def test_resumed_race_resumes_its_training_first(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    first = open_jobs()
    race, practice_id = start_race_and_practise(first, store)
    first.close()
    assert store.get(race.id).state == store.get(practice_id).state == "interrupted"
    assert store.get(race.id).waiting_for == ()

    second = open_jobs()
    resumed = second.resume(race.id)
    assert (resumed.state, resumed.waiting_for) == ("queued", (practice_id,))
    wait_until(lambda: store.get(practice_id).state == "running")
    with pytest.raises(Conflict):
        second.resume(practice_id)
    second.stop(race.id)
    assert wait_until_ended(store, race).state == "stopped"


def test_race_restarts_from_its_start(store: RunStore, open_jobs: Callable[[], Jobs]) -> None:
    config = RaceConfig(**vars(WALK), lanes=(LaneConfig(agent="greedy"),), steps=5)
    run = Run(
        id="r",
        kind="race",
        name="r",
        state="interrupted",
        config=config,
        done=3,
        total=5,
        lane_training_ids=(None,),
    )
    create(store, run)
    jobs = open_jobs()
    assert jobs.resume("r").done == 0
    assert wait_until_ended(store, run).state == "finished"


def test_race_resumes_its_failed_training(store: RunStore, open_jobs: Callable[[], Jobs]) -> None:
    practice = training_config(gait="left-right-origin", simulator="kinematic", steps=20)
    store.create(training("t", state="failed", config=practice, total=20))
    config = RaceConfig(**vars(WALK), lanes=(LaneConfig(agent="q-learning"),))
    run = Run(id="r", kind="race", name="r", config=config, total=50, lane_training_ids=("t",))
    store.create(replace(run, state="failed", error="Its training t failed."))
    open_jobs().resume("r")
    assert wait_until_ended(store, run).state == "finished"
    assert store.get("t").state == "finished"


@pytest.mark.parametrize("state", ["stopped", None])
def test_race_whose_training_is_lost_cannot_resume(
    state: str | None, store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    if state is not None:
        store.create(training("t", state=state))
    config = RaceConfig(gait="left-right-origin", lanes=(LaneConfig(agent="q-learning"),))
    run = Run(
        id="r",
        kind="race",
        name="r",
        state="interrupted",
        config=config,
        total=50,
        lane_training_ids=("t",),
    )
    create(store, run)
    with pytest.raises(Conflict, match=r"training t"):
        open_jobs().resume("r")


def test_run_queued_at_shutdown_can_be_queued_again(
    store: RunStore, open_jobs: Callable[[], Jobs]
) -> None:
    first = open_jobs()
    wait_for_progress(store, first.start(TrainingStart(SLOW)))
    waiting = first.start(TrainingStart(SHORT))
    first.close()
    now = store.get(waiting.id)
    assert (now.state, now.done) == ("interrupted", 0)
    assert "before its turn" in (now.error or "")
    second = open_jobs()
    second.resume(waiting.id)
    assert wait_until_ended(store, waiting).state == "finished"
