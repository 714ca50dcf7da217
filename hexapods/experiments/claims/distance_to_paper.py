"""Compare cases by the distance of their results to the paper's printed numbers."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hexapods.domain.types import FloatArray
from hexapods.experiments.claims.cases import PAPERS_AGENT, Case
from hexapods.experiments.statistics import (
    CONFIDENCE,
    Interval,
    Points,
    Verdict,
    bootstrap_exceeds,
    interval,
    iqm,
    quantile_of,
)


class _Printed(NamedTuple):
    gait: str
    steps: int
    total_m: float
    points: Points


class Closeness(NamedTuple):
    """Agreement of a case with the printed total distances of Q-learning.

    Attributes:
        case: the case.
        inside: number of printed values within the central 95 % of our seeds.
        compared: number of printed values.
        mean_error_m: mean absolute difference of our interquartile mean and the printed value.
    """

    case: Case
    inside: int
    compared: int
    mean_error_m: float


def closeness(case: Case) -> Closeness | None:
    """Return a case's agreement; None if nothing was printed of it or a setting has no trials."""
    printed = _printed(case)
    if not printed:
        return None
    tail = (1 - CONFIDENCE) / 2
    inside = sum(
        tail <= quantile_of(setting.total_m, setting.points) <= 1 - tail for setting in printed
    )
    apart = _mean_error([np.asarray(setting.points) for setting in printed], printed, -1)
    return Closeness(case, inside, len(printed), float(apart))


def compare_closeness(a: Case, b: Case) -> tuple[Verdict, Interval] | None:
    """Test whether `a` is closer to the printed values than `b`.

    Returns:
        The verdict, and the difference of their mean errors with its interval [m], positive if `a`
        is closer; None if the two cannot be compared. The interval covers the variation of our
        seeds only, not that each printed value is a single run.
    """
    samples_a, samples_b = _printed(a), _printed(b)
    if not samples_a or len(samples_a) != len(samples_b):
        return None

    def difference(*samples: FloatArray, axis: int = -1) -> FloatArray:
        values_a, values_b = samples[: len(samples_a)], samples[len(samples_a) :]
        return _mean_error(values_b, samples_b, axis) - _mean_error(values_a, samples_a, axis)

    estimate = interval(
        [setting.points for setting in (*samples_a, *samples_b)], difference, a.seed
    )
    fewest = min(len(setting.points) for setting in (*samples_a, *samples_b))
    return bootstrap_exceeds(estimate, 0, fewest), estimate


def _printed(case: Case) -> list[_Printed]:
    """Return Q-learning's settings that the paper also has; none unless all have trials."""
    learners = [
        setting
        for setting in case.settings
        if setting["agent"] == PAPERS_AGENT and setting["published"]
    ]
    if not all(setting["n"] for setting in learners):
        return []
    return [
        _Printed(
            setting["gait"],
            setting["steps"],
            setting["published"]["total_m"],
            tuple(setting["total"]["points_m"]),
        )
        for setting in learners
    ]


def _mean_error(
    samples: Sequence[FloatArray], printed: Sequence[_Printed], axis: int
) -> FloatArray:
    """Return the mean absolute difference of printed values and interquartile means [m]."""
    each = [
        np.abs(iqm(points, axis) - setting.total_m)
        for points, setting in zip(samples, printed, strict=True)
    ]
    return np.asarray(np.mean(each, axis=0), dtype=np.float64)
