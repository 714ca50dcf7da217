"""The engine on real worker processes: the same results however many there are and die."""

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from app.experiments.cluster import ClusterSpec
from app.experiments.config import experiment_config
from app.experiments.engine import Outcome, run_trials
from app.experiments.plan import Trial
from app.experiments.trial import TrialResult
from tests.experiments import poison
from tests.experiments.clusters import (
    POISONOUS,
    one_by_one,
    results,
    small,
    trials_of,
    workers_of,
)

ONE, TWO = ClusterSpec(workers=1), ClusterSpec(workers=2)


@pytest.fixture(scope="module")
def trials() -> list[Trial]:
    return trials_of(small(seeds=40))


@pytest.fixture(scope="module")
def expected(trials: list[Trial]) -> dict[str, TrialResult]:
    return one_by_one(trials)


@pytest.fixture
def poisoned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that says which trials of a poisonous agent end badly."""
    monkeypatch.setenv(poison.FOLDER, str(tmp_path))
    return tmp_path


def test_two_workers_give_the_results_of_none(
    trials: list[Trial], expected: dict[str, TrialResult]
) -> None:
    assert results(run_trials(trials, TWO)) == expected
    assert not workers_of(psutil.Process())


def test_so_does_one_that_is_paused_meanwhile(
    trials: list[Trial], expected: dict[str, TrialResult]
) -> None:
    pauses = iter([0.0, 0.0, 1.0])

    def go_on() -> bool:
        time.sleep(next(pauses, 0.0))
        return True

    assert results(run_trials(trials, ONE, go_on)) == expected


def test_a_worker_killed_midway_changes_no_result(
    trials: list[Trial], expected: dict[str, TrialResult]
) -> None:
    def with_a_murder() -> Iterator[Outcome]:
        for number, outcome in enumerate(run_trials(trials, TWO)):
            if number in (5, 40):
                workers_of(psutil.Process())[0].kill()
            yield outcome

    assert results(with_a_murder()) == expected


def test_who_ends_its_worker_three_times_is_set_aside_and_who_breaks_at_once(
    poisoned: Path,
) -> None:
    trials = trials_of(small(seeds=20, agent=POISONOUS))
    killer, breaker, quitter = [t for t in trials if t.setting.role == "learner"][5:8]
    ends = [(killer, "kill"), (breaker, "raise"), (quitter, "exit")]
    poison.poison(poisoned, [(trial.config.training.seed, end) for trial, end in ends])

    outcomes = {outcome.key: outcome for outcome in run_trials(trials, TWO)}

    assert sorted(poison.tries(poisoned)) == ["exit", "kill", "kill", "kill", "raise"]
    aside = {key: o.set_aside for key, o in outcomes.items() if o.result is None}
    assert aside == {
        killer.key: "it ended its worker's process 3 times",
        breaker.key: "something in it broke (RuntimeError: I tripped)",
        quitter.key: "something in it broke (SystemExit: enough)",
    }
    poison.poison(poisoned, [])
    healthy = [trial for trial in trials if trial.key not in aside]
    assert {key: o.result for key, o in outcomes.items() if o.result} == one_by_one(healthy)


def test_an_agent_that_workers_cannot_find_is_a_reason() -> None:
    trial = trials_of(small(seeds=1))[-1]
    training = replace(trial.config.training, agent="nowhere:Agent")
    lost = trial._replace(config=replace(trial.config, training=training))
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


def test_it_stops_soon_when_it_shall_not_go_on(trials: list[Trial]) -> None:
    slow = trials_of(small(seeds=4, steps=10_000_000))[-4:]
    began_s = time.monotonic()
    asked = iter(range(1_000_000))
    assert list(run_trials(slow, TWO, lambda: next(asked) < 20)) == []
    assert next(asked) > 20
    assert time.monotonic() - began_s < 60, "a trial takes minutes, and none is waited for"
    assert not workers_of(psutil.Process())


def test_nothing_to_do_starts_nothing() -> None:
    assert list(run_trials([], ClusterSpec(scheduler="tcp://127.0.0.1:1"))) == []


def test_a_consumer_that_leaves_takes_the_workers_with_it_and_their_files(
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
