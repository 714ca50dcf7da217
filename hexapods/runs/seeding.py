"""Independent random generators, spawned from a run's seed (`SeedSequence`)."""

import json
from typing import Any

import numpy as np

LEARNING, EVALUATION, RACING, SENSING, BUILDING = range(5)


def generator(seed: int, *key: int) -> np.random.Generator:
    """Create the generator for a spawn key, such as (RACING, lane); as by `SeedSequence.spawn`."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))


def dump(rng: np.random.Generator) -> str:
    """Encode a generator's complete state as JSON."""
    return json.dumps(rng.bit_generator.state)


def load(rng: np.random.Generator, state: str) -> None:
    """Set a generator to a state that `dump` encoded."""
    decoded: dict[str, Any] = json.loads(state)
    rng.bit_generator.state = decoded
