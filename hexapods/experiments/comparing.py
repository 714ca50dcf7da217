"""Compares two groups of seeds: difference, probability of improvement, and seeds still missing.

The difference is that of the interquartile means, with its percentile bootstrap interval; seeds
that both groups have are resampled together. The method, and the probability of improvement, are
those of Agarwal et al., "Deep RL at the edge of the statistical precipice" (2021). A difference is
*settled* once its 95 % interval excludes 0 with `MIN_RESAMPLED` seeds or more.
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.experiments.comparison import Ahead, Compared, Comparison, Group, Outlook, Unit
from hexapods.experiments.config import MAX_SEEDS
from hexapods.experiments.statistics import (
    MIN_RESAMPLED,
    MIN_SEEDS,
    NORMAL_QUANTILE,
    Interval,
    iqm,
    percentile_limits,
    probability_ahead,
    resampled,
    share_ahead,
)

_POWER_QUANTILE = 0.8416212335729143
"""The 80 % quantile of the standard normal distribution, for `POWER`."""
_ROUNDING = 1e-12
"""Differences below this share of the interquartile means are rounding errors."""


class _Variance(NamedTuple):
    """Variance of an interquartile mean, which falls as its seeds grow in number."""

    of_mean: float
    seeds: int

    def with_further(self, seeds: int) -> float:
        return self.of_mean * self.seeds / (self.seeds + seeds)


def compare(
    a: Group,
    b: Group,
    rng: np.random.Generator,
    *,
    unit: Unit = "m",
    is_at_time_out: bool = False,
) -> Comparison:
    """Compare two groups of seeds; of groups with numbers of seeds, those in common.

    Args:
        a: the first group.
        b: the second group.
        rng: generator of the resampling.
        unit: of the points.
        is_at_time_out: whether they are distances at time-out.

    Raises:
        InvalidInput: if both have numbers of seeds, but none in common.
    """
    is_paired = a.numbers is not None and b.numbers is not None
    points_a, points_b = _pairs(a, b) if is_paired else (np.array(a.points), np.array(b.points))
    groups = [(a, points_a), (b, points_b)]
    fewest = min(
        (len(points) for group, points in groups if not group.is_deterministic), default=MAX_SEEDS
    )
    middles = float(iqm(points_a)), float(iqm(points_b))
    value = _without_rounding(middles[0] - middles[1], max(map(abs, middles)))
    probability = float(probability_ahead(points_a, points_b))
    of_groups = [Interval(middle) for middle in middles]
    difference, improvement = Interval(value), Interval(probability)
    variances: list[_Variance] = []
    if fewest >= MIN_SEEDS:
        *resampled_middles, probabilities = _resampled(points_a, points_b, rng, is_paired=is_paired)
        differences = resampled_middles[0] - resampled_middles[1]
        of_groups = list(map(_interval, middles, resampled_middles))
        difference = _interval(value, differences)
        improvement = _improvement(a, b, _interval(probability, probabilities))
        spreads = [differences] if is_paired else resampled_middles
        variances = [
            _Variance(float(np.var(spread)), len(points))
            for spread, (_, points) in zip(spreads, groups, strict=False)
        ]
    ahead = _ahead(difference, fewest)
    outlook, further = _outlook(value, fewest, variances, is_settled=ahead != "not established")
    compared = [
        Compared(group.name, middle, len(points), group.is_deterministic)
        for (group, points), middle in zip(groups, of_groups, strict=True)
    ]
    return Comparison(
        a=compared[0],
        b=compared[1],
        difference=difference,
        improvement=improvement,
        is_paired=is_paired,
        left_out=len(a.points) + len(b.points) - 2 * len(points_a) if is_paired else 0,
        ahead=ahead,
        outlook=outlook,
        further_seeds=further,
        unit=unit,
        is_at_time_out=is_at_time_out,
    )


def _pairs(a: Group, b: Group) -> tuple[FloatArray, FloatArray]:
    """Return the points of the seeds that both groups have, in the same order."""
    by_number_a = dict(zip(a.numbers or (), a.points, strict=True))
    by_number_b = dict(zip(b.numbers or (), b.points, strict=True))
    common = [number for number in by_number_a if number in by_number_b]
    if not common:
        raise InvalidInput(f"{a.name} and {b.name} have no seed in common")
    return (
        np.array([by_number_a[number] for number in common]),
        np.array([by_number_b[number] for number in common]),
    )


def _resampled(
    a: FloatArray, b: FloatArray, rng: np.random.Generator, *, is_paired: bool
) -> FloatArray:
    """Return the interquartile means of both and the probabilities of improvement, (3, n)."""

    def statistic(*samples: FloatArray, axis: int) -> FloatArray:
        if is_paired:
            places = samples[0].astype(np.int64)
            samples = (a[places], b[places])
        first, second = samples
        return np.stack(
            [iqm(first, axis), iqm(second, axis), probability_ahead(first, second, axis)]
        )

    strata = [np.arange(len(a), dtype=np.float64)] if is_paired else [a, b]
    return resampled(strata, statistic, rng)


def _interval(value: float, samples: FloatArray) -> Interval:
    low, high = percentile_limits(samples)
    scale = abs(value)
    return Interval(
        value, _without_rounding(float(low), scale), _without_rounding(float(high), scale)
    )


def _without_rounding(value: float, scale: float) -> float:
    return value if abs(value) > _ROUNDING * scale else 0.0


def _improvement(a: Group, b: Group, bootstrapped: Interval) -> Interval:
    """Return the probability of improvement: a share of seeds where one group throws no dice."""
    if a.is_deterministic == b.is_deterministic:
        return bootstrapped
    if b.is_deterministic:
        return share_ahead(a.points, b.points[0])
    value, low, high = share_ahead(b.points, a.points[0])
    return Interval(1 - value, None if high is None else 1 - high, None if low is None else 1 - low)


def _ahead(difference: Interval, fewest: int) -> Ahead:
    """Return the group that is ahead, as far as the interval decides it."""
    if fewest < MIN_RESAMPLED:
        return "not established"
    if difference.exceeds(0) == "yes":
        return "a"
    return "b" if difference.exceeds(0) == "no" else "not established"


def _outlook(
    value: float, fewest: int, variances: Sequence[_Variance], *, is_settled: bool
) -> tuple[Outlook, int | None]:
    """Return what further seeds would bring, and how many settle the difference.

    The standard error of the difference falls with the root of the number of seeds. The difference
    is settled with a chance of `POWER` once it is 2.8 standard errors: the quantile of its interval
    and that of the chance, since the next seeds move the difference as well.

    Args:
        value: the difference.
        fewest: number of seeds in the smallest group.
        variances: of the interquartile means, by the bootstrap; of their difference if paired.
        is_settled: whether the difference is settled already.
    """
    if is_settled:
        return "settled", 0
    if not variances:
        return "too few seeds", None
    if value == 0:
        return "equal", None
    enough = (value / (NORMAL_QUANTILE + _POWER_QUANTILE)) ** 2
    numbers = range(max(1, MIN_RESAMPLED - fewest), MAX_SEEDS - max(v.seeds for v in variances) + 1)

    def is_enough(further: int) -> bool:
        return math.fsum(variance.with_further(further) for variance in variances) <= enough

    place = bisect_left(numbers, True, key=is_enough)
    return ("reachable", numbers[place]) if place < len(numbers) else ("out of reach", None)
