"""What many seeds say together: middle values with intervals, shares, and probabilities."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy import stats

from app.domain.types import FloatArray

Verdict = Literal["yes", "no", "not established"]
Points = tuple[float, ...]
"""One number a seed."""

CONFIDENCE = 0.95
RESAMPLES = 2_000
MIN_SEEDS = 3
"""With fewer there is no interval, and so nothing is established."""
MIN_RESAMPLED = 5
"""With fewer a bootstrap shows a spread, but decides nothing: it is much too narrow."""
_BATCH_NUMBERS = 4_000_000
_REMEMBERED = 20_000
_PERCENT = 100.0


class Interval(NamedTuple):
    """A middle value and its 95 % interval; without limits where there are too few seeds."""

    value: float
    low: float | None = None
    high: float | None = None

    def __neg__(self) -> "Interval":
        """Of the negative number: to ask whether something is under a threshold."""
        low, high = self.low, self.high
        if low is None or high is None:
            return Interval(-self.value)
        return Interval(-self.value, -high, -low)

    def against(self, threshold: float) -> Verdict:
        """Whether the value is over a threshold, as far as the interval says."""
        if self.low is None or self.high is None:
            return "not established"
        if self.low > threshold:
            return "yes"
        return "no" if self.high < threshold else "not established"


def iqm(samples: FloatArray, axis: int = -1) -> FloatArray:
    """The interquartile mean: a quarter is cut off at each end, rounded down.

    Of three numbers or fewer nothing is cut off, so that it is their mean.
    """
    return np.asarray(stats.trim_mean(samples, 0.25, axis=axis), dtype=np.float64)


def iqm_of_all(*samples: FloatArray, axis: int = -1) -> FloatArray:
    """The interquartile mean over all strata together."""
    return iqm(np.concatenate(samples, axis=axis), axis)


@lru_cache(maxsize=_REMEMBERED)
def iqm_interval(strata: tuple[Points, ...], seed: int) -> Interval:
    """The interquartile mean of all points, resampled within each stratum.

    Args:
        strata: for example the seeds of each gait.
        seed: of the resampling.
    """
    return interval(strata, iqm_of_all, seed)


def interval(
    strata: Sequence[Points],
    statistic: Callable[..., FloatArray],
    seed: int,
    confidence: float = CONFIDENCE,
) -> Interval:
    """A statistic with its stratified bootstrap percentile interval.

    Args:
        strata: resampled each on its own.
        statistic: from one array (…, n) a stratum, and the `axis` of the seeds, to (…).
        seed: of the resampling.
        confidence: of the interval.
    """
    arrays = [np.asarray(points, dtype=np.float64) for points in strata]
    value = float(statistic(*arrays))
    if min(len(points) for points in strata) < MIN_SEEDS:
        return Interval(value)
    found = stats.bootstrap(
        arrays,
        statistic,
        n_resamples=RESAMPLES,
        batch=max(1, _BATCH_NUMBERS // sum(len(points) for points in strata)),
        confidence_level=confidence,
        method="percentile",
        vectorized=True,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return Interval(value, float(found.low), float(found.high))


def paired_interval(
    strata: Sequence[FloatArray], statistic: Callable[[FloatArray], FloatArray], seed: int
) -> Interval:
    """The interval of a number that is made of several middles over the same seeds.

    Args:
        strata: (k, n) each: k numbers for each of n seeds, which are resampled together.
        statistic: from the k interquartile means over all seeds, (k, …), to (…).
        seed: of the resampling.
    """

    def of_seeds(*chosen: FloatArray, axis: int = -1) -> FloatArray:
        taken = [
            numbers[:, seeds.astype(np.int64)]
            for numbers, seeds in zip(strata, chosen, strict=True)
        ]
        return statistic(iqm(np.concatenate(taken, axis=axis), axis))

    return interval([tuple(map(float, range(one.shape[1]))) for one in strata], of_seeds, seed)


@lru_cache(maxsize=_REMEMBERED)
def share(hits: int, of: int, ties: int = 0) -> Interval:
    """A share of seeds with its Wilson interval; a tie counts half.

    The interval takes ties as misses at its low end and as hits at its high end.
    """
    value = (hits + ties / 2) / of
    if of < MIN_SEEDS:
        return Interval(value)
    return Interval(value, _wilson(hits, of).low, _wilson(hits + ties, of).high)


def ahead(points: Sequence[float], baseline: float) -> Interval:
    """How likely a seed comes further than a rival who always comes as far; a tie counts half."""
    return share(
        sum(point > baseline for point in points),
        len(points),
        sum(point == baseline for point in points),
    )


def at_least(points: Sequence[float], limit: float) -> Interval:
    """The share of seeds that come this far."""
    return share(sum(point >= limit for point in points), len(points))


@lru_cache(maxsize=_REMEMBERED)
def improvement(
    a: tuple[Points, ...], b: tuple[Points, ...], seed: int, confidence: float = CONFIDENCE
) -> Interval:
    """How likely a seed of `a` comes further than one of `b`: the mean over strata.

    As in Agarwal et al., "Deep RL at the edge of the statistical precipice" (2021).

    Args:
        a: strata of the one.
        b: the same strata of the other.
        seed: of the resampling.
        confidence: of the interval.
    """

    def mean_probability(*samples: FloatArray, axis: int = -1) -> FloatArray:
        pairs = zip(samples[: len(a)], samples[len(a) :], strict=True)
        found = [_probability(one, other, axis) for one, other in pairs]
        return np.asarray(np.mean(found, axis=0), dtype=np.float64)

    return interval((*a, *b), mean_probability, seed, confidence)


def quantile_of(published: float, points: Sequence[float]) -> float:
    """Which share of the seeds lies under a published value; one that equals it counts half."""
    return float(stats.percentileofscore(points, published, kind="mean")) / _PERCENT


def decided(found: Interval, threshold: float, fewest: int) -> Verdict:
    """`Interval.against`, for a bootstrap of which the smallest stratum has so many seeds."""
    return found.against(threshold) if fewest >= MIN_RESAMPLED else "not established"


def _probability(a: FloatArray, b: FloatArray, axis: int) -> FloatArray:
    """P(a > b) + P(a = b)/2 along an axis, from the ranks of both together."""
    n, m = a.shape[axis], b.shape[axis]
    ranks = stats.rankdata(np.concatenate([a, b], axis=axis), axis=axis)
    over = np.take(ranks, range(n), axis=axis).sum(axis=axis) - n * (n + 1) / 2
    return np.asarray(over / (n * m), dtype=np.float64)


def _wilson(hits: int, of: int) -> Any:
    return stats.binomtest(hits, of).proportion_ci(confidence_level=CONFIDENCE, method="wilson")
