"""Ranking of a tournament: interquartile means, and which entries can be told apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.records import Record
from hexapods.domain.types import FloatArray
from hexapods.experiments.statistics import iqm, percentile_limits, resampled_iqms

RESOLUTION_M = 1e-6
"""Differences up to this are none [m]: the same walk adds up to sums that differ by rounding."""
_RESAMPLING_SEED = 0


@dataclass(frozen=True, kw_only=True)
class RankedEntry(Record):
    """Standing of an entry that has been judged on all draws.

    Attributes:
        number: of the entry.
        iqm_m: interquartile mean of the distances over all draws [m].
        low_m, high_m: its 95 % bootstrap interval [m].
        best_rank, worst_rank: the ranks that it may have: 1 + the number of entries that are
            better and can be told apart from it, and the number of all without those that are
            worse and can be told apart.
        not_separable: numbers, ascending, of the entries of which the 95 % interval of the paired
            difference of the interquartile means includes 0, to a micrometre.
        failures: on how many draws it could not walk to the end; it counts as 0 m there.
    """

    number: int
    iqm_m: float
    low_m: float
    high_m: float
    best_rank: int
    worst_rank: int
    not_separable: tuple[int, ...]
    failures: int


def ranking(
    distances_m: Mapping[int, Sequence[float]], failures: Mapping[int, int]
) -> list[RankedEntry]:
    """Rank entries by the interquartile mean of their distances on the same draws.

    Equal interquartile means are in the order of the numbers. The method is that of Agarwal et al.
    (2021), with pairs: the draws are resampled, all entries with the same ones, and always with
    the same random numbers. As all entries share the resamples, those of a difference are the
    differences of their interquartile means, so that even 300 entries take seconds.

    Args:
        distances_m: by number of the entry its distance on each draw [m].
        failures: by number of the entry on how many draws it failed; none if absent.

    Returns:
        best first.

    Raises:
        ValueError: if the entries were judged on different numbers of draws.
    """
    if len({len(distances) for distances in distances_m.values()}) > 1:
        raise ValueError("all entries of a ranking must be judged on the same draws")
    if not distances_m:
        return []
    points = np.array(list(distances_m.values()), dtype=np.float64)  # (k, n)
    iqms_m = iqm(points)
    numbers = list(distances_m)
    order = sorted(range(len(numbers)), key=lambda place: (-iqms_m[place], numbers[place]))
    numbers, iqms_m = [numbers[place] for place in order], iqms_m[order]
    resampled_m = resampled_iqms(points[order], _RESAMPLING_SEED)
    low_m, high_m = percentile_limits(resampled_m)
    is_apart = _can_be_told_apart(iqms_m, resampled_m)
    k = len(numbers)
    return [
        RankedEntry(
            number=number,
            iqm_m=float(iqms_m[place]),
            low_m=float(low_m[place]),
            high_m=float(high_m[place]),
            best_rank=1 + int(is_apart[place, :place].sum()),
            worst_rank=k - int(is_apart[place, place:].sum()),
            not_separable=tuple(
                sorted(
                    numbers[other]
                    for other in range(k)
                    if other != place and not is_apart[place, other]
                )
            ),
            failures=failures.get(number, 0),
        )
        for place, number in enumerate(numbers)
    ]


def _can_be_told_apart(iqms_m: FloatArray, resampled_m: FloatArray) -> NDArray[np.bool_]:
    """Return which pairs of entries the intervals of their differences tell apart, (k, k).

    Args:
        iqms_m: of the entries, descending, (k,) [m].
        resampled_m: of the entries, (k, resamples) [m].
    """
    is_apart = np.zeros((len(iqms_m), len(iqms_m)), dtype=bool)
    for place in range(len(iqms_m) - 1):
        behind = slice(place + 1, None)
        low_m, _ = percentile_limits(resampled_m[place] - resampled_m[behind])
        # Rarely an interval is on the other side of the difference: that tells nothing.
        is_apart[place, behind] = (low_m > RESOLUTION_M) & (iqms_m[place] > iqms_m[behind])
    return is_apart | is_apart.T
