"""Experiments as jobs: pause, stop, crash and resume, invalid trials, limits on size."""

import json
import os
import signal
import time
from collections.abc import Mapping, Sequence
from typing import Any

import psutil
import pytest

from app.events.bus import EventBus
from app.features.experiments.start import ExperimentStart
from app.features.experiments.trial_rows import Trials
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, StorageFull
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run
from hexapods.domain.errors import InvalidInput, Unreachable
from hexapods.experiments.config import REPORT, SUMMARY, ExperimentConfig, experiment_config
from hexapods.experiments.plan import Plan
from hexapods.experiments.result import TrialCounts
from tests.experiments.clusters import workers_of
from tests.features.experiments.ended_experiments import experiment_result
from tests.features.experiments.sweeps import results_of_trials, stored_results, sweep
from tests.jobs.test_jobs import pid_of
from tests.jobs.waiting import wait_until, wait_until_ended
from tests.served import is_job


def wait_for_more_trials(store: RunStore, run: Run, done: int) -> None:
    wait_until(
        lambda: (
            len(Trials(store.database).get(run.id)) > done
            or store.get(run.id).state not in NOT_ENDED
        )
    )
    assert store.get(run.id).state == "running"


def wait_until_settled(store: RunStore, run: Run) -> Sequence[Mapping[str, Any]]:
    """Wait until no more trials arrive at the server, and return them."""
    rows: Sequence[Mapping[str, Any]] | None = None
    while rows != Trials(store.database).get(run.id):
        rows = Trials(store.database).get(run.id)
        time.sleep(1.0)
    return rows


def worker_pids() -> set[int]:
    """Return ids of the processes of jobs, and of those of their clusters."""
    me = psutil.Process()
    jobs = filter(is_job, me.children(recursive=True))
    return {process.pid for process in (*jobs, *workers_of(me))}


@pytest.mark.promises
@pytest.mark.timeout(300)
def test_interrupted_experiment_resumes_without_repeating_trials(
    jobs: Jobs, store: RunStore
) -> None:
    """Paused, stopped, killed and resumed, it gives the results of an uninterrupted run."""
    before = worker_pids()
    config = sweep(seeds=24, steps=(1000,))
    run = jobs.start(ExperimentStart(config, workers=1))
    assert (run.name, run.total, run.kind) == ("Q-learning · 24 seeds", 25, "experiment")

    wait_for_more_trials(store, run, 0)
    jobs.pause(run.id)
    # A pause shuts the cluster down.
    wait_until(lambda: len(worker_pids() - before) == 1)
    paused = wait_until_settled(store, run)
    time.sleep(0.3)
    assert Trials(store.database).get(run.id) == paused
    jobs.resume(run.id)
    wait_for_more_trials(store, run, len(paused))

    stopped = jobs.stop(run.id)
    assert (stopped.state, stopped.error) == ("stopped", None)
    stored = Trials(store.database).get(run.id)
    assert stopped.done == len(stored) < 25
    result = experiment_result(stopped)
    assert result.trials == TrialCounts(done=len(stored), total=25, failed=0, set_aside=0)
    assert result.files[0] == SUMMARY
    for name in result.files:
        assert store.artifact(run.id, name), name
    wait_until(lambda: worker_pids() == before)

    resumed = jobs.resume(run.id)
    assert (resumed.state, resumed.done, resumed.result) == ("queued", len(stored), None)
    wait_for_more_trials(store, run, len(stored))
    os.kill(pid_of(run), signal.SIGKILL)
    killed = wait_until_ended(store, run)
    assert killed.state == "failed"
    assert "SIGKILL" in (killed.error or "")
    wait_until(lambda: worker_pids() == before)

    jobs.resume(run.id)
    finished = wait_until_ended(store, run)
    assert (finished.state, finished.done, finished.error) == ("finished", 25, None)
    assert stored_results(store, run.id) == results_of_trials(config)
    times = {row["key"]: row["compute_s"] for row in Trials(store.database).get(run.id)}
    assert all(times[row["key"]] == row["compute_s"] for row in stored), "some were repeated"
    with pytest.raises(Conflict, match="failed or interrupted or paused or stopped"):
        jobs.resume(run.id)
    wait_until(lambda: worker_pids() == before)
    check_summary(store, run, config)


def check_summary(store: RunStore, run: Run, config: ExperimentConfig) -> None:
    summary = json.loads(store.artifact(run.id, SUMMARY) or b"")
    assert summary["trials"]["done"] == 25
    assert summary["config"]["seeds"] == config.seeds
    learner = next(process for process in summary["settings"] if process["role"] == "learner")
    assert learner["n"] == 24
    cost = summary["cost"]
    assert cost["workers"] == 1
    assert cost["wall_s"] > 0
    assert cost["compute_s"] == pytest.approx(
        sum(row["compute_s"] for row in Trials(store.database).get(run.id)), rel=0.01
    )
    assert (store.artifact(run.id, REPORT) or b"").startswith(b"<!doctype html>")


class FullTrials(Trials):
    """Fake table without disk space for trials until `room` is set."""

    room = 0

    def append(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        if self.room == 0:
            raise StorageFull("the disk of the data folder is full; delete runs")
        super().append(run_id, rows)


def test_full_disk_fails_the_run_which_resumes_once_there_is_space(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.features.experiments.job.Trials", FullTrials)
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
    jobs.open()
    try:
        run = jobs.start(ExperimentStart(sweep(), workers=1))
        failed = wait_until_ended(store, run)
        assert failed.state == "failed"
        assert "the disk of the data folder is full" in (failed.error or "")
        monkeypatch.setattr(FullTrials, "room", 1_000)
        jobs.resume(run.id)
        assert wait_until_ended(store, run).state == "finished"
        assert stored_results(store, run.id) == results_of_trials(sweep())
    finally:
        jobs.close()


def test_invalid_trials_are_set_aside_and_the_others_are_kept(jobs: Jobs, store: RunStore) -> None:
    config = sweep(agents=("q-learning", "tests.own_agents:Clumsy"))
    run = wait_until_ended(store, jobs.start(ExperimentStart(config, name="Mine", workers=1)))
    assert (run.name, run.state, run.done) == ("Mine", "finished", run.total)
    assert experiment_result(run).trials == TrialCounts(done=4, total=7, failed=3, set_aside=3)
    for row in Trials(store.database).get(run.id):
        assert (row["result"] is None) == ("Clumsy" in row["key"])
        assert row["result"] is not None or "I tripped" in row["set_aside"]


def test_queued_or_starting_experiment_stops_at_once(jobs: Jobs, store: RunStore) -> None:
    config = sweep(seeds=100, steps=(2000,))
    first, second = (jobs.start(ExperimentStart(config)) for _ in range(2))
    assert jobs.stop(second.id).state == "stopped"
    wait_until(lambda: store.get(first.id).state == "running")
    stopped = jobs.stop(first.id)
    assert stopped.state == "stopped"
    assert stopped.done < 101


def test_too_large_or_unreachable_grid_is_rejected(jobs: Jobs) -> None:
    values = tuple(n / 1000 for n in range(1, 101))
    for lists, message in (
        (
            {"alpha": values, "gamma": values, "epsilon_start": values, "epsilon_end": values},
            "settings",
        ),
        ({"alpha": values, "seeds": 10_000}, "trials"),
    ):
        fields = {"simulator": "kinematic", **lists}
        with pytest.raises(InvalidInput, match=message):
            jobs.start(ExperimentStart(experiment_config("sweep", fields)))
    with pytest.raises(Unreachable):
        jobs.start(ExperimentStart(sweep(grid_side_m=(0.3,))))
    with pytest.raises(InvalidInput, match="cores of this machine"):
        jobs.start(ExperimentStart(sweep(), workers=512))


def test_experiments_of_the_paper_are_within_the_limits(jobs: Jobs) -> None:
    for name, total in (("table1", 1008), ("figure4", 488)):
        run = jobs.start(ExperimentStart(experiment_config(name, {})))
        assert run.total == total == Plan(experiment_config(name, {})).total
        jobs.stop(run.id)
