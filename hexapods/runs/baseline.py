"""The baseline of a training: the distance of one-step look-ahead, by all that it depends on."""

import hashlib
import json
import platform
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from importlib.metadata import version
from threading import Lock

import numpy as np
from cachetools import LRUCache

from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.records import to_json
from hexapods.domain.world import World
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.version import __version__

_PROBLEM = [field.name for field in fields(WalkingProblem) if field.name != "world"]
_MAX_BASELINES = 256


def baseline_id(config: TrainingConfig, conditions: World) -> str:
    """Return the SHA-256 of all that the distance of the baseline depends on.

    That is the walking problem, the world, the software and the machine's architecture; the seed
    only where there is chance, in the robot's build or in what it senses.

    Args:
        config: of a training.
        conditions: the world in which the baseline walks, a result of `World.as_of`.
    """
    has_chance = config.tolerance > 0 or conditions.one_of(SensorNoise) is not None
    content = {
        **{name: to_json(getattr(config, name)) for name in _PROBLEM},
        "conditions": to_json(conditions),
        "seed": config.seed if has_chance else None,
        "software": _software(),
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


@cache
def _software() -> list[str]:
    return [
        f"racing-hexapods {__version__}",
        f"mujoco {version('mujoco-core')}",
        f"numpy {np.__version__}",
        platform.machine(),
    ]


class Baselines:
    """Distances of baselines that were measured or are known, the newest few hundred. Thread-safe.

    A baseline's walk takes as long in MuJoCo as three hundred steps of practice, and a program that
    trains many seeds would measure the same in each.
    """

    def __init__(self) -> None:
        self._distances_m: LRUCache[str, float] = LRUCache(_MAX_BASELINES)
        self._lock = Lock()

    def get(self, baseline: str) -> float | None:
        """Return the distance of a baseline [m] by its id; None if it is not known."""
        with self._lock:
            return self._distances_m.get(baseline)

    def add(self, distances_m: Mapping[str, float]) -> None:
        """Add distances [m] by the ids of their baselines."""
        with self._lock:
            self._distances_m.update(distances_m)


BASELINES = Baselines()
"""Those of this process."""
