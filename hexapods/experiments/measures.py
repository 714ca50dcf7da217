"""Measures over the seeds of one or more settings, as plain types fit for JSON."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any

from hexapods.experiments.published import Published
from hexapods.experiments.statistics import (
    MIN_SEEDS,
    Interval,
    Points,
    iqm_interval,
    quantile_of,
    share_ahead,
    share_at_least,
)

WALKER_SHARE = 0.5
"""Share of greedy's total distance from which a seed counts as a walker."""
REACHED_SHARE = 0.95
"""Share of a reference's distance from which a seed counts as having reached that reference."""


@dataclass(frozen=True)
class ReferenceDistance:
    """Greedy's distances under the same conditions, and the best known one [m].

    Attributes:
        total_m: greedy's after its 50 steps; None if there is no result, or greedy hardly moved.
        finished_m: greedy's at time-out, when the first lane has used its 50 steps; None likewise.
        best_known_m: the best known distance of 50 steps; None where none was computed.
    """

    total_m: float | None = None
    finished_m: float | None = None
    best_known_m: float | None = None


@dataclass(frozen=True)
class Stratum:
    """One stratum of the bootstrap: the seeds of one setting, without failed trials.

    Attributes:
        total_m: each seed's distance over 50 steps, after the last block of practice [m].
        finished_m: each seed's distance at time-out, when the first lane has used its 50 steps
            [m]; empty if no race was simulated.
        reference: the reference distances under the same conditions.
    """

    total_m: Points
    finished_m: Points
    reference: ReferenceDistance


def measure_against_references(strata: Sequence[Stratum], seed: int) -> dict[str, Any]:
    """Compute all measures relative to greedy and to the best known, over the seeds of all strata.

    Args:
        strata: one setting, or one for each gait; strata without seeds are ignored.
        seed: seed of the bootstrap's resampling.

    Returns:
        Interquartile means of the shares of greedy's distance (`relative`, `relative_finished`)
        and of the best known (`of_best_known`), and shares of seeds (`walkers`, `beats_greedy`, …);
        None where nothing can be computed.
    """
    seen = [one for one in strata if one.total_m]
    walked = [one for one in seen if one.reference.total_m is not None]
    raced = [one for one in strata if one.finished_m and one.reference.finished_m is not None]
    total = [_as_share(one.total_m, one.reference.total_m) for one in walked]
    finished = [_as_share(one.finished_m, one.reference.finished_m) for one in raced]
    # A mean over some of the gaits could not be compared with that over all.
    is_known = all(one.reference.best_known_m is not None for one in seen)
    known = [_as_share(one.total_m, one.reference.best_known_m) for one in seen if is_known]
    return {
        "relative": _iqm_interval_of(total, seed),
        "relative_finished": _iqm_interval_of(finished, seed),
        "of_best_known": _iqm_interval_of(known, seed),
        "walkers": _share(total, lambda points: share_at_least(points, WALKER_SHARE)),
        "beats_greedy": _share_ahead_of_greedy(finished),
        "beats_greedy_total": _share_ahead_of_greedy(total),
        "reaches_greedy": _share(total, lambda points: share_at_least(points, REACHED_SHARE)),
    }


def best_known_relative(strata: Sequence[Stratum]) -> float | None:
    """Return the best known distance as a share of greedy's, the mean over the strata with seeds.

    None if one of them lacks either.
    """
    shares = []
    for reference in (one.reference for one in strata if one.total_m):
        if reference.best_known_m is None or reference.total_m is None:
            return None
        shares.append(reference.best_known_m / reference.total_m)
    return fmean(shares) if shares else None


def summarise_distances(points: Points, seed: int) -> dict[str, Any] | None:
    """Return the seeds' distances, their mean, median and interquartile mean [m].

    None without seeds.
    """
    if not points:
        return None
    middle = iqm_interval((points,), seed)
    return {
        "points_m": list(points),
        "mean_m": fmean(points),
        "median_m": median(points),
        "iqm_m": middle.value,
        "low_m": middle.low,
        "high_m": middle.high,
    }


def compare_with_published(
    cell: Published | None, total_m: Points, finished_m: Points
) -> dict[str, Any] | None:
    """Return the paper's values and the quantile of our seeds in which each falls."""
    if cell is None:
        return None
    return {
        "total_m": cell.total_m,
        "finished_m": cell.finished_m,
        "total_quantile": _quantile(cell.total_m, total_m),
        "finished_quantile": _quantile(cell.finished_m, finished_m),
    }


def learning_curve(
    blocks: Sequence[Points], steps: int, reference: ReferenceDistance, seed: int
) -> Mapping[str, Any]:
    """Return the learning curve: distance against steps of practice, with its references.

    Args:
        blocks: the seeds' distances after each block of practice [m].
        steps: steps of practice in one block.
        reference: reference distances under the same conditions.
        seed: seed of the bootstrap's resampling.
    """
    intervals = [iqm_interval((points,), seed) for points in blocks]
    limit = None if reference.total_m is None else WALKER_SHARE * reference.total_m
    return {
        "steps": [steps * (1 + number) for number in range(len(blocks))],
        "iqm_m": [one.value for one in intervals],
        "low_m": [one.low for one in intervals],
        "high_m": [one.high for one in intervals],
        "mean_m": [fmean(points) for points in blocks],
        "walkers": [None if limit is None else share_at_least(p, limit).value for p in blocks],
        "points_m": [list(points) for points in blocks],
        "greedy_m": reference.total_m,
        "best_known_m": reference.best_known_m,
    }


def _as_share(points: Points, of_m: float | None) -> Points:
    return tuple(point / of_m for point in points) if of_m else ()


def _iqm_interval_of(strata: list[Points], seed: int) -> dict[str, Any] | None:
    if not strata:
        return None
    middle = iqm_interval(tuple(strata), seed)
    return {"iqm": middle.value, "low": middle.low, "high": middle.high}


def _share(strata: list[Points], count: Callable[[Points], Interval]) -> dict[str, Any] | None:
    """Return a share of all seeds, with its interval if each stratum has at least `MIN_SEEDS`."""
    if not strata:
        return None
    share = count(tuple(point for points in strata for point in points))
    if min(map(len, strata)) < MIN_SEEDS:
        share = Interval(share.value)
    return {"share": share.value, "low": share.low, "high": share.high}


def _share_ahead_of_greedy(strata: list[Points]) -> dict[str, Any] | None:
    """Return the share of seeds ahead of greedy, with its verdict.

    The strata hold shares of greedy's distance, so that greedy itself is 1.
    """
    measured = _share(strata, lambda points: share_ahead(points, 1.0))
    if measured is None:
        return None
    share = Interval(measured["share"], measured["low"], measured["high"])
    return {**measured, "verdict": share.exceeds(0.5)}


def _quantile(value: float | None, points: Points) -> float | None:
    """Return the value's quantile; None for a single point, which is not a distribution.

    Search agents are deterministic and have one point.
    """
    return None if value is None or len(points) < 2 else quantile_of(value, points)
