"""What-if service: distances over many seeds of a training, and over as many at its defaults."""

import threading
import time
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from app.agents.q_table import table_size
from app.agents.registry import learns
from app.domain.errors import InvalidInput
from app.domain.settings import SettingValues
from app.domain.world import check_ends
from app.experiments.plan import trial_seed
from app.experiments.trial import TrialConfig, TrialResult, run_trial
from app.jobs.process_pool import ProcessPool
from app.jobs.submissions import check_training
from app.runs.config import TrainingConfig, training_config
from app.storage.errors import Busy

SEEDS = 30
MAX_STEPS = 2_000
MAX_VALUES = 1_200_000
"""Maximum number of values of a Q-table: each trial holds one, and writes it to a file."""
MAX_WAITING = 4
MAX_CACHED = 512


class WhatIf:
    """Answers what-if requests by kinematic trials, one at a time; bounded cache. Thread-safe."""

    def __init__(self, pool: ProcessPool) -> None:
        """Create the service with an empty cache.

        Args:
            pool: runs the trials.
        """
        self._pool = pool
        self._cache: OrderedDict[TrialConfig, tuple[float, ...]] = OrderedDict()
        """Cached distances of all seeds [m], by the trial with seed 0; oldest evicted first."""
        self._pool_lock = threading.Lock()
        self._state_lock = threading.Lock()
        self._waiting = 0

    def ask(self, training: TrainingConfig) -> dict[str, Any]:
        """Compute distances after this training, and after the same one with default settings.

        Args:
            training: the training; its simulator, build tolerance, seed, evaluations and pace are
                ignored.

        Returns:
            `seeds`, `greedy_m`, `chosen` and `default` with `distances_m`, `walkers` (the share
            of seeds with at least half of greedy's distance), `iqm_m` (interquartile mean), the
            agent's settings and `steps_per_episode`; `compute_s`.

        Raises:
            InvalidInput, UnknownName, Unreachable: if the training is invalid or too large.
            Busy: if too many requests are waiting, or the pool fails.
        """
        _check_limits(training)
        began_s = time.perf_counter()
        chosen = replace(
            training, simulator="kinematic", tolerance=0.0, seed=0, evaluate_every=0, pace="max"
        )
        default = replace(
            chosen,
            settings=training_config(gait=chosen.gait, agent=chosen.agent).settings,
            steps_per_episode=TrainingConfig.steps_per_episode,
        )
        # It walks in the world as it is in the end, in which the learners are evaluated.
        world = chosen.world.as_of(chosen.steps)
        greedy_training = replace(
            default, agent="greedy", settings=SettingValues(), steps=1, world=world
        )
        greedy = TrialConfig(training=greedy_training, blocks=0)
        trials = [TrialConfig(training=variant) for variant in (chosen, default)]
        distances = self._distances([greedy, *trials])
        greedy_m = distances[greedy][0]
        return {
            "seeds": SEEDS,
            "greedy_m": greedy_m,
            "chosen": _summarize(chosen, distances[trials[0]], greedy_m),
            "default": _summarize(default, distances[trials[1]], greedy_m),
            "compute_s": round(time.perf_counter() - began_s, 3),
        }

    def close(self) -> None:
        """Shut down the pool."""
        self._pool.close()

    def _distances(self, trials: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        distances = self._cached(trials)
        if len(distances) == len(set(trials)):
            return distances
        with self._state_lock:
            if self._waiting >= MAX_WAITING:
                raise Busy(f"{MAX_WAITING} questions are waiting; ask again later", 2)
            self._waiting += 1
        try:
            with self._pool_lock:
                # A request that was served meanwhile may have cached the same trials.
                distances = self._cached(trials)
                distances |= self._run_trials(
                    [one for one in dict.fromkeys(trials) if one not in distances]
                )
        finally:
            with self._state_lock:
                self._waiting -= 1
        self._store(distances)
        return distances

    def _run_trials(self, missing: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        trials = [(one, seeded) for one in missing for seeded in _with_seeds(one)]
        results = self._pool.map(run_trial, [seeded for _, seeded in trials])
        distances: dict[TrialConfig, tuple[float, ...]] = dict.fromkeys(missing, ())
        for (one, _), result in zip(trials, results, strict=True):
            distances[one] += (_distance_m(result),)
        return distances

    def _cached(self, trials: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        with self._state_lock:
            return {one: self._cache[one] for one in trials if one in self._cache}

    def _store(self, distances: dict[TrialConfig, tuple[float, ...]]) -> None:
        with self._state_lock:
            for one, of_seeds in distances.items():
                self._cache[one] = of_seeds
                self._cache.move_to_end(one)
            while len(self._cache) > MAX_CACHED:
                self._cache.popitem(last=False)


def _check_limits(training: TrainingConfig) -> None:
    if not learns(training.agent):
        raise InvalidInput(f"{training.agent} does not learn, so nothing can be changed about it")
    if training.steps > MAX_STEPS:
        raise InvalidInput(
            f"a what-if practises at most {MAX_STEPS:,} steps, not {training.steps:,}"
        )
    check_training(training)
    check_ends(training.world.disturbances, training.steps)
    values = table_size(len(training.resolved_gait.pairs), len(training.grid))
    if values > MAX_VALUES:
        raise InvalidInput(
            f"a table of {values:,} values is too large for a what-if, which takes "
            f"{MAX_VALUES:,}; choose fewer divisions or fewer legs"
        )


def _with_seeds(config: TrialConfig) -> list[TrialConfig]:
    """Return a copy of a trial for each seed; a single one without practice."""
    numbers = range(SEEDS if config.blocks else 1)
    return [
        replace(config, training=replace(config.training, seed=trial_seed(0, 0, number)))
        for number in numbers
    ]


def _distance_m(result: TrialResult) -> float:
    if result.failure is not None:
        raise InvalidInput(f"it cannot be tried: {result.failure}")
    return result.distances_m[-1]


def _summarize(
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
    """Return the interquartile mean, as `scipy.stats.trim_mean(values, 0.25)`.

    The server does not import SciPy.
    """
    cut, ordered = int(0.25 * len(values)), np.sort(values)
    return float(ordered[cut : len(values) - cut].mean())
