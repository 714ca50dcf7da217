"""The what-if service: many seeds of a training, beside as many at the default values."""

import threading
import time
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from app.agents.registry import learns
from app.domain.errors import InvalidInput
from app.domain.settings import SettingValues
from app.experiments.plan import trial_seed
from app.experiments.trial import TrialConfig, TrialResult
from app.jobs.submissions import check_walk
from app.runs.config import TrainingConfig, training_config
from app.storage.errors import Busy
from app.what_if.trial_pool import TrialPool

SEEDS = 30
MAX_STEPS = 2_000
MAX_VALUES = 1_200_000
"""Of a table: each trial has one, and writes it to a file."""
MAX_WAITING = 4
MAX_CACHED = 512


class WhatIf:
    """Answers by kinematic trials, one question at a time. Safe to use from any thread."""

    def __init__(self, pool: TrialPool) -> None:
        """Create the service; no process is started yet.

        Args:
            pool: runs the trials.
        """
        self._pool = pool
        self._known: OrderedDict[TrialConfig, tuple[float, ...]] = OrderedDict()
        """By what is tried, with seed 0: how far each seed came [m]."""
        self._turn = threading.Lock()
        self._guard = threading.Lock()
        self._waiting = 0

    def ask(self, training: TrainingConfig) -> dict[str, Any]:
        """How far the learner comes after this practice, and after that of the default values.

        Args:
            training: its simulator, its seed, and what it shows meanwhile do not count.

        Returns:
            `seeds`, `greedy_m`, `chosen` and `default` with `distances_m`, `walkers` (the share
            that covers at least half of greedy's distance), `iqm_m`, the agent's settings and
            `steps_per_episode`; `compute_s`.

        Raises:
            InvalidInput, UnknownName, Unreachable: if it cannot be tried.
            Busy: if too many are waiting.
        """
        _check(training)
        began_s = time.perf_counter()
        chosen = replace(training, simulator="kinematic", seed=0, evaluate_every=0, pace="max")
        default = replace(
            chosen,
            settings=training_config(gait=chosen.gait, agent=chosen.agent).settings,
            steps_per_episode=TrainingConfig.steps_per_episode,
        )
        walked = replace(default, agent="greedy", settings=SettingValues(), steps=1)
        greedy = TrialConfig(training=walked, blocks=0)
        halves = [TrialConfig(training=half) for half in (chosen, default)]
        found = self._distances([greedy, *halves])
        greedy_m = found[greedy][0]
        return {
            "seeds": SEEDS,
            "greedy_m": greedy_m,
            "chosen": _half(chosen, found[halves[0]], greedy_m),
            "default": _half(default, found[halves[1]], greedy_m),
            "compute_s": round(time.perf_counter() - began_s, 3),
        }

    def close(self) -> None:
        """Let its processes go."""
        self._pool.close()

    def _distances(self, wanted: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        found = self._cached(wanted)
        if len(found) == len(set(wanted)):
            return found
        with self._guard:
            if self._waiting >= MAX_WAITING:
                raise Busy(f"{MAX_WAITING} questions are waiting; ask again later", 2)
            self._waiting += 1
        try:
            with self._turn:
                # An earlier request may have tried the same.
                found = self._cached(wanted)
                found |= self._tried([one for one in dict.fromkeys(wanted) if one not in found])
        finally:
            with self._guard:
                self._waiting -= 1
        self._remember(found)
        return found

    def _tried(self, missing: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        trials = [(one, seeded) for one in missing for seeded in _seeded(one)]
        results = self._pool.run([seeded for _, seeded in trials])
        found: dict[TrialConfig, tuple[float, ...]] = dict.fromkeys(missing, ())
        for (one, _), result in zip(trials, results, strict=True):
            found[one] += (_distance_m(result),)
        return found

    def _cached(self, wanted: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        with self._guard:
            return {one: self._known[one] for one in wanted if one in self._known}

    def _remember(self, found: dict[TrialConfig, tuple[float, ...]]) -> None:
        with self._guard:
            for one, distances in found.items():
                self._known[one] = distances
                self._known.move_to_end(one)
            while len(self._known) > MAX_CACHED:
                self._known.popitem(last=False)


def _check(training: TrainingConfig) -> None:
    if not learns(training.agent):
        raise InvalidInput(f"{training.agent} does not learn, so nothing can be changed about it")
    if training.steps > MAX_STEPS:
        raise InvalidInput(
            f"a what-if practises at most {MAX_STEPS:,} steps, not {training.steps:,}"
        )
    check_walk(training)
    pairs, cells = len(training.resolved_gait.pairs), len(training.grid)
    values = cells**pairs * pairs * cells
    if values > MAX_VALUES:
        raise InvalidInput(
            f"a table of {values:,} values is too large for a what-if, which takes "
            f"{MAX_VALUES:,}; choose fewer divisions or fewer legs"
        )


def _seeded(config: TrialConfig) -> list[TrialConfig]:
    """Once a seed, or once if there is no practice."""
    numbers = range(SEEDS if config.blocks else 1)
    return [
        replace(config, training=replace(config.training, seed=trial_seed(0, 0, number)))
        for number in numbers
    ]


def _distance_m(result: TrialResult) -> float:
    if result.failure is not None:
        raise InvalidInput(f"it cannot be tried: {result.failure}")
    return result.distances_m[-1]


def _half(
    config: TrainingConfig, distances_m: tuple[float, ...], greedy_m: float
) -> dict[str, Any]:
    walkers = sum(distance >= greedy_m / 2 for distance in distances_m)
    return {
        **config.settings,
        "steps_per_episode": config.steps_per_episode,
        "distances_m": list(distances_m),
        "walkers": walkers / len(distances_m),
        "iqm_m": _interquartile_mean(distances_m),
    }


def _interquartile_mean(values: Sequence[float]) -> float:
    """As `scipy.stats.trim_mean(values, 0.25)`, without SciPy in the server."""
    cut, ordered = int(0.25 * len(values)), np.sort(values)
    return float(ordered[cut : len(values) - cut].mean())
