"""Statistics over many seeds: interquartile means, bootstrap intervals, probability of improvement.

Shares of seeds have Wilson intervals. The method is that of Agarwal et al., "Deep RL at the edge
of the statistical precipice" (2021). NumPy alone computes it, to the same bits as `scipy.stats`:
SciPy takes more room than all else that the product needs.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from hexapods.domain.types import FloatArray

Verdict = Literal["yes", "no", "not established"]
Points = tuple[float, ...]
"""One number per seed."""

CONFIDENCE = 0.95
RESAMPLES = 2_000
MIN_SEEDS = 3
"""With fewer seeds there is no interval, so that every verdict is "not established"."""
MIN_RESAMPLED = 5
"""With fewer seeds a bootstrap interval is shown, but decides nothing: it is much too narrow."""
_MAX_BATCH_NUMBERS = 4_000_000
_CACHE_SIZE = 20_000
_TRIMMED = 0.25
"""Share of the samples that an interquartile mean drops at each end."""
NORMAL_QUANTILE = 1.959963984540054
"""The 97.5 % quantile of the standard normal distribution, for `CONFIDENCE` of 95 %."""


class Interval(NamedTuple):
    """A point estimate and its confidence interval; no limits where there are too few seeds."""

    value: float
    low: float | None = None
    high: float | None = None

    def as_json(self, name: str, unit: str = "") -> dict[str, Any]:
        """Return the interval as an entry of a summary; `unit`, such as `_m`, ends all names."""
        return {f"{name}{unit}": self.value, f"low{unit}": self.low, f"high{unit}": self.high}

    @classmethod
    def of(cls, entry: "Interval | Mapping[str, Any]") -> "Interval":
        """Return an interval, read from an entry of a summary if it is one."""
        if isinstance(entry, Interval):
            return entry
        unit = "_m" if "low_m" in entry else ""
        names = (f"{name}{unit}" for name in ("probability", "share", "iqm"))
        value = next(entry[name] for name in names if name in entry)
        return cls(value, entry[f"low{unit}"], entry[f"high{unit}"])

    def __neg__(self) -> "Interval":
        """Return the interval of the negated value, to test whether it is below a threshold."""
        low, high = self.low, self.high
        if low is None or high is None:
            return Interval(-self.value)
        return Interval(-self.value, -high, -low)

    def exceeds(self, threshold: float) -> Verdict:
        """Whether the value is over a threshold: decided only if the interval excludes it."""
        if self.low is None or self.high is None:
            return "not established"
        if self.low > threshold:
            return "yes"
        return "no" if self.high < threshold else "not established"


def iqm(samples: FloatArray, axis: int = -1) -> FloatArray:
    """Return the interquartile mean along an axis.

    A quarter of the samples, rounded down, is trimmed at each end; of three samples or fewer none
    is, so that it is their mean.

    Args:
        samples: (…, n, …).
        axis: the axis of the n seeds, which is reduced.
    """
    rows = np.moveaxis(np.asarray(samples, dtype=np.float64), axis, -1)
    n = rows.shape[-1]
    cut = int(_TRIMMED * n)
    partitioned = np.partition(rows, (cut, n - cut - 1), axis=-1)
    return np.asarray(partitioned[..., cut : n - cut].mean(axis=-1), dtype=np.float64)


def pooled_iqm(*samples: FloatArray, axis: int = -1) -> FloatArray:
    """Return the interquartile mean over all strata concatenated along the axis."""
    return iqm(np.concatenate(samples, axis=axis), axis)


@lru_cache(maxsize=_CACHE_SIZE)
def iqm_interval(strata: tuple[Points, ...], seed: int) -> Interval:
    """Return the interquartile mean of all points with its stratified bootstrap interval.

    Args:
        strata: resampled separately; for example the seeds of each gait.
        seed: seed of the resampling.
    """
    return interval(strata, pooled_iqm, seed)


def interval(
    strata: Sequence[Points],
    statistic: Callable[..., FloatArray],
    seed: int,
    confidence: float = CONFIDENCE,
) -> Interval:
    """Return a statistic with its stratified bootstrap percentile interval.

    Args:
        strata: resampled separately.
        statistic: function of one array (…, n) per stratum and the `axis` of the seeds, to (…).
        seed: seed of the resampling.
        confidence: confidence level of the interval.

    Returns:
        The value without limits if a stratum has fewer than `MIN_SEEDS` points.
    """
    arrays = [np.asarray(points, dtype=np.float64) for points in strata]
    value = float(statistic(*arrays))
    if min(len(points) for points in strata) < MIN_SEEDS:
        return Interval(value)
    ascending = np.sort(resampled(arrays, statistic, seed))
    tail = (1 - confidence) / 2
    return Interval(value, _quantile(ascending, tail), _quantile(ascending, 1 - tail))


def resampled(
    strata: Sequence[FloatArray],
    statistic: Callable[..., FloatArray],
    seed: int | np.random.Generator,
) -> FloatArray:
    """Return a statistic of `RESAMPLES` stratified resamples, (…, RESAMPLES).

    Args:
        strata: resampled separately.
        statistic: as in `interval`.
        seed: seed of the resampling, or the generator of its random numbers.
    """
    rng = np.random.default_rng(seed)
    batch = max(1, _MAX_BATCH_NUMBERS // sum(len(points) for points in strata))
    batches = []  # each fits into memory
    for first in range(0, RESAMPLES, batch):
        count = min(batch, RESAMPLES - first)
        samples = (points[rng.integers(0, len(points), (count, len(points)))] for points in strata)
        batches.append(statistic(*samples, axis=-1))
    return np.concatenate(batches, axis=-1)


def _quantile(ascending: FloatArray, probability: float) -> float:
    """Return a quantile of sorted numbers (n,), by linear interpolation (Hyndman and Fan, 7)."""
    n = len(ascending)
    place = probability * n + (1 - probability)
    below, fraction = int(place // 1) - 1, place % 1
    upper = ascending[min(below + 1, n - 1)]
    return float((1 - fraction) * ascending[below] + fraction * upper)


def paired_interval(
    strata: Sequence[FloatArray], statistic: Callable[[FloatArray], FloatArray], seed: int
) -> Interval:
    """Return the bootstrap interval of a function of several interquartile means, paired by seed.

    Args:
        strata: (k, n) each: k numbers for each of n seeds; the k numbers of a seed are resampled
            together.
        statistic: function of the k interquartile means over all seeds, (k, …), to (…).
        seed: seed of the resampling.
    """

    def of_seeds(*chosen: FloatArray, axis: int = -1) -> FloatArray:
        resampled = [
            numbers[:, seeds.astype(np.int64)]
            for numbers, seeds in zip(strata, chosen, strict=True)
        ]
        return statistic(iqm(np.concatenate(resampled, axis=axis), axis))

    return interval(
        [tuple(map(float, range(numbers.shape[1]))) for numbers in strata], of_seeds, seed
    )


def resampled_iqms(points: FloatArray, seed: int) -> FloatArray:
    """Return interquartile means of k series over the same resamples of the n seeds.

    A percentile interval of a row is that of `iqm_interval`, and one of the difference of two rows
    that of `paired_interval`, up to rounding; but the seeds are resampled once for all.

    Args:
        points: (k, n).
        seed: seed of the resampling.

    Returns:
        (k, RESAMPLES).
    """
    n = points.shape[1]
    chosen = np.random.default_rng(seed).integers(0, n, (RESAMPLES, n))
    return np.array([iqm(series[chosen]) for series in points]).reshape(-1, RESAMPLES)


def percentile_limits(resampled: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lower and upper limits of percentile intervals along the last axis."""
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(resampled, [tail, 1 - tail], axis=-1)
    return low, high


@lru_cache(maxsize=_CACHE_SIZE)
def share(hits: int, of: int, ties: int = 0) -> Interval:
    """Return a share of seeds with its Wilson interval; a tie counts half.

    Ties count as misses for the lower limit and as hits for the upper limit.

    Args:
        hits: number of seeds that meet the condition.
        of: number of seeds.
        ties: number of seeds exactly at the limit, not included in `hits`.
    """
    value = (hits + ties / 2) / of
    if of < MIN_SEEDS:
        return Interval(value)
    return Interval(value, _wilson(hits, of)[0], _wilson(hits + ties, of)[1])


def share_ahead(points: Sequence[float], baseline: float) -> Interval:
    """Return the probability that a seed exceeds a constant baseline; a tie counts half."""
    return share(
        sum(point > baseline for point in points),
        len(points),
        sum(point == baseline for point in points),
    )


def share_at_least(points: Sequence[float], limit: float) -> Interval:
    """Return the share of seeds that reach a limit."""
    return share(sum(point >= limit for point in points), len(points))


@lru_cache(maxsize=_CACHE_SIZE)
def improvement(
    a: tuple[Points, ...], b: tuple[Points, ...], seed: int, confidence: float = CONFIDENCE
) -> Interval:
    """Return the probability of improvement of `a` over `b`, averaged over strata.

    The probability that a random seed of `a` exceeds a random seed of `b` (Agarwal et al. 2021).

    Args:
        a: strata of the first agent.
        b: the same strata of the second agent.
        seed: seed of the resampling.
        confidence: confidence level of the interval.
    """

    def mean_probability(*samples: FloatArray, axis: int = -1) -> FloatArray:
        pairs = zip(samples[: len(a)], samples[len(a) :], strict=True)
        probabilities = [probability_ahead(pair_a, pair_b, axis) for pair_a, pair_b in pairs]
        return np.asarray(np.mean(probabilities, axis=0), dtype=np.float64)

    return interval((*a, *b), mean_probability, seed, confidence)


def quantile_of(published: float, points: Sequence[float]) -> float:
    """Return the share of seeds below a published value; a seed equal to it counts half."""
    samples = np.asarray(points)
    halves = np.count_nonzero(samples < published) + np.count_nonzero(samples <= published)
    # Rounded as a percentage, which the reports that exist have.
    return float(halves * (50.0 / len(points))) / 100.0


def bootstrap_exceeds(estimate: Interval, threshold: float, fewest: int) -> Verdict:
    """Return `Interval.exceeds` for a bootstrap interval, if it has enough seeds to decide.

    Args:
        estimate: the bootstrap interval.
        threshold: threshold to compare with.
        fewest: number of seeds in the smallest stratum; below `MIN_RESAMPLED` nothing is decided.
    """
    return estimate.exceeds(threshold) if fewest >= MIN_RESAMPLED else "not established"


def probability_ahead(a: FloatArray, b: FloatArray, axis: int = -1) -> FloatArray:
    """Return P(a > b) + P(a = b)/2 along an axis, by the Mann-Whitney U statistic."""
    n, m = a.shape[axis], b.shape[axis]
    ranks = _ranks(np.moveaxis(np.concatenate([a, b], axis=axis), axis, -1))
    over = ranks[..., :n].sum(axis=-1) - n * (n + 1) / 2
    return np.asarray(over / (n * m), dtype=np.float64)


def _ranks(samples: FloatArray) -> FloatArray:
    """Return the ranks along the last axis, from 1; equal numbers share the mean of theirs."""
    order = np.argsort(samples, axis=-1)
    ascending = np.take_along_axis(samples, order, axis=-1)
    places = np.broadcast_to(np.arange(samples.shape[-1]), samples.shape)
    edge = np.ones((*samples.shape[:-1], 1), dtype=bool)
    changes = ascending[..., 1:] != ascending[..., :-1]
    begins, ends = (np.concatenate(parts, axis=-1) for parts in ((edge, changes), (changes, edge)))
    first = np.maximum.accumulate(np.where(begins, places, 0), axis=-1)
    last = np.where(ends, places, samples.shape[-1])[..., ::-1]
    last = np.minimum.accumulate(last, axis=-1)[..., ::-1]
    ranks = np.empty(samples.shape)
    np.put_along_axis(ranks, order, (first + last) / 2 + 1, axis=-1)
    return ranks


def _wilson(hits: int, of: int) -> tuple[float, float]:
    """Return the limits of the Wilson interval of a share (Newcombe 1998, method 3)."""
    share_of_hits, z = hits / of, NORMAL_QUANTILE
    denominator = 2 * (of + z**2)
    center = (2 * of * share_of_hits + z**2) / denominator
    delta = z / denominator * math.sqrt(4 * of * share_of_hits * (1 - share_of_hits) + z**2)
    return (
        center - delta if hits > 0 else 0.0,
        center + delta if hits < of else 1.0,
    )
