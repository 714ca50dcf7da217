"""Estimates of how long runs take: steps of each kind are timed once, and added up."""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager
from typing import Any

import pytest

from app.features.experiments.start import ExperimentStart
from app.features.what_if.estimate import MAX_WAITING, Estimates
from app.features.what_if.step_time import TimedSteps
from app.jobs.process_pool import ProcessPool
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.storage.errors import Busy
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.config import experiment_config
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.training import train
from tests.jobs.waiting import wait_until

WALK = WalkingProblem(gait="left-right-origin", simulator="kinematic")


class TimedPool(ProcessPool):
    """A pool in which a step takes 0.1 s, with look-ahead 1 s; it remembers what it timed."""

    def __init__(self) -> None:
        super().__init__(count=1)
        self.timed: list[str] = []
        self._free = threading.Lock()

    def held(self) -> AbstractContextManager[object]:
        """Return a context in which it answers no request."""
        return self._free

    def map(
        self,
        function: Callable[[Any], Any],
        arguments: Sequence[Any],
        check: Callable[[], None] = lambda: None,
        limit_s: float = 0.0,
    ) -> list[Any]:
        kinds: Sequence[TimedSteps] = arguments
        with self._free:
            return self._times_of(kinds)

    def _times_of(self, kinds: Sequence[TimedSteps]) -> list[Any]:
        self.timed += [kind.training.agent for kind in kinds]
        return [0.1 if kind.practises else 1.0 for kind in kinds]


def training(**fields: Any) -> TrainingStart:
    return TrainingStart(training_config(**vars(WALK), **{"evaluate_every": 0, **fields}))


def test_steps_and_evaluations_are_added_up_and_timed_once() -> None:
    pool = TimedPool()
    estimates = Estimates(pool, cores=2)
    assert estimates.of(training(steps=100)) == pytest.approx((100 + 50) * 0.1)
    evaluated = training(steps=100, evaluate_every=25, seed=3)
    assert estimates.of(evaluated) == pytest.approx((100 + 5 * 50) * 0.1)
    paced = training(steps=100, pace=1)
    step_s = WALK.robot.step_s
    assert estimates.of(paced) == pytest.approx(100 * max(step_s, 0.1) + 50 * 0.1)
    assert pool.timed == ["q-learning"]

    lanes = [
        LaneStart("q-learning", training=training(steps=100)),
        LaneStart("sarsa", training=training(steps=200, agent="sarsa")),
        LaneStart("greedy"),
    ]
    practice_s = (200 + 50) * 0.1  # beside the other one, which is shorter
    assert estimates.of(RaceStart(WALK, lanes, 10, 0)) == pytest.approx(
        practice_s + 10 * (0.1 + 0.1 + 1.0)
    )


def test_trials_are_divided_among_the_workers() -> None:
    config = experiment_config(
        "sweep", {"seeds": 6, "steps": (100,), "gaits": ("left-right-origin",)}
    )
    greedy_s, learners_s = 50 * 1.0, 6 * (100 + 50) * 0.1
    estimates = Estimates(TimedPool(), cores=2)
    assert estimates.of(ExperimentStart(config)) == pytest.approx((greedy_s + learners_s) / 2)
    assert estimates.workers_of(ExperimentStart(config)) == 2
    assert estimates.workers_of(ExperimentStart(config, workers=1)) == 1
    assert estimates.workers_of(training(steps=100)) is None


def test_trials_that_are_not_timed_count_as_those_of_the_same_agent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("app.features.what_if.estimate.MAX_MEASURED", 4)
    config = experiment_config(
        "sweep", {"seeds": 1, "agents": ("greedy", "q-learning"), "steps": (100,)}
    )
    pool = TimedPool()
    gaits = len(config.gaits)
    assert gaits > 2
    estimated_s = Estimates(pool, cores=1).of(ExperimentStart(config, workers=1))
    assert sorted(pool.timed) == ["greedy", "greedy", "q-learning", "q-learning"]
    greedy_s, learner_s = 50 * 1.0, (100 + 50) * 0.1
    assert estimated_s == pytest.approx(gaits * (greedy_s + learner_s))


def test_too_many_requests_that_wait_are_refused_as_busy() -> None:
    pool = TimedPool()
    estimates = Estimates(pool, cores=1)
    known_s = estimates.of(training(steps=100))
    count = 1 + MAX_WAITING
    with ThreadPoolExecutor(count) as threads, pool.held():
        futures = [
            threads.submit(estimates.of, training(steps=100, agent="sarsa")) for _ in range(count)
        ]
        wait_until(lambda: estimates.turns.waiting == MAX_WAITING)
        with pytest.raises(Busy, match="estimates are waiting") as busy:
            estimates.of(training(steps=100, agent="dyna-q"))
        assert busy.value.retry_after_s > 0
        assert estimates.of(training(steps=100)) == known_s
    assert [future.result() for future in futures] == [known_s] * count
    assert pool.timed == ["q-learning", "sarsa"]
    assert estimates.of(training(steps=100, agent="dyna-q")) == known_s


@pytest.fixture(scope="module")
def estimates() -> Iterator[Estimates]:
    running = Estimates(ProcessPool(count=1), cores=1)
    yield running
    running.close()


def test_a_measured_estimate_is_near_the_truth(estimates: Estimates) -> None:
    start = training(steps=4000)
    config = start.config
    began_s = time.perf_counter()
    for _ in train(build_learner(config), config):
        pass
    took_s = time.perf_counter() - began_s
    assert took_s / 20 < estimates.of(start) < 20 * took_s, "other tests run meanwhile"


def test_what_cannot_be_started_is_not_estimated(estimates: Estimates) -> None:
    large = WalkingProblem(gait="left-right-origin", divisions=8, grid_side_m=0.03)
    with pytest.raises(InvalidInput, match="choose fewer"):
        estimates.of(TrainingStart(training_config(**vars(large), agent="posterior-sampling")))
