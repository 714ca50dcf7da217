"""What is said of a comparison."""

import json

import numpy as np
import pytest

from hexapods.experiments.comparing import compare
from hexapods.experiments.comparison import Comparison, Group

SPREAD = np.linspace(-0.05, 0.05, 20)


def of(a: Group, b: Group, *, is_at_time_out: bool = False) -> Comparison:
    return compare(a, b, np.random.default_rng(0), is_at_time_out=is_at_time_out)


def group(name: str, points: object) -> Group:
    return Group(name, tuple(np.asarray(points, dtype=float).tolist()))


def test_a_settled_difference_is_said_from_the_side_of_who_is_ahead() -> None:
    a, b = group("α 0.1", 0.3 + SPREAD), group("α 0.3", 0.4 + SPREAD)
    words = of(a, b).words
    assert (
        words.outcome == "α 0.3 comes 0.10\u00a0m farther than α 0.1 (95 % interval 0.07 to 0.12)."
    )
    assert words.chance == (
        "The probability that a seed of α 0.3 comes farther than a seed of α 0.1 is "
        "100\u00a0% (100 to 100)."
    )
    assert words.further == "Settled: the interval excludes 0."
    assert words.seeds == "Not paired: 20 seeds each."


def test_a_difference_that_is_not_established_says_how_many_seeds_are_missing() -> None:
    words = of(group("A", 0.31 + SPREAD), group("B", 0.3 + SPREAD)).words
    assert words.outcome.startswith("Not established which comes farther: A is ahead of B by ")
    assert "further seeds of each would settle it with a chance of 80\u00a0%" in words.further


@pytest.mark.parametrize(
    ("a", "b", "said"),
    [
        (SPREAD + 1e-6, SPREAD, "Even 10,000 seeds of each would hardly settle"),
        (SPREAD, SPREAD, "Further seeds cannot settle a difference of 0."),
        ([0.3], [0.2], "cannot be told from 1 seed: that takes 3."),
        ([0.3, 0.31, 0.32], [0.2, 0.21, 0.22], "With fewer than 5 seeds an interval decides"),
    ],
)
def test_what_further_seeds_would_not_bring_is_said(a: object, b: object, said: str) -> None:
    assert said in of(group("A", a), group("B", b)).words.further


def test_of_a_deterministic_agent_no_seeds_are_asked_for() -> None:
    greedy = Group("Greedy", (0.3,), is_deterministic=True)
    words = of(greedy, group("Q-learning", 0.297 + SPREAD)).words
    assert "further seeds of Q-learning" in words.further
    assert words.seeds == "20 seeds; Greedy walks the same with every seed."
    assert "probability that Greedy comes farther than a seed of Q-learning" in words.chance
    alone = of(greedy, Group("Two-step", (0.29999,), is_deterministic=True))
    assert str(alone) == (
        "Greedy comes less than 0.001\u00a0m farther than Two-step. "
        "Both walk the same with every seed."
    )


def test_paired_seeds_are_said_to_be_paired() -> None:
    a = Group("A", tuple((0.35 + SPREAD).tolist()), tuple(range(20)))
    b = Group("B", tuple((0.3 + SPREAD[:18]).tolist()), tuple(range(18)))
    words = of(a, b, is_at_time_out=True).words
    assert (
        words.seeds == "Paired: both walked with the same 18 seeds; left out: 2 seeds of one alone."
    )
    assert "0.050\u00a0m farther at time-out than B" in words.outcome


def test_a_comparison_is_plain_json() -> None:
    compared = of(group("A", 0.31 + SPREAD), group("B", 0.3 + SPREAD))
    data = json.loads(json.dumps(compared.as_json(), allow_nan=False))
    assert data["a"]["iqm"]["value"] == compared.a.iqm.value
    assert data["difference"] == compared.difference._asdict()
    assert data["words"]["outcome"] == compared.words.outcome
