"""Chance: one seed, independent generators, and states that can be kept."""

import numpy as np

from app.runs.seeding import EVALUATION, LEARNING, RACING, dump, generator, load


def draws(*key: int, seed: int = 7) -> list[float]:
    drawn: list[float] = generator(seed, *key).random(4).tolist()
    return drawn


def test_the_same_key_draws_the_same() -> None:
    assert draws(RACING, 1) == draws(RACING, 1)


def test_every_purpose_and_lane_draws_its_own() -> None:
    keys = [(LEARNING,), (EVALUATION,), (RACING,), (RACING, 0), (RACING, 1), (EVALUATION, 50)]

    assert len({tuple(draws(*key)) for key in keys}) == len(keys)
    assert draws(LEARNING, seed=8) != draws(LEARNING, seed=7)


def test_generators_are_those_that_the_seed_spawns() -> None:
    spawned = np.random.SeedSequence(7).spawn(3)[RACING]

    assert np.random.default_rng(spawned).random(4).tolist() == draws(RACING)


def test_a_generator_goes_on_from_its_state() -> None:
    rng, copy = generator(1, LEARNING), generator(2, LEARNING)
    rng.random(5)
    load(copy, dump(rng))

    assert copy.random(9).tolist() == rng.random(9).tolist()
