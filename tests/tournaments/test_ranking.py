"""Ranks, and which entries can be told apart."""

import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.experiments.statistics import iqm_interval, paired_interval
from hexapods.tournaments.ranking import RankedEntry, ranking

DISTANCES = st.lists(
    st.lists(st.floats(-0.1, 0.6) | st.just(0.0), min_size=5, max_size=5), min_size=1, max_size=5
)


def sample(entries: int, draws: int, seed: int = 0) -> dict[int, list[float]]:
    rng = np.random.default_rng(seed)
    ease = rng.normal(0, 0.05, draws)  # of a draw, for all
    return {
        number: (0.3 + 0.02 * (number % 7) + ease + rng.normal(0, 0.01, draws)).tolist()
        for number in range(entries)
    }


def test_intervals_are_those_of_experiments() -> None:
    distances = sample(6, 20)
    for standing in ranking(distances, {}):
        expected = iqm_interval((tuple(distances[standing.number]),), 0)
        assert (standing.iqm_m, standing.low_m, standing.high_m) == pytest.approx(
            expected, rel=1e-12
        )
        for other, points in distances.items():
            pair = np.array([distances[standing.number], points])
            low, high = paired_interval([pair], lambda iqms: iqms[0] - iqms[1], 0)[1:]
            assert low is not None
            assert high is not None
            is_apart = not low <= 0 <= high
            assert (other in standing.not_separable) == (other != standing.number and not is_apart)


def test_pairs_tell_apart_what_overlapping_intervals_do_not() -> None:
    easy_and_hard = np.linspace(0.1, 0.5, 20)
    better, worse = ranking({0: easy_and_hard.tolist(), 1: (easy_and_hard + 0.01).tolist()}, {})
    assert better.number == 1
    assert better.low_m < worse.high_m
    assert (better.best_rank, better.worst_rank) == (1, 1)
    assert (worse.best_rank, worse.worst_rank) == (2, 2)
    assert better.not_separable == worse.not_separable == ()


def test_equal_results_are_not_separable() -> None:
    same = [0.1, 0.2, 0.3, 0.4, 0.5]
    rounded = [distance_m + 1e-16 for distance_m in same]
    standings = ranking({7: same, 2: same, 5: rounded}, {2: 3})
    assert {standing.number: standing.not_separable for standing in standings} == {
        2: (5, 7),
        5: (2, 7),
        7: (2, 5),
    }
    assert all((standing.best_rank, standing.worst_rank) == (1, 3) for standing in standings)
    assert [standing.failures for standing in standings if standing.number == 2] == [3]
    assert [standing.number for standing in ranking({7: same, 2: same}, {})] == [2, 7]


def test_no_entries_and_a_single_entry_are_ranked() -> None:
    assert ranking({}, {}) == []
    assert ranking({4: [0.5] * 5}, {4: 1}) == [
        RankedEntry(
            number=4,
            iqm_m=0.5,
            low_m=0.5,
            high_m=0.5,
            best_rank=1,
            worst_rank=1,
            not_separable=(),
            failures=1,
        )
    ]


def test_entries_of_other_draws_are_refused() -> None:
    with pytest.raises(ValueError, match="same draws"):
        ranking({0: [0.1] * 5, 1: [0.1] * 6}, {})


@pytest.mark.test
@given(DISTANCES, st.randoms(use_true_random=False))
def test_ranks_are_consistent_and_independent_of_the_order(
    points: list[list[float]], order: random.Random
) -> None:
    distances = dict(enumerate(points))
    standings = ranking(distances, {})
    shuffled = list(distances.items())
    order.shuffle(shuffled)
    assert ranking(dict(shuffled), {}) == standings
    by_number = {standing.number: standing for standing in standings}
    assert set(by_number) == set(distances)
    iqms = [standing.iqm_m for standing in standings]
    assert iqms == sorted(iqms, reverse=True)
    for place, standing in enumerate(standings, start=1):
        assert 1 <= standing.best_rank <= place <= standing.worst_rank <= len(standings)
        assert standing.number not in standing.not_separable
        told_apart = len(standings) - 1 - len(standing.not_separable)
        assert standing.best_rank - 1 + len(standings) - standing.worst_rank == told_apart
        for other in standing.not_separable:
            assert standing.number in by_number[other].not_separable


@pytest.mark.test
def test_many_entries_are_ranked_by_the_same_resamples() -> None:
    """Two hundred entries have 19,900 pairs; each pair alone would take minutes."""
    distances = sample(200, 20)
    whole = {standing.number: standing for standing in ranking(distances, {})}
    some = {number: distances[number] for number in (3, 77, 150)}
    for standing in ranking(some, {}):
        in_whole = whole[standing.number]
        assert (standing.iqm_m, standing.low_m, standing.high_m) == (
            in_whole.iqm_m,
            in_whole.low_m,
            in_whole.high_m,
        )
        assert set(standing.not_separable) == set(in_whole.not_separable) & set(some)
