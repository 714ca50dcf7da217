"""Settings of summaries compared: which are paired, in what unit, and what is refused."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.experiments.comparison import Unit
from hexapods.experiments.plan import Plan
from hexapods.experiments.setting_comparison import compare_settings, find_setting
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult
from tests.experiments.sample_experiments import (
    GREEDY_M,
    alpha_of,
    around,
    config,
    sample_results,
    summary_of,
)

REPORTS = Path(__file__).parents[2] / "docs" / "reproduction"


@pytest.fixture(scope="module")
def sweep() -> dict[str, Any]:
    """Three learning rates, of which larger ones walk farther."""
    return summary_of(
        "sweep",
        lambda setting: around(alpha_of(setting)),
        seeds=12,
        gaits=("left-right-origin",),
        alpha=(0.1, 0.3, 0.35),
    )


def test_settings_are_named_by_what_differs_between_the_two(sweep: dict[str, Any]) -> None:
    compared = compare_settings(sweep, "α 0.35", "α 0.1")
    assert compared.a.name == "Q-learning, α 0.35"
    assert compared.difference.value == pytest.approx(0.25)
    assert compared.ahead == "a"
    greedy = compare_settings(sweep, "greedy", "α 0.1")
    assert (greedy.a.name, greedy.b.name) == ("Greedy", "Q-learning, 500 steps")
    assert greedy.a.is_deterministic


def test_settings_of_a_sweep_have_other_seeds_and_are_not_paired(sweep: dict[str, Any]) -> None:
    assert not compare_settings(sweep, "α 0.35", "α 0.1").is_paired


def test_settings_of_a_league_walk_with_the_same_robots_and_are_paired() -> None:
    tried = config(
        "league", seeds=8, gaits=("left-right-origin",), agents=("q-learning", "sarsa-lambda")
    )
    assert {trial.seed for trial in Plan(tried).trials() if trial.seed_number == 3}.__len__() == 1
    results = sample_results(tried, lambda setting: around(0.3))
    failed = next(trial.key for trial in Plan(tried).trials() if trial.seed_number == 5)
    results[failed] = TrialResult(failure="it fell")
    summary = summarise(tried, results)
    a, b = (entry["key"] for entry in summary["settings"] if entry["role"] == "learner")
    compared = compare_settings(summary, a, b)
    assert compared.is_paired
    assert compared.left_out == int(failed.startswith((a, b)))
    assert compared.a.seeds == 8 - compared.left_out


@pytest.mark.parametrize(("unit", "length_m"), [("m", 1.0), ("h", 0.02), ("greedy", GREEDY_M)])
def test_distances_are_compared_in_each_unit(
    sweep: dict[str, Any], unit: Unit, length_m: float
) -> None:
    compared = compare_settings(sweep, "α 0.35", "α 0.3", unit=unit)
    assert compared.difference.value == pytest.approx(0.05 / length_m)
    assert compared.unit == unit


def test_distances_at_time_out_are_compared_where_there_was_a_race(sweep: dict[str, Any]) -> None:
    compared = compare_settings(sweep, "α 0.35", "greedy", distance="finished")
    assert compared.b.iqm.value == pytest.approx(0.36)
    assert "at time-out" in compared.words.outcome


def test_the_generator_is_injected_and_by_default_that_of_the_experiment(
    sweep: dict[str, Any],
) -> None:
    usual = compare_settings(sweep, "α 0.3", "α 0.35")
    seed = sweep["config"]["seed"]
    assert usual == compare_settings(sweep, "α 0.3", "α 0.35", rng=np.random.default_rng(seed))
    assert usual != compare_settings(sweep, "α 0.3", "α 0.35", rng=np.random.default_rng(seed + 1))


def test_settings_are_found_by_key_name_or_part(sweep: dict[str, Any]) -> None:
    key = sweep["settings"][1]["key"]
    assert find_setting(sweep, key)["key"] == key
    assert find_setting(sweep, "q-learning, α\u00a00.35")["alpha"] == 0.35
    assert find_setting(sweep, "alpha=0.35")["alpha"] == 0.35
    with pytest.raises(UnknownName, match=r"unknown setting 'alpha=0\.9'; choose one of: left-"):
        find_setting(sweep, "alpha=0.9")
    with pytest.raises(InvalidInput, match="is a part of several settings: "):
        find_setting(sweep, "q-learning")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"b": "α 0.1"}, "compared with itself"),
        ({"b": "α 0.3", "unit": "km"}, "unknown unit 'km'; choose one of: m, h, greedy"),
        ({"b": "α 0.3", "distance": "far"}, "choose one of: total, finished"),
    ],
)
def test_what_cannot_be_compared_says_what_can(
    sweep: dict[str, Any], arguments: dict[str, Any], said: str
) -> None:
    with pytest.raises(InvalidInput, match=said):
        compare_settings(sweep, "α 0.1", **arguments)


def test_a_setting_without_a_distance_is_refused_with_the_reason() -> None:
    tried = config("sweep", seeds=2, gaits=("left-right-origin",), alpha=(0.1, 0.3))
    results = sample_results(tried, lambda setting: around(0.3))
    for key in results:
        if "alpha=0.1" in key:
            results[key] = TrialResult(failure="it fell")
    summary = summarise(tried, results)
    with pytest.raises(InvalidInput, match=r"no seed of .*alpha=0.1 has a distance: 2 trials fail"):
        compare_settings(summary, "alpha=0.1", "greedy")
    with pytest.raises(InvalidInput, match="has a distance yet"):
        compare_settings(summarise(tried, {}), "alpha=0.1", "greedy")
    greedyless = {key: result for key, result in results.items() if "greedy" not in key}
    with pytest.raises(InvalidInput, match=r"greedy has not walked.*valid units: m, h"):
        compare_settings(
            summarise(tried, {**greedyless, **_walked(tried)}), "α 0.1", "α 0.3", unit="greedy"
        )


def _walked(tried: Any) -> dict[str, TrialResult]:
    walked = sample_results(tried, lambda setting: around(0.3))
    return {key: result for key, result in walked.items() if "greedy" not in key}


def test_a_report_of_an_earlier_version_is_compared_too() -> None:
    summary = json.loads((REPORTS / "table1" / "summary.json").read_text("utf-8"))
    a, b = (f"left-right-origin/measured/stiff/q-learning/{steps}" for steps in (1000, 500))
    compared = compare_settings(summary, a, b)
    assert (compared.a.name, compared.b.name) == (
        "Q-learning, 1,000 steps",
        "Q-learning, 500 steps",
    )
    assert compared.ahead == "a"
    assert compare_settings(summary, a, "left-right-origin/measured/stiff/greedy").ahead == "b"
