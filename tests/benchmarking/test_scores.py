"""Scores: shares of best known, interquartile means and their intervals, profiles."""

from itertools import count
from typing import Any

import pytest

from hexapods.benchmarking.protocol import BestKnown
from hexapods.benchmarking.runs import BenchmarkResult, plan_tasks
from hexapods.benchmarking.scores import score_of, scores_of
from tests.benchmarking.sample_benchmarks import results, small

KNOWN = BestKnown(distance_m=0.5, found_by="a test")


def test_a_score_is_the_share_of_best_known_and_never_below_0() -> None:
    assert score_of(0.25, 0.5) == 0.5
    assert score_of(-0.3, 0.5) == 0.0
    assert score_of(0.6, 0.5) == 1.2, "what exceeds best known shows it"


def test_tasks_and_aggregate_are_interquartile_means_over_all_runs() -> None:
    config = small(tasks=("tripod", "ice"), budgets=(3,), seeds=4)
    done, at_m = results(config, 0.0), count()
    for run in done:
        done[run] = BenchmarkResult(0.05 * next(at_m))  # 0 to .15 m on the tripod, .2 to .35 on ice
    scored = scores_of(config, plan_tasks(config), done, {"tripod": KNOWN, "ice": KNOWN})
    tripod, ice = scored["tasks"]
    assert tripod["budgets"][0]["scores"] == pytest.approx([0.0, 0.1, 0.2, 0.3])
    assert tripod["score"] == pytest.approx(0.15)
    assert ice["score"] == pytest.approx(0.55)
    assert scored["aggregate"]["score"] == pytest.approx(0.35), "of .2, .3, .4, .5"
    low, high = tripod["interval"]
    assert 0 <= low < 0.15 < high < 0.31
    assert_ascending(scored["aggregate"])


def test_the_seeds_of_a_task_are_resampled_within_it() -> None:
    """Tasks of which each seed is alike have no interval, however different they are."""
    config = small(tasks=("tripod", "ice"), budgets=(3,), seeds=5)
    done = results(config, 0.1)
    done |= {run: BenchmarkResult(0.5) for run in done if run.task == "ice"}
    scored = scores_of(config, plan_tasks(config), done, {"tripod": KNOWN, "ice": KNOWN})
    low, high = scored["aggregate"]["interval"]
    assert low == high == pytest.approx(scored["aggregate"]["score"])


def test_the_profile_is_the_share_of_runs_that_reach_a_score() -> None:
    config = small(tasks=("tripod",), budgets=(3, 6), seeds=4)
    done = results(config, 0.0)
    done |= {run: BenchmarkResult(0.5) for run in done if run.budget == 6}
    profile = scores_of(config, plan_tasks(config), done, {"tripod": KNOWN})["aggregate"]["profile"]
    shares = {point["at"]: point["share"] for point in profile}
    assert shares[0.0] == 1.0
    assert shares[0.05] == shares[1.0] == 0.5
    assert shares[1.05] == 0.0


def test_fewer_than_three_seeds_have_no_interval() -> None:
    config = small(seeds=2)
    scored = scores_of(config, plan_tasks(config), results(config, 0.25), {"tripod": KNOWN})
    assert scored["aggregate"]["interval"] is None
    assert scored["tasks"][0]["interval"] is None
    assert scored["aggregate"]["score"] == 0.5


def test_what_fails_is_named_and_counts_as_0() -> None:
    config = small(budgets=(3,), seeds=4)
    done = results(config, 0.5)
    broken = next(iter(done))
    done[broken] = BenchmarkResult(0.0, "it broke")
    [task] = scores_of(config, plan_tasks(config), done, {"tripod": KNOWN})["tasks"]
    assert task["budgets"][0]["scores"] == [0.0, 1.0, 1.0, 1.0]
    assert task["errors"] == [{"steps": 3, "seed": 0, "error": "it broke"}]


def test_a_task_without_a_best_known_walk_is_named_and_counts_as_0() -> None:
    config = small()
    [task] = scores_of(config, plan_tasks(config), results(config, 0.5), {"tripod": "diverged"})[
        "tasks"
    ]
    assert task["score"] == 0.0
    assert task["best_known_m"] is None
    assert task["errors"] == [{"steps": None, "seed": None, "error": "best known: diverged"}]


def assert_ascending(entry: dict[str, Any]) -> None:
    low, high = entry["interval"]
    assert low <= entry["score"] <= high
