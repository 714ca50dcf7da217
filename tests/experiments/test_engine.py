"""The engine on real worker processes: results do not depend on their number or on deaths."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import experiment_config
from hexapods.experiments.engine import run_trials
from hexapods.experiments.plan import Trial
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worker import Outcome
from tests.experiments import crashing_agent
from tests.experiments.clusters import (
    CRASHING,
    one_by_one,
    results,
    small,
    trials_of,
    workers_of,
)

pytestmark = pytest.mark.test

ONE, TWO = ClusterSpec(workers=1), ClusterSpec(workers=2)


@pytest.fixture(scope="module")
def trials() -> list[Trial]:
    return trials_of(small(seeds=40))


@pytest.fixture(scope="module")
def expected(trials: list[Trial]) -> dict[str, TrialResult]:
    return one_by_one(trials)


@pytest.fixture
def crash_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that configures which trials of the crashing agent kill their worker."""
    monkeypatch.setenv(crashing_agent.FOLDER, str(tmp_path))
    return tmp_path


def test_two_workers_and_a_pause_give_the_same_results_as_running_in_process(
    trials: list[Trial], expected: dict[str, TrialResult]
) -> None:
    pauses = iter([0.0, 0.0, 1.0])

    def may_continue() -> bool:
        time.sleep(next(pauses, 0.0))
        return True

    assert results(run_trials(trials, TWO, may_continue)) == expected
    assert not workers_of(psutil.Process())


def test_a_worker_killed_midway_changes_no_result(
    trials: list[Trial], expected: dict[str, TrialResult]
) -> None:
    def while_killing_workers() -> Iterator[Outcome]:
        for number, outcome in enumerate(run_trials(trials, TWO)):
            if number in (5, 40):
                workers_of(psutil.Process())[0].kill()
            yield outcome

    assert results(while_killing_workers()) == expected


def test_stopped_workers_are_replaced(
    trials: list[Trial], expected: dict[str, TrialResult], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by SIGSTOP: their connections stay open, so that nothing else shows it."""
    monkeypatch.setattr("hexapods.worker_pool.STALLED_S", 0.5)

    def while_stopping_workers() -> Iterator[Outcome]:
        for number, outcome in enumerate(run_trials(trials, TWO)):
            if number == 5:
                for worker in workers_of(psutil.Process()):
                    worker.suspend()
            yield outcome

    assert results(while_stopping_workers()) == expected


def test_a_trial_is_set_aside_after_three_dead_workers_or_one_exception(
    crash_folder: Path,
) -> None:
    trials = trials_of(small(seeds=20, agent=CRASHING))
    killer, breaker, quitter = [t for t in trials if t.setting.role == "learner"][5:8]
    ends = [(killer, "kill"), (breaker, "raise"), (quitter, "exit")]
    crashing_agent.set_crashes(
        crash_folder, [(trial.config.training.seed, end) for trial, end in ends]
    )

    outcomes = {outcome.key: outcome for outcome in run_trials(trials, TWO)}

    assert sorted(crashing_agent.tries(crash_folder)) == ["exit", "kill", "kill", "kill", "raise"]
    aside = {key: o.set_aside for key, o in outcomes.items() if o.result is None}
    assert aside == {
        killer.key: "it ended its worker's process 3 times",
        breaker.key: "something in it broke (RuntimeError: I tripped)",
        quitter.key: "something in it broke (SystemExit: enough)",
    }
    crashing_agent.set_crashes(crash_folder, [])
    healthy = [trial for trial in trials if trial.key not in aside]
    assert {key: o.result for key, o in outcomes.items() if o.result} == one_by_one(healthy)


def test_a_trial_whose_agent_cannot_be_imported_on_workers_is_set_aside() -> None:
    trial = trials_of(small(seeds=1))[-1]
    training = replace(trial.config.training, agent="nowhere:Agent")
    setting = replace(trial.setting, trial=replace(trial.config, training=training))
    lost = replace(trial, setting=setting)
    (outcome,) = run_trials([lost], ONE)
    assert outcome.set_aside is not None
    assert "cannot import nowhere" in outcome.set_aside


def test_trials_that_measure_time_come_last(trials: list[Trial]) -> None:
    config = experiment_config(
        "table1", {"seeds": 1, "simulator": "kinematic", "gaits": ("left-right-origin",)}
    )
    timed_first = trials_of(config)[::-1]
    keys = [outcome.key for outcome in run_trials(timed_first, TWO)]
    timed = [trial.key for trial in timed_first if trial.config.must_be_alone]
    assert keys[-len(timed) :] == timed


def test_it_stops_soon_when_may_continue_returns_false(trials: list[Trial]) -> None:
    slow = trials_of(small(seeds=4, steps=10_000_000))[-4:]
    calls = iter(range(1_000_000))
    ended = list(run_trials(slow, ONE, lambda: next(calls) < 10))
    assert ended == [], "trials in progress take minutes, and must be cancelled"
    assert next(calls) > 10
    assert not workers_of(psutil.Process())


def test_without_trials_no_cluster_is_started() -> None:
    assert list(run_trials([], ClusterSpec(scheduler="tcp://127.0.0.1:1"))) == []


def test_closing_the_generator_ends_the_workers_and_deletes_their_files(
    trials: list[Trial], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    running = run_trials(trials, TWO)
    next(running)
    assert len(workers_of(psutil.Process())) == 2
    assert list(tmp_path.iterdir())
    running.close()
    assert not workers_of(psutil.Process())
    assert list(tmp_path.iterdir()) == []
