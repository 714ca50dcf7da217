"""Interquartile means, intervals, shares and probabilities, against independent computations."""

from itertools import product

import numpy as np
import pytest
from scipy import stats

from hexapods.domain.types import FloatArray
from hexapods.experiments.statistics import (
    RESAMPLES,
    Interval,
    bootstrap_exceeds,
    improvement,
    iqm,
    iqm_interval,
    paired_interval,
    pooled_iqm,
    quantile_of,
    share,
    share_ahead,
    share_at_least,
)


def test_the_interquartile_mean_drops_a_quarter_at_each_end() -> None:
    assert iqm(np.array([100.0, 1, 2, 3, 4, 5, 6, -100])) == pytest.approx(3.5)


def test_the_interquartile_mean_is_scipys_to_the_last_bit() -> None:
    samples = np.random.default_rng(4).normal(size=(5, 7, 43))
    for axis in range(3):
        np.testing.assert_array_equal(iqm(samples, axis), stats.trim_mean(samples, 0.25, axis))


@pytest.mark.parametrize("sizes", [(3,), (30,), (8, 30, 5), (3000,)])
def test_the_bootstrap_interval_is_scipys_to_the_last_bit(sizes: tuple[int, ...]) -> None:
    rng = np.random.default_rng(5)
    strata = tuple(tuple(rng.normal(size=size).tolist()) for size in sizes)
    expected = stats.bootstrap(
        [np.array(points) for points in strata],
        pooled_iqm,
        n_resamples=RESAMPLES,
        batch=max(1, 4_000_000 // sum(sizes)),
        method="percentile",
        vectorized=True,
        rng=np.random.default_rng(7),
    ).confidence_interval
    interval = iqm_interval(strata, 7)
    assert (interval.low, interval.high) == (expected.low, expected.high)


def test_the_wilson_intervals_are_scipys_to_the_last_bit() -> None:
    for of in range(3, 40):
        for hits in range(of + 1):
            expected = stats.binomtest(hits, of).proportion_ci(method="wilson")
            assert share(hits, of)[1:] == (expected.low, expected.high)


def test_the_interquartile_mean_of_three_numbers_is_their_mean() -> None:
    assert iqm(np.array([0.0, 0.0, 3.0])) == pytest.approx(1)


def test_the_coverage_of_the_bootstrap_interval_is_about_95_percent() -> None:
    rng = np.random.default_rng(1)
    covering = 0
    for _ in range(200):
        estimate = iqm_interval((tuple(rng.normal(5, 1, 30).tolist()),), 0)
        assert estimate.low is not None
        assert estimate.high is not None
        covering += estimate.low < 5 < estimate.high
    assert 0.88 <= covering / 200 <= 0.98


def test_an_interval_is_deterministic_for_a_seed() -> None:
    points = tuple(np.random.default_rng(2).normal(size=30).tolist())
    first = iqm_interval((points,), 7)
    iqm_interval.cache_clear()
    assert iqm_interval((points,), 7) == first
    assert iqm_interval((points,), 8) != first


def test_strata_are_resampled_separately() -> None:
    """A difference between two gaits without variance adds no uncertainty."""
    estimate = iqm_interval(((0.0,) * 10, (1.0,) * 10), 0)
    assert estimate == Interval(0.5, 0.5, 0.5)
    mixed = iqm_interval(((0.0,) * 10 + (1.0,) * 10,), 0)
    assert mixed.low is not None
    assert mixed.low < 0.4


@pytest.mark.parametrize("points", [(0.2,), (0.2, 0.3)])
def test_fewer_than_three_seeds_have_no_interval_and_establish_nothing(
    points: tuple[float, ...],
) -> None:
    estimate = iqm_interval((points,), 0)
    assert estimate == Interval(sum(points) / len(points), None, None)
    assert estimate.exceeds(0.0) == "not established"
    assert share_ahead(points, 0.0).low is None


def test_a_bootstrap_interval_of_fewer_than_five_seeds_decides_nothing() -> None:
    estimate = iqm_interval(((0.4, 0.41, 0.42),), 0)
    assert estimate.exceeds(0.1) == "yes"
    assert bootstrap_exceeds(estimate, 0.1, fewest=3) == "not established"
    assert bootstrap_exceeds(estimate, 0.1, fewest=5) == "yes"


def test_shares_have_wilson_intervals() -> None:
    estimate = share(8, 10)
    assert estimate.value == 0.8
    assert (estimate.low, estimate.high) == pytest.approx((0.490, 0.943), abs=0.001)


def test_a_tie_counts_half_and_widens_the_interval_on_both_sides() -> None:
    estimate = share_ahead([1.0, 2.0, 3.0, 4.0], 2.0)
    assert estimate.value == 0.625
    assert estimate.low == pytest.approx(share(2, 4).low)
    assert estimate.high == pytest.approx(share(3, 4).high)


def test_a_seed_exactly_at_the_limit_reaches_it() -> None:
    assert share_at_least([0.25, 0.5, 0.1, 0.3], 0.25).value == 0.75


@pytest.mark.parametrize(
    ("estimate", "verdict"),
    [
        (Interval(0.7, 0.6, 0.8), "yes"),
        (Interval(0.3, 0.2, 0.4), "no"),
        (Interval(0.6, 0.4, 0.8), "not established"),
        (Interval(0.7, 0.5, 0.8), "not established"),
    ],
)
def test_a_verdict_follows_from_the_interval(estimate: Interval, verdict: str) -> None:
    assert estimate.exceeds(0.5) == verdict


def test_negating_an_interval_swaps_its_limits() -> None:
    assert -Interval(0.3, 0.2, 0.6) == Interval(-0.3, -0.6, -0.2)


def test_the_probability_of_improvement_is_over_all_pairs_of_seeds() -> None:
    rng = np.random.default_rng(3)
    a, b = (tuple(rng.integers(0, 9, n).astype(float).tolist()) for n in (12, 15))
    pairs = [(x > y) + 0.5 * (x == y) for x, y in product(a, b)]
    estimate = improvement((a,), (b,), 0)
    assert estimate.value == pytest.approx(np.mean(pairs))
    assert estimate.value == stats.mannwhitneyu(a, b).statistic / (12 * 15)
    assert estimate.low is not None
    assert estimate.high is not None
    assert estimate.low < estimate.value < estimate.high


def test_the_probability_of_improvement_is_averaged_over_strata() -> None:
    low, high = (0.0, 1.0, 2.0), (5.0, 6.0, 7.0)
    assert improvement((high, low), (low, high), 0).value == 0.5
    assert improvement((high, high), (low, low), 0) == Interval(1, 1, 1)


def test_paired_numbers_of_a_seed_are_resampled_together() -> None:
    """Each seed gains the same, so the gain's interval has no width although the seeds vary."""
    start = np.linspace(0, 1, 20)
    pairs = np.stack([start, start + 0.01])

    def gain(middles: FloatArray) -> FloatArray:
        return np.asarray(middles[1] - middles[0])

    estimate = paired_interval([pairs], gain, 0)
    assert estimate == pytest.approx((0.01, 0.01, 0.01))


def test_the_quantile_of_a_published_value() -> None:
    points = [0.1, 0.2, 0.2, 0.4]
    assert quantile_of(0.0, points) == 0
    assert quantile_of(0.2, points) == 0.5
    assert quantile_of(0.5, points) == 1
    for published in points:
        assert quantile_of(published, points) == (
            stats.percentileofscore(points, published, kind="mean") / 100
        )
