"""Independent generators, spawned from a run's one seed."""

import json
from typing import Any

import numpy as np

LEARNING, EVALUATION, RACING = range(3)


def generator(seed: int, *key: int) -> np.random.Generator:
    """The generator of one purpose, such as (RACING, lane); the same as by SeedSequence.spawn."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def dump(rng: np.random.Generator) -> str:
    """A generator's whole state as JSON."""
    return json.dumps(rng.bit_generator.state)


def load(rng: np.random.Generator, state: str) -> None:
    """Put a generator into the state that `dump` wrote."""
    read: dict[str, Any] = json.loads(state)
    rng.bit_generator.state = read
