"""Measures over the seeds of one or more settings, as plain types fit for JSON."""

from collections.abc import Callable, Sequence
from statistics import fmean, median
from typing import Any

from hexapods.experiments.presets import REACHED_SHARE
from hexapods.experiments.published import Published
from hexapods.experiments.setting_results import SettingResults
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


def measure_against_references(strata: Sequence[SettingResults], seed: int) -> dict[str, Any]:
    """Compute all measures relative to greedy and to the best known, over the seeds of all strata.

    Args:
        strata: one setting, or one for each gait; those without seeds are ignored.
        seed: seed of the bootstrap's resampling.

    Returns:
        Interquartile means of the shares of greedy's distance (`relative`, `relative_finished`)
        and of the best known (`of_best_known`), and shares of seeds (`walkers`, `beats_greedy`, …);
        None where nothing can be computed.
    """
    seen = [stratum for stratum in strata if stratum.total_m]
    walked = [stratum for stratum in seen if stratum.reference.total_m is not None]
    raced = [
        stratum
        for stratum in strata
        if stratum.finished_m and stratum.reference.finished_m is not None
    ]
    total = [_as_share(stratum.total_m, stratum.reference.total_m) for stratum in walked]
    finished = [_as_share(stratum.finished_m, stratum.reference.finished_m) for stratum in raced]
    # A mean over some of the gaits could not be compared with that over all.
    is_known = all(stratum.reference.best_known_m is not None for stratum in seen)
    of_best_known = [
        _as_share(stratum.total_m, stratum.reference.best_known_m) for stratum in seen if is_known
    ]
    return {
        "relative": iqm_entry(total, seed),
        "relative_finished": iqm_entry(finished, seed),
        "of_best_known": iqm_entry(of_best_known, seed),
        "walkers": _share(total, lambda points: share_at_least(points, WALKER_SHARE)),
        "beats_greedy": _share(finished, _ahead_of_greedy, exceeds=0.5),
        "beats_greedy_total": _share(total, _ahead_of_greedy, exceeds=0.5),
        "reaches_greedy": _share(total, lambda points: share_at_least(points, REACHED_SHARE)),
    }


def best_known_relative(strata: Sequence[SettingResults]) -> float | None:
    """Return the best known distance as a share of greedy's, the mean over the strata with seeds.

    None if a stratum lacks one of the two distances.
    """
    shares = []
    for reference in (stratum.reference for stratum in strata if stratum.total_m):
        if reference.best_known_m is None or reference.total_m is None:
            return None
        shares.append(reference.best_known_m / reference.total_m)
    return fmean(shares) if shares else None


def summarise_distances(points: Points, seed: int) -> dict[str, Any] | None:
    """Return the seeds' distances, their mean, median and interquartile mean [m].

    Return None without seeds.
    """
    if not points:
        return None
    middle = iqm_interval((points,), seed).as_json("iqm", "_m")
    return {
        "points_m": list(points),
        "mean_m": fmean(points),
        "median_m": median(points),
        **middle,
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


def curve_entry(columns: Sequence[Points], seed: int) -> dict[str, list[Any]]:
    """Return a curve: interquartile means with their intervals, and means, of each column [m]."""
    intervals = [iqm_interval((points,), seed) for points in columns]
    return {
        "iqm_m": [estimate.value for estimate in intervals],
        "low_m": [estimate.low for estimate in intervals],
        "high_m": [estimate.high for estimate in intervals],
        "mean_m": [fmean(points) for points in columns],
    }


def iqm_entry(strata: Sequence[Points], seed: int) -> dict[str, Any] | None:
    """Return the interquartile mean of all seeds with its interval; None without strata."""
    return iqm_interval(tuple(strata), seed).as_json("iqm") if strata else None


def _as_share(points: Points, of_m: float | None) -> Points:
    return tuple(point / of_m for point in points) if of_m else ()


def _ahead_of_greedy(shares_of_greedy: Points) -> Interval:
    return share_ahead(shares_of_greedy, 1.0)


def _share(
    strata: list[Points], count: Callable[[Points], Interval], exceeds: float | None = None
) -> dict[str, Any] | None:
    """Return a share of all seeds, with its interval if each stratum has at least `MIN_SEEDS`.

    With a threshold to exceed it has a verdict, too.
    """
    if not strata:
        return None
    share = count(tuple(point for points in strata for point in points))
    if min(map(len, strata)) < MIN_SEEDS:
        share = Interval(share.value)
    verdict = {} if exceeds is None else {"verdict": share.exceeds(exceeds)}
    return {**share.as_json("share"), **verdict}


def _quantile(value: float | None, points: Points) -> float | None:
    """Return the value's quantile; None for a single point, which is not a distribution.

    Search agents are deterministic and have one point.
    """
    return None if value is None or len(points) < 2 else quantile_of(value, points)
