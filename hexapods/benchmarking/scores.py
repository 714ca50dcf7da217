"""Scores of a benchmark: shares of best known, their interquartile means and intervals.

The method is that of Agarwal et al., "Deep RL at the edge of the statistical precipice" (2021):
interquartile means over all runs, intervals by a bootstrap that resamples the seeds within each
task, and performance profiles.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.protocol import BestKnown
from hexapods.benchmarking.runs import BenchmarkResult, BenchmarkRun, TaskPlan
from hexapods.domain.records import to_json
from hexapods.domain.types import FloatArray
from hexapods.experiments.statistics import Interval, interval, iqm

PROFILE_AT = tuple(round(0.05 * step, 2) for step in range(23))
"""Scores τ of the performance profile: the share of runs that score at least as much."""
_RESAMPLING_SEED = 0


def score_of(distance_m: float, best_known_m: float) -> float:
    """Return the score of a run: its share of best known, and 0 of one that walked backwards.

    It is not cut above 1: a run that exceeds best known shows it.

    Args:
        distance_m: of the run [m].
        best_known_m: of its task [m].
    """
    return max(0.0, distance_m / best_known_m) if best_known_m > 0 else 0.0


def scores_of(
    config: BenchmarkConfig,
    plans: Sequence[TaskPlan],
    results: Mapping[BenchmarkRun, BenchmarkResult],
    best_known: Mapping[str, BestKnown | str],
) -> dict[str, Any]:
    """Return the tasks with their scores, and the aggregate, as a score file has them.

    Args:
        config: the benchmark.
        plans: its tasks.
        results: of all of its runs.
        best_known: by task; in place of one that could not be found the reason, and then each run
            of the task scores 0.
    """
    tasks, strata = [], []
    for plan in plans:
        name = plan.task.name
        of_task = [
            [results[BenchmarkRun(name, budget, number)] for number in range(config.seeds)]
            for budget in config.budgets
        ]
        best = best_known[name]
        best_m = best.distance_m if isinstance(best, BestKnown) else None
        scores = np.array(
            [[score_of(run.distance_m, best_m or 0.0) for run in row] for row in of_task]
        )  # (budgets, seeds)
        strata.append(scores)
        tasks.append(
            {
                "name": name,
                "title": plan.task.title,
                **_entry(_iqm([scores])),
                "best_known_m": best_m,
                "found_by": best.found_by if isinstance(best, BestKnown) else None,
                "errors": _errors(config, of_task, best),
                "walk": to_json(plan.walk),
                "budgets": [
                    {
                        "steps": budget,
                        **_entry(_iqm([scores[[place]]])),
                        "distances_m": [run.distance_m for run in of_task[place]],
                        "scores": scores[place].tolist(),
                    }
                    for place, budget in enumerate(config.budgets)
                ],
            }
        )
    return {"tasks": tasks, "aggregate": _aggregate(config, strata)}


def _aggregate(config: BenchmarkConfig, strata: Sequence[FloatArray]) -> dict[str, Any]:
    of_budgets = [
        {"steps": budget, **_entry(_iqm([scores[[place]] for scores in strata]))}
        for place, budget in enumerate(config.budgets)
    ]
    profile = [{"at": at, **_entry(_share_at_least(strata, at), "share")} for at in PROFILE_AT]
    return {**_entry(_iqm(strata)), "budgets": of_budgets, "profile": profile}


def _errors(
    config: BenchmarkConfig, of_task: Sequence[Sequence[BenchmarkResult]], best: BestKnown | str
) -> list[dict[str, Any]]:
    """Return why runs failed: steps, number of the seed, and the error; both None for the task."""
    errors: list[dict[str, Any]] = [
        {"steps": budget, "seed": number, "error": run.error}
        for budget, row in zip(config.budgets, of_task, strict=True)
        for number, run in enumerate(row)
        if run.error is not None
    ]
    if isinstance(best, str):
        errors.append({"steps": None, "seed": None, "error": f"best known: {best}"})
    return errors


def _entry(estimate: Interval, name: str = "score") -> dict[str, Any]:
    """Return an estimate as a score file has it; no interval of fewer than three seeds."""
    limits = None if estimate.low is None else [estimate.low, estimate.high]
    return {name: estimate.value, "interval": limits}


def _iqm(strata: Sequence[FloatArray]) -> Interval:
    """Return the interquartile mean of all runs; the seeds are resampled within each task.

    The budgets of a seed are resampled together, since they walk with the same robot.

    Args:
        strata: of each task (budgets, seeds).
    """

    def of_seeds(*chosen: FloatArray, axis: int = -1) -> FloatArray:
        del axis  # it is the last one
        runs = [
            np.moveaxis(scores[:, seeds.astype(np.int64)], 0, -1)  # (…, seeds, budgets)
            for scores, seeds in zip(strata, chosen, strict=True)
        ]
        flat = [scores.reshape(*scores.shape[:-2], -1) for scores in runs]
        return iqm(np.concatenate(flat, axis=-1))

    numbers = [tuple(map(float, range(scores.shape[1]))) for scores in strata]
    return interval(numbers, of_seeds, _RESAMPLING_SEED)


def _share_at_least(strata: Sequence[FloatArray], limit: float) -> Interval:
    """Return the share of all runs that score at least as much, resampled as by `_iqm`."""

    def mean(*reached: FloatArray, axis: int = -1) -> FloatArray:
        return np.asarray(
            np.mean([shares.mean(axis=axis) for shares in reached], axis=0), dtype=np.float64
        )

    reached = [
        tuple((scores >= limit).mean(axis=0).tolist()) for scores in strata
    ]  # of each seed the share of its budgets
    return interval(reached, mean, _RESAMPLING_SEED)
