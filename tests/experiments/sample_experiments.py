"""Experiments with results: simulated by the kinematic simulator, or with made-up distances."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from hexapods.domain.robot import robot
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.plan import Plan, TrialSetting
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import TrialResult, run_trial

Results = dict[str, TrialResult]
GREEDY_M = 0.5
ROBOTS = (robot("stiff"), robot("compliant"))


def config(experiment: str, **options: Any) -> ExperimentConfig:
    return experiment_config(experiment, {"simulator": "kinematic", **options})


@cache
def walked(experiment: str, seeds: int, **options: Any) -> tuple[ExperimentConfig, Results]:
    """Run an experiment; cached, so that it is run once per test session."""
    tried = config(experiment, seeds=seeds, **options)
    return tried, {trial.key: run_trial(trial.config) for trial in Plan(tried).trials()}


def around(middle_m: float, spread_m: float = 0.02) -> Callable[[int], float]:
    """Return a function from seed number to a distance that varies about a middle."""
    return lambda number: middle_m + spread_m * float(np.sin(1 + 7 * number))


def alpha_of(setting: TrialSetting) -> float:
    """Return the learning rate of a setting whose agent has one."""
    alpha = setting.training.settings["alpha"]
    assert isinstance(alpha, float)
    return alpha


def sample_results(
    tried: ExperimentConfig, distance_m: Callable[[TrialSetting], Callable[[int], float]]
) -> Results:
    """Make up results in which each seed covers the given distance, and greedy half a metre.

    Greedy is at 0.36 m at time-out. With several blocks, a learner's distance after n blocks is
    1 − 0.5ⁿ of its final one; in a league or recovery it is the same from the first evaluation on.
    """
    results: Results = {}
    for trial in Plan(tried).trials():
        role, agent = trial.setting.role, trial.setting.training.agent
        if role == "learner":
            far_m = distance_m(trial.setting)(trial.seed_number)
            blocks = trial.config.blocks
            shares = [1.0] if blocks == 1 else [1 - 0.5**block for block in range(1, blocks + 1)]
            shares *= len(trial.config.evaluations) or 1
            results[trial.key] = TrialResult(
                distances_m=tuple(far_m * share for share in shares),
                finished_distance_m=far_m if blocks == 1 else None,
                elapsed_s=16.0 if blocks == 1 else None,
            )
        elif role == "reference":
            finished_m, elapsed_s = (0.36, 21.8) if agent == "greedy" else (0.08, 91.0)
            results[trial.key] = TrialResult(
                distances_m=(GREEDY_M,), finished_distance_m=finished_m, elapsed_s=elapsed_s
            )
        else:
            wall = [
                {"agent": name, "decision_s": s, "finished_distance_m": m, "elapsed_s": 16 + s}
                for name, s, m in (
                    ("q-learning", 0.001, 0.3),
                    ("greedy", 0.9, 0.4),
                    ("two-step", 8.0, 0.2),
                )
            ]
            ranked = tuple(
                {**lane, "rank": rank} for lane, rank in zip(wall, (2, 1, 3), strict=True)
            )
            results[trial.key] = TrialResult(distances_m=(0.3,), wall=ranked)
    return results


def summary_of(
    experiment: str, distance_m: Callable[[TrialSetting], Callable[[int], float]], **options: Any
) -> dict[str, Any]:
    """Summarise a made-up experiment."""
    tried = config(experiment, **options)
    return summarise(tried, sample_results(tried, distance_m))


def setting(summary: dict[str, Any], key: str) -> dict[str, Any]:
    """Return a setting's entry of a summary."""
    return next(entry for entry in summary["settings"] if entry["key"] == key)


def claim(summary: dict[str, Any], name: str) -> dict[str, Any]:
    """Return a claim of a summary."""
    return next(entry for entry in summary["claims"] if entry["id"] == name)
