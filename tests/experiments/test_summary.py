"""The summary has correct numbers, and the same shape at every stage of an experiment."""

import json
from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.gait import GaitSpec
from hexapods.experiments.plan import Plan
from hexapods.experiments.published import published
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult
from hexapods.runs.best_known import kept
from tests.experiments.sample_experiments import (
    GREEDY_M,
    ROBOTS,
    around,
    config,
    sample_results,
    setting,
    summary_of,
    walked,
)
from tests.figures import GREEDY_H, H_M
from tests.promises.length import at_length

pytestmark = pytest.mark.test

LRO = "left-right-origin"
Q500 = f"{LRO}/measured/stiff/q-learning/500"


SEEDS = at_length(10, 30)
"""Of the kinematic table; `tests/runs/test_figures.py` has the same figures of more."""


def test_the_kinematic_table_agrees_with_the_specification() -> None:
    """IQM as a share of greedy after 500 and 1,000 steps: 74 and 83 %; 92 % walk after 500."""
    only = {"gaits": (LRO,), "observations": ("measured",), "robots": ROBOTS[:1]}
    summary = summarise(*walked("table1", SEEDS, **only))
    greedy = setting(summary, f"{LRO}/measured/stiff/greedy")
    assert greedy["total"]["iqm_m"] / greedy["half_side_m"] == pytest.approx(GREEDY_H, abs=0.001)
    assert greedy["half_side_m"] == H_M
    two_step = setting(summary, f"{LRO}/measured/stiff/two-step")
    assert two_step["total"]["iqm_m"] == pytest.approx(greedy["total"]["iqm_m"])
    assert (greedy["elapsed_s"], two_step["elapsed_s"]) == pytest.approx((21.76, 90.88), abs=0.01)
    for steps, level in ((500, 0.74), (1000, 0.83)):
        learner = setting(summary, f"{LRO}/measured/stiff/q-learning/{steps}")
        assert learner["n"] == SEEDS
        assert learner["relative"]["low"] < level < learner["relative"]["high"]
    assert setting(summary, Q500)["walkers"]["share"] >= 0.8
    assert summary["trials"]["done"] == summary["trials"]["total"]


def test_figure4_has_learning_curves_over_its_blocks() -> None:
    tried, results = walked("figure4", 5, gaits=(LRO,))
    summary = summarise(tried, results)
    curve = summary["curves"][0]
    assert curve["steps"] == [250, 500, 750, 1000, 1250, 1500, 1750, 2000]
    assert curve["greedy_m"] == pytest.approx(GREEDY_H * H_M, abs=1e-4)
    key = f"{LRO}/measured/stiff/q-learning/8x250"
    for seed in range(5):
        of_seed = [block[seed] for block in curve["points_m"]]
        assert of_seed == list(results[f"{key}#{seed}"].distances_m)
    in_one_go = summary["curves"][2]
    assert (curve["blocks"], in_one_go["blocks"]) == (8, 1)
    assert in_one_go["steps"] == curve["steps"]
    one_go_key = f"{LRO}/measured/stiff/q-learning/2000"
    assert [block[0] for block in in_one_go["points_m"]] == list(
        results[f"{one_go_key}#0"].distances_m
    )
    assert in_one_go["points_m"] != curve["points_m"]
    learner = setting(summary, key)
    assert learner["total"]["points_m"] == curve["points_m"][-1]
    assert learner["finished"] is None
    assert learner["beats_greedy"] is None


def test_a_setting_has_its_averages_and_the_distances_of_all_seeds() -> None:
    tried = config("table1", seeds=8, gaits=(LRO,))
    results = sample_results(tried, lambda _: lambda number: 0.1 * number)
    learner = setting(summarise(tried, results), Q500)
    assert learner["total"]["points_m"] == pytest.approx([0.1 * n for n in range(8)])
    assert learner["total"]["iqm_m"] == pytest.approx(0.35)
    assert learner["total"]["median_m"] == pytest.approx(0.35)
    assert learner["relative"]["iqm"] == pytest.approx(0.7)
    assert learner["walkers"]["share"] == 5 / 8  # from 0.3 m; greedy has 0.5 m
    assert learner["reaches_greedy"]["share"] == 3 / 8  # from 0.475 m
    assert learner["beats_greedy"]["share"] == 4 / 8  # before greedy's 0.36 m at time-out
    assert learner["beats_greedy"]["verdict"] == "not established"


def test_a_published_value_has_its_quantile_among_our_seeds() -> None:
    tried = config("table1", seeds=8, gaits=(LRO,))
    results = sample_results(tried, lambda _: lambda number: 0.1 * number)
    printed = setting(summarise(tried, results), Q500)["published"]
    assert printed["total_m"] == printed["finished_m"] == 0.25
    assert printed["total_quantile"] == 3 / 8
    two_step = setting(summarise(tried, results), f"{LRO}/measured/stiff/two-step")["published"]
    assert (two_step["total_m"], two_step["finished_m"]) == (None, 0.04)
    assert two_step["finished_quantile"] is None  # a single walk is not a distribution


def test_published_values_are_those_of_the_papers_table() -> None:
    printed = [published("front-back-origin", "q-learning", steps) for steps in (500, 1000)]
    assert [distances.total_m for distances in printed if distances] == [0.075, 0.375]
    greedy = published("left-right-vertical", "greedy", 0)
    assert greedy is not None
    assert (greedy.finished_m, greedy.total_m) == (0.425, 0.525)
    assert published(LRO, "q-learning", 250) is None
    assert published("my gait", "greedy", 0) is None


def test_gaits_are_the_strata_of_pooled_measures() -> None:
    far = {"left-right-vertical": 0.1}
    summary = summary_of(
        "table1", lambda setting: around(far.get(setting.gait, 0.4), 0.001), seeds=6, robots=None
    )
    pool = summary["pooled"][0]
    assert pool["n"] == 24
    assert pool["gaits"][1] == "left-right-vertical"
    assert pool["walkers"]["share"] == 0.75
    # Variance between gaits does not widen the interval; the seeds within a gait hardly vary.
    assert pool["relative"]["high"] - pool["relative"]["low"] < 0.01


@pytest.mark.parametrize(("seeds", "has_interval"), [(2, False), (3, True)])
def test_pooled_intervals_need_enough_seeds_in_each_gait(seeds: int, has_interval: bool) -> None:
    pool = summary_of("table1", lambda _: around(0.3), seeds=seeds)["pooled"][0]
    assert pool["n"] == 4 * seeds
    for measure in ("relative", "walkers", "beats_greedy", "reaches_greedy"):
        assert (pool[measure]["low"] is not None) == has_interval


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
@pytest.mark.parametrize("done", [0, 3, 11, 40])
def test_a_partly_filled_experiment_has_the_same_shape(experiment: str, done: int) -> None:
    tried = config(experiment, seeds=4)
    whole = sample_results(tried, lambda _: around(0.3))
    partial_results = dict(list(whole.items())[:done])
    summary = summarise(tried, partial_results)
    assert summary.keys() == summarise(tried, whole).keys()
    assert [entry["key"] for entry in summary["settings"]] == [
        setting.key for setting in Plan(tried).settings if setting.role != "timed"
    ]
    assert summary["trials"]["done"] == min(done, len(whole))
    for entry in summary["settings"]:
        assert entry["n"] == sum(key.startswith(entry["key"] + "#") for key in partial_results)
        assert (entry["total"] is None) == (entry["n"] == 0)
    json.dumps(summary, allow_nan=False)


def test_the_summary_does_not_depend_on_the_order_of_results() -> None:
    tried = config("table1", seeds=4, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    backwards = dict(reversed(results.items()))
    assert json.dumps(summarise(tried, results)) == json.dumps(summarise(tried, backwards))


def test_a_failed_trial_is_excluded_from_all_measures_and_listed() -> None:
    tried = config("table1", seeds=4, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    results[f"{Q500}#2"] = TrialResult(failure="the physics diverged")
    summary = summarise(tried, results, {f"{Q500}#3": "it killed its worker three times"})
    learner = setting(summary, Q500)
    assert (learner["n"], learner["failed"]) == (3, 2), "one of them was set aside"
    assert summary["trials"]["failed"] == 2
    label = "Q-learning, 500\u00a0steps, Left-right, opposite, feet measured, stiff robot, seed 2"
    failure = {"key": f"{Q500}#2", "label": label, "reason": "the physics diverged"}
    assert summary["trials"]["failures"] == [failure]
    assert summary["trials"]["set_aside"][0]["key"] == f"{Q500}#3"


def test_without_greedys_result_relative_measures_are_none() -> None:
    tried = config("table1", seeds=4, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    del results[f"{LRO}/measured/stiff/greedy#0"]
    learner = setting(summarise(tried, results), Q500)
    assert learner["n"] == 4
    for measure in ("relative", "walkers", "beats_greedy", "reaches_greedy"):
        assert learner[measure] is None


def test_a_greedy_agent_that_hardly_moves_is_not_used_as_a_reference() -> None:
    tried = config("table1", seeds=4, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    key = f"{LRO}/measured/stiff/greedy#0"
    results[key] = replace(results[key], distances_m=(-0.002,), finished_distance_m=0.0)
    assert setting(summarise(tried, results), Q500)["relative"] is None


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_distances_are_measured_against_the_best_known(experiment: str) -> None:
    gaits = (LRO, "left-right-vertical")
    only = {"observations": ("measured",), "robots": ROBOTS[:1], "simulator": "mujoco"}
    summary = summary_of(experiment, lambda _: around(0.3, 0.0), seeds=4, gaits=gaits, **only)
    best_m = {gait: kept()["stiff", "flat", gait] for gait in gaits}
    for entry in [*summary["settings"], *summary["curves"]]:
        assert entry["best_known_m"] == best_m[entry["gait"]]
    learner = next(entry for entry in summary["settings"] if entry["role"] == "learner")
    far_m = learner["total"]["iqm_m"]
    assert learner["of_best_known"]["iqm"] == pytest.approx(far_m / best_m[LRO])
    pool = summary["pooled"][0]
    shares = [far_m / most_m for most_m in best_m.values()]
    assert pool["of_best_known"]["iqm"] == pytest.approx(sum(shares) / 2)
    assert pool["best_known_relative"] == pytest.approx(sum(best_m.values()) / 2 / GREEDY_M)


def test_where_one_gait_has_no_best_known_distance_their_mean_has_none() -> None:
    own_gait = GaitSpec(1, 2, pairs=((1, 2), (3, 4), (5, 6)))
    summary = summary_of(
        "sweep", lambda _: around(0.3), seeds=4, gaits=(LRO, own_gait), simulator="mujoco"
    )
    learners = [entry for entry in summary["settings"] if entry["role"] == "learner"]
    assert [entry["best_known_m"] is None for entry in learners] == [False, True]
    assert [entry["of_best_known"] is None for entry in learners] == [False, True]
    assert summary["pooled"][0]["of_best_known"] is None
    assert summary["pooled"][0]["best_known_relative"] is None


def test_learning_agents_are_compared_in_pairs() -> None:
    restless = "tests.own_agents:Restless"
    far = {"q-learning": 0.4, restless: 0.1}
    summary = summary_of(
        "sweep", lambda setting: around(far[setting.training.agent]), seeds=6, agents=tuple(far)
    )
    assert len(summary["versus"]) == 4
    comparison = summary["versus"][0]
    assert (comparison["a"], comparison["b"]) == ("q-learning", restless)
    assert (comparison["probability"], comparison["verdict"]) == (1, "yes")


def test_a_search_agent_is_pooled_without_an_interval() -> None:
    three = "tests.own_agents:ThreeStep"
    summary = summary_of("sweep", lambda _: around(0.3), seeds=4, agents=("q-learning", three))
    pool = next(entry for entry in summary["pooled"] if entry["agent"] == three)
    assert pool["relative"] == {"iqm": 1.0, "low": None, "high": None}
    assert pool["walkers"] is None


def test_timed_races_are_listed_with_their_lanes() -> None:
    summary = summary_of("table1", lambda _: around(0.3), seeds=1, gaits=(LRO,))
    assert [race["gait"] for race in summary["timed"]] == [LRO] * 4
    lanes = summary["timed"][0]["lanes"]
    assert [lane["agent"] for lane in lanes] == ["q-learning", "greedy", "two-step"]


def test_the_summary_has_config_cost_versions_and_machine() -> None:
    cost = {"wall_s": 60.0, "compute_s": 100.0, "trials_per_s": 1.5, "workers": 2}
    tried = config("figure4", seeds=2, seed=9)
    summary = summarise(tried, {}, cost=cost)
    assert summary["config"]["seed"] == 9
    assert summary["cost"] == cost
    assert {"racing-hexapods", "python", "numpy", "mujoco"} <= summary["versions"].keys()
    assert summary["machine"].keys() == {"platform", "cores"}


def test_results_outside_the_plan_are_ignored() -> None:
    tried = config("table1", seeds=4, gaits=(LRO,))
    results = sample_results(tried, lambda _: around(0.3))
    fewer = summarise(replace(tried, seeds=3), results)
    assert setting(fewer, Q500)["n"] == 3
    assert fewer["trials"]["done"] == fewer["trials"]["total"]
    assert np.isfinite(setting(fewer, Q500)["total"]["low_m"])
