"""Trials of an experiment as rows of a table, one row a trial."""

from collections.abc import Iterator, Mapping
from typing import Any

from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.trial import TrialResult


def trial_rows(
    config: ExperimentConfig, results: Mapping[str, TrialResult], set_aside: Mapping[str, str]
) -> Iterator[dict[str, Any]]:
    """Yield a row for each completed and each set-aside trial, in the plan's order.

    Its `distance_m` is the distance after all its practice; a trial that walks several times also
    has `distance_after_250_m` and so on, by the steps of practice before.

    Args:
        config: the experiment.
        results: results by trial key.
        set_aside: reasons by trial key, of trials without a result.
    """
    for trial in Plan(config).trials():
        if trial.key in results:
            yield _row(trial, results[trial.key])
        elif trial.key in set_aside:
            yield _row(trial, TrialResult(failure=f"set aside: {set_aside[trial.key]}"))


def _row(trial: Trial, result: TrialResult) -> dict[str, Any]:
    setting, training, distances_m = trial.setting, trial.setting.training, result.distances_m
    named = setting.fields
    first = ("agent", "gait", "world", "robot", "observation")
    walks = {
        f"distance_after_{practised_steps(trial, number)}_m": distance_m
        for number, distance_m in enumerate(distances_m)
        if len(distances_m) > 1
    }
    return {
        "trial": trial.key,
        "role": setting.role,
        **{name: named.pop(name) for name in first},
        "simulator": training.simulator,
        "tolerance": training.tolerance,
        "reward": training.reward,
        "plans_with": setting.trial.plans_with,
        **named,
        "seed_number": trial.seed_number,
        "seed": trial.seed,
        "distance_m": distances_m[-1] if distances_m else None,
        **walks,
        "finished_distance_m": result.finished_distance_m,
        "elapsed_s": result.elapsed_s,
        "transitions": result.transitions,
        "failure": result.failure,
    }


def practised_steps(trial: Trial, number: int) -> int:
    """Return the steps of practice before one of a trial's distances."""
    return 0 if trial.setting.role == "reference" else trial.setting.walks_after[number]
