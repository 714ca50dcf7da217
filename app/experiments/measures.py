"""What the trials of a setting, or of a few together, measured; in plain types."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any

from app.experiments.published import Published
from app.experiments.statistics import (
    MIN_SEEDS,
    Interval,
    Points,
    ahead,
    at_least,
    iqm_interval,
    quantile_of,
)

WALKS = 0.5
"""Of greedy's total distance: who covers as much is a walker."""
REACHES = 0.95
"""Of greedy's total distance: who covers as much has reached it."""


@dataclass(frozen=True)
class Reference:
    """How far greedy comes in the same place [m]; None where that is not known, or is no walk."""

    total_m: float | None = None
    finished_m: float | None = None


@dataclass(frozen=True)
class Stratum:
    """The seeds of one setting, those that failed left out.

    Attributes:
        total_m: over 50 steps; of several blocks after the last.
        finished_m: when the first agent has taken its 50 steps; empty where nothing was raced.
        greedy: in the same place.
    """

    total_m: Points
    finished_m: Points
    greedy: Reference


def measures(strata: Sequence[Stratum], seed: int) -> dict[str, Any]:
    """Everything that is measured against greedy, over the seeds of all strata.

    Args:
        strata: one setting, or the gaits of one; those without seeds are left out.
        seed: of the resampling.
    """
    walked = [one for one in strata if one.total_m and one.greedy.total_m is not None]
    raced = [one for one in strata if one.finished_m and one.greedy.finished_m is not None]
    total = [_as_share(one.total_m, one.greedy.total_m) for one in walked]
    finished = [_as_share(one.finished_m, one.greedy.finished_m) for one in raced]
    return {
        "relative": _relative(total, seed),
        "relative_finished": _relative(finished, seed),
        "walkers": _share(total, lambda points: at_least(points, WALKS)),
        "beats_greedy": _beats(finished),
        "beats_greedy_total": _beats(total),
        "reaches_greedy": _share(total, lambda points: at_least(points, REACHES)),
    }


def distances(points: Points, seed: int) -> dict[str, Any] | None:
    """The seeds' distances and what lies in their middle [m]; None without seeds."""
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
    """What the paper has, and in which quantile of our seeds it falls."""
    if cell is None:
        return None
    return {
        "total_m": cell.total_m,
        "finished_m": cell.finished_m,
        "total_quantile": _quantile(cell.total_m, total_m),
        "finished_quantile": _quantile(cell.finished_m, finished_m),
    }


def curve(
    blocks: Sequence[Points], steps: int, greedy: Reference, seed: int
) -> Mapping[str, list[Any]]:
    """Distance against practice.

    Args:
        blocks: the seeds' distances after each block [m].
        steps: of a block.
        greedy: in the same place.
        seed: of the resampling.
    """
    found = [iqm_interval((points,), seed) for points in blocks]
    limit = None if greedy.total_m is None else WALKS * greedy.total_m
    return {
        "steps": [steps * (1 + number) for number in range(len(blocks))],
        "iqm_m": [one.value for one in found],
        "low_m": [one.low for one in found],
        "high_m": [one.high for one in found],
        "mean_m": [fmean(points) for points in blocks],
        "walkers": [None if limit is None else at_least(p, limit).value for p in blocks],
        "points_m": [list(points) for points in blocks],
    }


def _as_share(points: Points, of_m: float | None) -> Points:
    return tuple(point / of_m for point in points) if of_m else ()


def _relative(strata: list[Points], seed: int) -> dict[str, Any] | None:
    if not strata:
        return None
    middle = iqm_interval(tuple(strata), seed)
    return {"iqm": middle.value, "low": middle.low, "high": middle.high}


def _share(strata: list[Points], count: Callable[[Points], Interval]) -> dict[str, Any] | None:
    """A share of all seeds; with its interval if each stratum has seeds enough for one."""
    if not strata:
        return None
    found = count(tuple(point for points in strata for point in points))
    if min(map(len, strata)) < MIN_SEEDS:
        found = Interval(found.value)
    return {"share": found.value, "low": found.low, "high": found.high}


def _beats(strata: list[Points]) -> dict[str, Any] | None:
    """Against greedy, which is 1 in shares of greedy."""
    shown = _share(strata, lambda points: ahead(points, 1.0))
    if shown is None:
        return None
    found = Interval(shown["share"], shown["low"], shown["high"])
    return {**shown, "verdict": found.against(0.5)}


def _quantile(value: float | None, points: Points) -> float | None:
    """With one number, as an agent that looks ahead has, there is no distribution to fall in."""
    return None if value is None or len(points) < 2 else quantile_of(value, points)
