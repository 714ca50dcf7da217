"""Compare agents along their practice in worlds: curves, shares, steps until they walk."""

import math
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

import numpy as np

from hexapods.experiments.measures import curve_entry, iqm_entry
from hexapods.experiments.setting_results import SettingResults, setting_fields
from hexapods.experiments.statistics import Points, iqm_interval, share_at_least
from hexapods.runs.lane import LaneConfig, PlanningModel, plans_with

MIN_REFERENCE_M = 0.01
"""A reference that walks less is too short for shares of its distance."""
Curves = Sequence[Points]
"""For each evaluation the distance of every seed [m]."""


def compare_in_worlds(
    settings: Sequence[SettingResults], seed: int, reached_share: float
) -> list[dict[str, Any]]:
    """Return an entry for each agent in each world, with the walks of its references.

    Args:
        settings: settings with their results so far; those without any are left out.
        seed: seed of the bootstrap's resampling.
        reached_share: share of a reference's distance to which steps are counted.

    Returns:
        Plain types, fit for JSON. Of each agent its distance after the last evaluation, its share
        of greedy's (`of_greedy`) and of the best known (`of_best_known`); of a learner also its
        `curve`, the area under it as mean distance over the practice (`mean_m`), the steps until it
        walks as far as a reference (`until_greedy`, `until_best_known`), and in a recovery the
        rewards of the following steps (`earned`). Distances of references are interquartile means.
    """
    references: dict[Any, dict[str, Any]] = {}
    for results in settings:
        reference = references.setdefault(
            results.conditions, {"best_known_m": results.best_known_m}
        )
        if results.setting.role == "reference" and results.total_m:
            agent, nominal = (
                results.setting.training.agent,
                results.setting.trial.plans_with is not None,
            )
            name = f"{agent.replace('-', '_')}{'_nominal' if nominal else ''}_m"
            reference[name] = iqm_interval((results.total_m,), seed).value
    return [
        _entry(results, references[results.conditions], seed, reached_share)
        for results in settings
        if results.total_m
    ]


def _plans_with(results: SettingResults) -> PlanningModel | None:
    trial = results.setting.trial
    lane = LaneConfig(agent=trial.training.agent, plans_with=trial.plans_with)
    return plans_with(lane, trial.training)


def _entry(
    results: SettingResults, reference: Mapping[str, Any], seed: int, share: float
) -> dict[str, Any]:
    greedy_m, best_m = reference.get("greedy_m"), reference["best_known_m"]
    practises = results.setting.role == "learner"
    return {
        "key": results.setting.key,
        "role": results.setting.role,
        **setting_fields(results),
        "plans_with": _plans_with(results),
        "n": len(results.total_m),
        "greedy_m": greedy_m,
        "greedy_nominal_m": reference.get("greedy_nominal_m"),
        "best_known_m": best_m,
        "distance": iqm_entry([results.total_m], seed),
        "of_greedy": _share_of(results.total_m, greedy_m, seed),
        "of_best_known": _share_of(results.total_m, best_m, seed),
        **(_practice(results, greedy_m, best_m, seed, share) if practises else _NO_PRACTICE),
    }


_NO_PRACTICE: Mapping[str, Any] = {
    "curve": None,
    "mean_m": None,
    "until_greedy": None,
    "until_best_known": None,
    "earned": None,
}


def _practice(
    results: SettingResults, greedy_m: float | None, best_m: float | None, seed: int, share: float
) -> dict[str, Any]:
    """Return curve, mean distance, steps until the references and earned rewards of a learner."""
    trial, walks = results.setting.trial, results.succeeded
    is_recovery = trial.earning_steps > 0
    begin = trial.evaluations[0] if is_recovery else 0
    steps = [step - begin for step in trial.evaluations]
    distances = [tuple(column) for column in zip(*(w.distances_m for w in walks), strict=True)]
    earned = [tuple(column) for column in zip(*(w.earned_m for w in walks), strict=True)]
    areas = tuple(mean_distance_m(steps, walk.distances_m) for walk in walks)
    return {
        "curve": {"steps": steps, **curve_entry(distances, seed)},
        "mean_m": iqm_entry([areas], seed),
        "until_greedy": _until(steps, distances, greedy_m, share),
        "until_best_known": _until(steps, distances, best_m, share),
        "earned": {"steps": steps, **curve_entry(earned, seed)} if is_recovery else None,
    }


def mean_distance_m(steps: Sequence[int], distances_m: Sequence[float]) -> float:
    """Return the area under a learning curve divided by its steps [m].

    The curve is linear between evaluations; one that is not evaluated at its start begins at 0 m.

    Args:
        steps: steps of practice at the evaluations, ascending.
        distances_m: distance at each [m].
    """
    if steps[0] > 0:
        steps, distances_m = [0, *steps], [0.0, *distances_m]
    area = float(np.trapezoid(distances_m, steps))
    return area / (steps[-1] - steps[0])


def steps_until(steps: Sequence[int], distances_m: Sequence[float], goal_m: float) -> float:
    """Return the steps at the first evaluation that reaches a distance; infinity if none does."""
    reached = (at for at, far_m in zip(steps, distances_m, strict=True) if far_m >= goal_m)
    return next(reached, math.inf)


def _until(
    steps: Sequence[int], distances: Curves, reference_m: float | None, share: float
) -> dict[str, Any] | None:
    """Return the median steps until a share of a reference; None if most seeds never get there."""
    if not distances or reference_m is None or reference_m < MIN_REFERENCE_M:
        return None
    goal_m = share * reference_m
    seeds = [steps_until(steps, walk, goal_m) for walk in zip(*distances, strict=True)]
    middle = median(seeds)
    reached = share_at_least([-until for until in seeds], -steps[-1])
    return {
        "of": share,
        "median_steps": None if math.isinf(middle) else middle,
        **reached.as_json("reached"),
    }


def _share_of(points: Points, reference_m: float | None, seed: int) -> dict[str, Any] | None:
    if reference_m is None or reference_m < MIN_REFERENCE_M:
        return None
    return iqm_entry([tuple(point / reference_m for point in points)], seed)
