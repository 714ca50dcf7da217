"""Trainings and numbers compared in Python."""

import numpy as np
import pytest

import hexapods as hx


def trainings(alpha: float, seeds: range) -> list[hx.Training]:
    return [
        hx.train("q-learning", simulator="kinematic", steps=60, seed=seed, alpha=alpha)
        for seed in seeds
    ]


def test_trainings_with_the_same_seeds_are_paired() -> None:
    slow, fast = trainings(0.01, range(5)), trainings(0.5, range(5))
    compared = hx.compare(fast, slow, names=("α 0.5", "α 0.01"))
    assert compared.is_paired
    assert compared.a == (
        "α 0.5",
        compared.a.iqm,
        5,
        False,
    )
    middle = sorted(float(training.distance_m or 0) for training in fast)[1:4]
    assert compared.a.iqm.value == pytest.approx(sum(middle) / 3)
    assert "α 0.5" in str(compared)
    assert not hx.compare(fast, trainings(0.01, range(5, 9))).is_paired


def test_numbers_are_compared_and_paired_where_that_is_asked_for() -> None:
    rng = np.random.default_rng(0)
    start = rng.normal(0.4, 0.1, 12)
    after = start + 0.01 + rng.normal(0, 0.002, 12)
    assert hx.compare(after, start.tolist()).ahead == "not established"
    paired = hx.compare(after, start, is_paired=True, rng=np.random.default_rng(3))
    assert paired.ahead == "a"
    assert paired == hx.compare(after, start, is_paired=True, rng=np.random.default_rng(3))


@pytest.mark.parametrize(
    ("a", "b", "said"),
    [
        ([], [0.1], "A has no seed"),
        ([0.1], [0.1, float("nan")], "seed 2 of B is nan"),
        (["far"], [0.1], "A must be trainings or numbers; entry 1 is 'far'"),
    ],
)
def test_what_cannot_be_compared_is_named(a: list[float], b: list[float], said: str) -> None:
    with pytest.raises(hx.InvalidInput, match=said):
        hx.compare(a, b)


def test_trainings_beside_numbers_are_refused() -> None:
    [training] = trainings(0.1, range(1))
    with pytest.raises(hx.InvalidInput, match="both be trainings, or both numbers, which are metr"):
        hx.compare([training], [0.1])
    with pytest.raises(hx.InvalidInput, match="A has trainings beside other values"):
        hx.compare([training, 0.1], [0.1])  # type: ignore[arg-type]
    with pytest.raises(hx.InvalidInput, match="paired by their places, but A has 1 and B 2"):
        hx.compare([0.1], [0.1, 0.2], is_paired=True)
