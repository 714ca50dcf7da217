"""Ranking of a tournament: interquartile means, and which entries can be told apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hexapods.domain.records import Record


@dataclass(frozen=True, kw_only=True)
class Standing(Record):
    """Standing of an entry that has been judged on all draws.

    Attributes:
        number: of the entry.
        iqm_m: interquartile mean of the distances over all draws [m].
        low_m, high_m: its 95 % bootstrap interval [m].
        best_rank, worst_rank: the ranks that it may have: 1 + the number of entries that are
            better and can be told apart from it, and the number of all without those that are
            worse and can be told apart.
        not_separable: numbers of the entries of which the 95 % interval of the paired difference
            of the interquartile means includes 0.
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
) -> list[Standing]:
    """Rank entries by the interquartile mean of their distances on the same draws.

    Equal interquartile means are in the order of the numbers. The method is that of Agarwal et al.
    (2021), with pairs: the draws are resampled, all entries with the same ones.

    Args:
        distances_m: by number of the entry its distance on each draw [m].
        failures: by number of the entry on how many draws it failed; none if absent.

    Returns:
        best first.
    """
    raise NotImplementedError
