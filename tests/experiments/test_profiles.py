"""Performance profiles and their bands."""

import numpy as np
import pytest
from scipy import stats

from hexapods.experiments.comparison import Group
from hexapods.experiments.profiles import MAX_BANDED, band_beyond, profile_of, share_limits


def test_a_profile_is_the_share_of_seeds_that_reach_each_distance() -> None:
    profile = profile_of(Group("Q", (0.3, 0.1, 0.3, 0.2)))
    assert profile.at == (0.1, 0.2, 0.3)
    assert profile.share == (1.0, 0.75, 0.5)
    points = np.random.default_rng(0).normal(size=40)
    steps = profile_of(Group("Q", tuple(points.tolist())))
    for limit, share in zip(steps.at, steps.share, strict=True):
        assert share == pytest.approx(np.mean(points >= limit))


def test_bands_are_wilson_intervals_as_summaries_have_them() -> None:
    group = Group("Q", (0.4, 0.1, 0.3, 0.2))
    profile = profile_of(group)
    [limits] = share_limits([4, 4, 2, 1, 0, MAX_BANDED + 1])
    assert limits["seeds"] == 4
    for hits, low, high in zip((4, 3, 2, 1), profile.low, profile.high, strict=True):
        expected = stats.binomtest(hits, 4).proportion_ci(method="wilson")
        assert (low, high) == (expected.low, expected.high)
        assert (limits["low"][hits], limits["high"][hits]) == (low, high)
    assert band_beyond(group) == limits["high"][0]


def test_what_has_no_spread_has_no_band() -> None:
    for group in (Group("greedy", (0.5,), None, True), Group("Q", (0.1, 0.2))):
        profile = profile_of(group)
        assert {*profile.low, *profile.high} == {None}
        assert band_beyond(group) is None
