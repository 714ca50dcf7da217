"""Random generators: spawned from one seed, independent, and restorable."""

import numpy as np

from hexapods.runs.seeding import EVALUATION, LEARNING, RACING, dump, generator, load


def draws(*key: int, seed: int = 7) -> list[float]:
    drawn: list[float] = generator(seed, *key).random(4).tolist()
    return drawn


def test_same_key_gives_the_same_numbers() -> None:
    assert draws(RACING, 1) == draws(RACING, 1)


def test_different_keys_give_different_numbers() -> None:
    keys = [(LEARNING,), (EVALUATION,), (RACING,), (RACING, 0), (RACING, 1), (EVALUATION, 50)]

    assert len({tuple(draws(*key)) for key in keys}) == len(keys)
    assert draws(LEARNING, seed=8) != draws(LEARNING, seed=7)


def test_generators_equal_those_of_seed_sequence_spawn() -> None:
    spawned = np.random.SeedSequence(7).spawn(3)[RACING]

    assert np.random.default_rng(spawned).random(4).tolist() == draws(RACING)


def test_generator_continues_from_a_restored_state() -> None:
    rng, copy = generator(1, LEARNING), generator(2, LEARNING)
    rng.random(5)
    load(copy, dump(rng))

    assert copy.random(9).tolist() == rng.random(9).tolist()
