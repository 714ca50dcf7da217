"""Two groups of seeds compared, against simulations in which the truth is known."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from hexapods.domain.errors import InvalidInput
from hexapods.experiments.comparing import compare
from hexapods.experiments.comparison import POWER, Comparison, Group
from hexapods.experiments.config import MAX_SEEDS

Draw = Callable[[np.random.Generator, int], np.ndarray]


def group(points: object, name: str = "A", *, is_paired: bool = False) -> Group:
    values = tuple(np.asarray(points, dtype=float).tolist())
    return Group(name, values, tuple(range(len(values))) if is_paired else None)


def of(a: object, b: object, seed: int = 0, *, is_paired: bool = False) -> Comparison:
    return compare(
        group(a, is_paired=is_paired),
        group(b, "B", is_paired=is_paired),
        np.random.default_rng(seed),
    )


def normal(middle: float, spread: float) -> Draw:
    return lambda rng, n: rng.normal(middle, spread, n)


def skewed(middle: float, spread: float) -> Draw:
    """Distances that pile up at their most, with a tail of seeds that hardly walk."""
    mean = float(stats.trim_mean(np.random.default_rng(0).exponential(size=100_000), 0.25))
    return lambda rng, n: middle - spread * (rng.exponential(size=n) - mean)


@pytest.mark.parametrize("is_paired", [False, True])
@pytest.mark.parametrize("draw", [normal, skewed])
def test_the_interval_of_the_difference_contains_the_true_one_in_about_95_percent(
    draw: Callable[[float, float], Draw], is_paired: bool
) -> None:
    difference, n, times = 0.05, 30, 120
    covering = 0
    for seed in range(times):
        rng = np.random.default_rng([seed, 7])
        robots = rng.normal(0, 0.04, n) if is_paired else np.zeros(n)  # what a seed brings along
        a = draw(0.4 + difference, 0.08)(rng, n) + robots
        b = draw(0.4, 0.05)(rng, n) + robots
        low, high = of(a, b, seed, is_paired=is_paired).difference[1:]
        assert low is not None
        assert high is not None
        covering += low <= difference <= high
    assert 0.88 <= covering / times < 0.99


def test_the_interval_of_a_paired_difference_leaves_out_what_the_seeds_have_in_common() -> None:
    rng = np.random.default_rng(1)
    robots = rng.normal(0.4, 0.1, 20)
    a, b = robots + 0.02 + rng.normal(0, 0.005, 20), robots
    paired, apart = of(a, b, is_paired=True), of(a, b)
    assert paired.difference.value == apart.difference.value
    assert paired.ahead == "a"
    assert apart.ahead == "not established"
    assert paired.difference.low is not None
    assert paired.difference.low > 0


def test_the_further_seeds_settle_a_difference_with_the_chance_that_is_said() -> None:
    """The seeds are those that twenty seeds of typical spread ask for."""
    difference, spread = 0.04, 0.08
    quantiles = stats.norm.ppf((np.arange(20) + 0.5) / 20, scale=spread)
    further = of(0.4 + difference + quantiles, 0.4 + quantiles).further_seeds
    assert further is not None
    assert further > 20
    n, times = 20 + further, 200
    settled = 0
    for seed in range(times):
        rng = np.random.default_rng([seed, 3])
        a, b = normal(0.4 + difference, spread)(rng, n), normal(0.4, spread)(rng, n)
        settled += of(a, b, seed).ahead == "a"
    assert POWER - 0.1 <= settled / times <= POWER + 0.1


def test_the_difference_is_that_of_the_interquartile_means() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.normal(size=23), rng.normal(size=31)
    compared = of(a, b)
    assert compared.difference.value == pytest.approx(
        stats.trim_mean(a, 0.25) - stats.trim_mean(b, 0.25)
    )
    assert compared.a.iqm.value == pytest.approx(stats.trim_mean(a, 0.25))
    assert (compared.a.seeds, compared.b.seeds) == (23, 31)
    assert compared.improvement.value == stats.mannwhitneyu(a, b).statistic / (23 * 31)


def test_the_other_way_round_all_is_negated() -> None:
    rng = np.random.default_rng(3)
    a, b = rng.normal(0.4, 0.05, 12), rng.normal(0.3, 0.05, 12)
    forth, back = of(a, b), of(b, a)
    assert forth.difference.value == -back.difference.value
    assert forth.improvement.value == pytest.approx(1 - back.improvement.value)
    assert (forth.ahead, back.ahead) == ("a", "b")
    assert forth.further_seeds == back.further_seeds == 0


def test_the_same_generator_gives_the_same_bits_and_another_one_others() -> None:
    rng = np.random.default_rng(4)
    a, b = rng.normal(size=10), rng.normal(size=10)
    assert of(a, b, 5) == of(a, b, 5)
    assert of(a, b, 5).difference != of(a, b, 6).difference


def test_seeds_of_one_alone_are_left_out_of_a_paired_comparison() -> None:
    a = Group("A", (0.5, 0.4, 0.3, 9.0), (0, 1, 2, 7))
    b = Group("B", (0.1, 0.3, 0.4), (3, 2, 0))
    compared = compare(a, b, np.random.default_rng(0))
    assert compared.is_paired
    assert compared.left_out == 3
    assert compared.a.seeds == compared.b.seeds == 2
    assert compared.difference.value == pytest.approx((0.5 + 0.3) / 2 - (0.4 + 0.3) / 2)
    with pytest.raises(InvalidInput, match="A and C have no seed in common"):
        compare(a, Group("C", (1.0,), (99,)), np.random.default_rng(0))


@pytest.mark.parametrize("is_paired", [False, True])
def test_groups_that_are_equal_differ_by_nothing_that_seeds_could_settle(is_paired: bool) -> None:
    points = np.random.default_rng(5).normal(size=12)
    compared = of(points, points, is_paired=is_paired)
    assert compared.difference.value == 0
    assert (compared.difference.low == compared.difference.high == 0) is is_paired
    assert compared.improvement.value == 0.5
    assert (compared.ahead, compared.outlook) == ("not established", "equal")
    assert compared.further_seeds is None


@pytest.mark.parametrize("seeds", [1, 2])
def test_one_or_two_seeds_have_a_difference_without_an_interval(seeds: int) -> None:
    compared = of([0.5] * seeds, [0.3] * 30)
    assert compared.difference[1:] == (None, None)
    assert compared.improvement == (1.0, None, None)
    assert (compared.ahead, compared.outlook) == ("not established", "too few seeds")
    assert compared.further_seeds is None


def test_three_seeds_decide_nothing_and_ask_for_at_least_five() -> None:
    compared = of([0.50, 0.51, 0.52], [0.1, 0.11, 0.12])
    assert compared.difference.low is not None
    assert compared.difference.low > 0
    assert (compared.ahead, compared.outlook) == ("not established", "reachable")
    assert compared.further_seeds == 2


def test_a_difference_that_is_tiny_beside_its_spread_is_out_of_reach() -> None:
    spread = np.linspace(-1, 1, 20)
    compared = of(spread + 1e-4, spread)
    assert (compared.outlook, compared.further_seeds) == ("out of reach", None)
    assert of(spread + 0.1, spread).outlook == "reachable"
    assert MAX_SEEDS == 10_000


def test_a_deterministic_group_adds_no_uncertainty() -> None:
    points = tuple(np.random.default_rng(6).normal(0.4, 0.02, 30).tolist())
    greedy = Group("greedy", (0.5,), is_deterministic=True)
    compared = compare(greedy, Group("Q", points), np.random.default_rng(0))
    assert compared.ahead == "a"
    assert compared.improvement == pytest.approx((1.0, 0.886, 1.0), abs=0.001)  # Wilson's
    alone = compare(greedy, Group("wave", (0.2,), None, True), np.random.default_rng(0))
    assert alone.difference == (0.3, 0.3, 0.3)
    assert alone.ahead == "a"


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_no_finite_number_is_refused_by_its_place(value: float) -> None:
    with pytest.raises(InvalidInput, match=r"seed 2 of Q is (nan|inf), not a finite number"):
        Group("Q", (0.1, value))


def test_groups_without_seeds_or_with_seeds_twice_are_refused() -> None:
    with pytest.raises(InvalidInput, match="Q has no seed to compare"):
        Group("Q", ())
    with pytest.raises(InvalidInput, match="each seed of Q must have another number"):
        Group("Q", (0.1, 0.2), (1, 1))
