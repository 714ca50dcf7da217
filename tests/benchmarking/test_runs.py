"""Runs of a benchmark: real trainings, and those that fail."""

from collections.abc import Sequence

import pytest

from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.protocol import BestKnown
from hexapods.benchmarking.runs import (
    BenchmarkResult,
    BenchmarkRun,
    TaskPlan,
    best_known_of,
    plan_tasks,
    run_all,
    runs_of,
)
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.plan import trial_seed
from hexapods.practice import train
from hexapods.runs.config import WalkingProblem
from tests.benchmarking.sample_benchmarks import small

ONE_WORKER = ClusterSpec(workers=1)


def done(
    config: BenchmarkConfig, runs: Sequence[BenchmarkRun] | None = None
) -> dict[BenchmarkRun, BenchmarkResult]:
    return dict(run_all(config, plan_tasks(config), runs or runs_of(config), ONE_WORKER))


@pytest.mark.test
def test_a_run_is_a_training_from_scratch_that_then_walks_frozen() -> None:
    config = small(seeds=1, budgets=(6,))
    plans = plan_tasks(config)
    [(run, result)] = run_all(config, plans, runs_of(config), ONE_WORKER)
    assert run == BenchmarkRun("tripod", 6, 0)
    trained = train(
        "q-learning",
        gait="tripod",
        tolerance=0.03,
        steps=6,
        seed=trial_seed(0, 0, 0),
        evaluate_every=6,
    )
    assert result == (trained.distance_m, None)


@pytest.mark.test
@pytest.mark.parametrize("agent", ["linear-model", "r-max"])
def test_one_practice_serves_all_budgets_of_an_agent_that_does_not_know_its_length(
    agent: str,
) -> None:
    config = small(agent, seeds=1, budgets=(2, 5))
    assert done(config) == {
        run: result
        for budget in config.budgets
        for run, result in done(small(agent, seeds=1, budgets=(budget,))).items()
    }


def test_an_agent_that_does_not_learn_walks_each_task_and_seed_once() -> None:
    config = small("wave", budgets=None, seeds=2)
    assert runs_of(config) == [BenchmarkRun("tripod", 0, 0), BenchmarkRun("tripod", 0, 1)]
    first, second = done(config).values()
    assert first.error is None
    assert first.distance_m != second.distance_m, "seeds draw robots"


def test_an_agent_that_raises_has_failed_and_the_shorter_runs_count() -> None:
    """`Clumsy` breaks on its third step: two steps of practice are fine, but not the walk."""
    config = small("tests.own_agents:Clumsy", seeds=1, budgets=(1, 2))
    for result in done(config).values():
        assert result.distance_m == 0.0
        assert result.error is not None


def test_an_agent_that_breaks_late_keeps_what_it_walked_before() -> None:
    """One practice would serve both budgets; it breaks, so that each is run by itself."""
    config = small("tests.own_agents:TiresLate", seeds=1, budgets=(2, 60))
    early, late = done(config).values()
    assert early.error is None
    assert late == BenchmarkResult(0.0, late.error)
    assert "tired" in (late.error or "")


def test_a_task_that_the_agent_cannot_walk_is_a_failed_one() -> None:
    """Six steps ahead are too many sequences where three groups move; with two they are few."""
    config = small("look-ahead", {"depth": 6}, tasks=("left-right-origin",), budgets=None, seeds=2)
    for result in done(config).values():
        assert result.distance_m == 0.0
        assert "depth" in (result.error or "")


def test_best_known_is_stored_of_the_plain_draw_and_searched_of_others() -> None:
    config = small(tasks=("drawn-body",))
    [plan] = plan_tasks(config)
    assert best_known_of(config, plan) == plan.task.best_known
    # Ideal, as a beam of physics takes minutes.
    ideal = TaskPlan(plan.task, WalkingProblem(gait="tripod", simulator="kinematic"))
    best = best_known_of(small(tasks=("drawn-body",), seed=5), ideal)
    assert best == BestKnown(
        distance_m=best.distance_m, found_by="beam search with a bonus, width 16"
    )
    assert best.distance_m > 0.5
