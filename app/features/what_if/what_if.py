"""What-if service: distances over many seeds of a training, and over as many at its defaults."""

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from cachetools import LRUCache

from app.api.answers import ComparisonView, SeedsView
from app.features.what_if.step_time import TimedSteps, step_s_of, timed_trial
from app.jobs.process_pool import OutOfProcessorTime, ProcessPool
from app.jobs.submissions import check_training
from app.jobs.turns import Turns
from hexapods.agents.q_table import table_size
from hexapods.agents.registry import learns
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import SettingValues
from hexapods.domain.sums import ordered_sum
from hexapods.domain.world import check_ends
from hexapods.experiments.plan import trial_seed
from hexapods.experiments.statistics import iqm
from hexapods.experiments.trial import TrialConfig, TrialResult
from hexapods.runs.config import TrainingConfig, training_config

SEEDS = 30
MAX_STEPS = 2_000
MAX_VALUES = 1_200_000
"""Maximum number of values of a Q-table: each trial holds one, and writes it to a file."""
MAX_CACHED = 512
MAX_WAITING = 4
"""Maximum number of what-ifs of operators that wait, and of those of spectators."""
OPERATORS_LIMIT_S, SPECTATORS_LIMIT_S = 60.0, 10.0
"""Time for which one what-if may compute on all cores [s], in processor time: on the clock on the
wall, settings that take a second would count as too heavy on a busy machine."""


@dataclass(frozen=True)
class WhatIfRequester:
    """Client that asks a what-if, with its limits.

    Attributes:
        is_operator: whether it is an operator, whose what-ifs come first and may take longer.
        check: raises once nobody needs the answer any more; called ten times a second.
        charge: called with the cost of a what-if [s]: processor time divided by the number of
            cores; if there is no answer, the time that passed, at most its limit.
    """

    is_operator: bool = True
    check: Callable[[], None] = lambda: None
    charge: Callable[[float], None] = lambda _: None

    @property
    def limit_s(self) -> float:
        """Maximum computing time of a what-if of this client [s]."""
        return OPERATORS_LIMIT_S if self.is_operator else SPECTATORS_LIMIT_S


_OPERATOR = WhatIfRequester()


class WhatIf:
    """Answers what-if requests by kinematic trials, one at a time; bounded cache. Thread-safe."""

    def __init__(self, pool: ProcessPool) -> None:
        """Create the service with an empty cache.

        Args:
            pool: runs the trials.
        """
        self._pool = pool
        self._cache: LRUCache[TrialConfig, tuple[float, ...]] = LRUCache(MAX_CACHED)
        """Cached distances of all seeds [m], by the trial with seed 0."""
        self._turns = Turns("questions", MAX_WAITING)
        self._cache_lock = threading.Lock()

    def ask(
        self, training: TrainingConfig, requester: WhatIfRequester = _OPERATOR
    ) -> ComparisonView:
        """Compute distances after this training, and after the same one with default settings.

        Args:
            training: the training; its simulator, build tolerance, seed, evaluations and pace are
                ignored.
            requester: the client, with its limits.

        Raises:
            InvalidInput, UnknownName, Unreachable: if the training is invalid, or takes too long.
            Busy: if too many requests are waiting, an operator's request goes first, or the pool
                fails.
        """
        _check_limits(training)
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
        distances, compute_s = self._distances([greedy, *trials], requester)
        greedy_m = distances[greedy][0]
        return ComparisonView(
            seeds=SEEDS,
            greedy_m=greedy_m,
            chosen=_summarize(chosen, distances[trials[0]], greedy_m),
            default=_summarize(default, distances[trials[1]], greedy_m),
            compute_s=round(compute_s, 3),
        )

    def close(self) -> None:
        """Shut down the pool."""
        self._pool.close()

    def _distances(
        self, trials: Sequence[TrialConfig], requester: WhatIfRequester
    ) -> tuple[dict[TrialConfig, tuple[float, ...]], float]:
        """Return the distances of all seeds of each trial [m], and the time it took [s]."""
        distances = self._cached(trials)
        if len(distances) == len(set(trials)):
            return distances, 0.0
        with self._turns.turn(requester.check, is_operator=requester.is_operator) as check:
            # A request that was served meanwhile may have cached the same trials.
            distances = self._cached(trials)
            missing = [trial for trial in dict.fromkeys(trials) if trial not in distances]
            began_s, cost_s = time.monotonic(), None
            try:
                self._check_time(missing, requester.limit_s, check)
                computed, cost_s = self._run_trials(missing, check, requester.limit_s)
            except OutOfProcessorTime as error:
                raise _takes_too_long(f"over {requester.limit_s:g} s", requester.limit_s) from error
            finally:
                compute_s = time.monotonic() - began_s
                # Not the clock on the wall: nobody owes for processes that start, or for a busy
                # machine.
                requester.charge(min(compute_s, requester.limit_s) if cost_s is None else cost_s)
            distances |= computed
        with self._cache_lock:
            self._cache.update(distances)
        return distances, compute_s

    def _check_time(
        self, trials: Sequence[TrialConfig], limit_s: float, check: Callable[[], None]
    ) -> None:
        """Time a few steps of each learner.

        Raises:
            InvalidInput: if all steps would take too long. Later ones may take longer than these.
            OutOfProcessorTime: if even a few do.
        """
        trainings = [trial.training for trial in trials if trial.blocks]
        kinds = [TimedSteps(training, practises=True) for training in trainings]
        times_s = self._pool.map(step_s_of, kinds, check, limit_s * self._pool.count)
        work_s = ordered_sum(
            SEEDS * training.steps * step_s
            for training, step_s in zip(trainings, times_s, strict=True)
        )
        if (total_s := work_s / self._pool.count) > limit_s:
            raise _takes_too_long(f"about {total_s:,.0f} s", limit_s)

    def _run_trials(
        self, missing: Sequence[TrialConfig], check: Callable[[], None], limit_s: float
    ) -> tuple[dict[TrialConfig, tuple[float, ...]], float]:
        """Return the distances of all seeds of each trial [m], and their cost [s]."""
        trials = [(trial, seeded) for trial in missing for seeded in _with_seeds(trial)]
        seeded_trials = [seeded for _, seeded in trials]
        limit_s *= self._pool.count
        results = self._pool.map(timed_trial, seeded_trials, check, limit_s)
        distances: dict[TrialConfig, tuple[float, ...]] = dict.fromkeys(missing, ())
        for (trial, _), (result, _) in zip(trials, results, strict=True):
            distances[trial] += (_distance_m(result),)
        return distances, ordered_sum(cpu_s for _, cpu_s in results) / self._pool.count

    def _cached(self, trials: Sequence[TrialConfig]) -> dict[TrialConfig, tuple[float, ...]]:
        with self._cache_lock:
            return {trial: self._cache[trial] for trial in trials if trial in self._cache}


def _check_limits(training: TrainingConfig) -> None:
    if not learns(training.agent):
        raise InvalidInput(f"{training.agent} does not learn, so nothing can be changed about it")
    if training.steps > MAX_STEPS:
        raise InvalidInput(
            f"a what-if practises at most {MAX_STEPS:,} steps, not {training.steps:,}"
        )
    check_training(training)
    check_ends(training.world.disturbances, training.steps)
    values = table_size(len(training.resolved_gait.groups), len(training.grid))
    if values > MAX_VALUES:
        raise InvalidInput(
            f"a table of {values:,} values is too large for a what-if, which takes "
            f"{MAX_VALUES:,}; choose fewer divisions or fewer legs"
        )


def _takes_too_long(how_long: str, limit_s: float) -> InvalidInput:
    return InvalidInput(
        f"this would take {how_long} here, and a what-if may take {limit_s:g} s; choose fewer "
        "steps, or settings with less work in each step"
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
) -> SeedsView:
    """Return the distances of the seeds; those that reach half of greedy's distance walk."""
    walkers = sum(distance >= greedy_m / 2 for distance in distances_m)
    return SeedsView(
        settings=dict(config.settings),
        steps_per_episode=config.steps_per_episode,
        distances_m=list(distances_m),
        walkers=walkers / len(distances_m),
        iqm_m=float(iqm(np.array(distances_m))),
    )
