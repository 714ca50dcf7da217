"""Estimated duration of a run on this machine: its steps times their measured time."""

import threading
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, zip_longest
from statistics import fmean
from typing import NamedTuple

from cachetools import TTLCache

from app.features.what_if.step_time import TimedSteps, step_s_of
from app.jobs.process_pool import OutOfProcessorTime, ProcessPool
from app.jobs.stopping import Stopping
from app.jobs.submissions import (
    BranchStart,
    LaneStart,
    ManyPractices,
    RaceStart,
    TrainingStart,
    check_training,
    check_walk,
)
from app.jobs.turns import Turns
from hexapods.agents.registry import learns
from hexapods.domain.errors import InvalidInput
from hexapods.domain.sums import ordered_sum
from hexapods.runs.config import RACE_STEPS, TrainingConfig, training_config

MAX_MEASURED = 24
"""Kinds of steps of one run that are timed; others count as the mean of their cost class."""
MAX_CACHED = 256
LIMIT_S = 30.0
"""Processor time for a few steps of each [s]; agents that need more are too slow to be timed."""
CACHED_S = 600.0
"""Lifetime of a cached time of a step [s]: the load of the machine changes."""
MAX_WAITING = 3
"""Requests that wait until their steps are timed; each holds a thread of the server."""


class _CostClass(NamedTuple):
    """Agent and simulator, which dominate a step's time: two-step takes 100 times a table's."""

    agent: str
    simulator: str


class _Part(NamedTuple):
    """A number of steps of one kind."""

    steps: TimedSteps
    number: int
    paced_s: float = 0.0
    """Shortest time of each step, by the pace [s]."""


class Estimates:
    """Estimates durations from timed steps, which are cached for a while. Thread-safe.

    Attributes:
        turns: turns of the requests whose steps are timed.
    """

    def __init__(self, pool: ProcessPool, cores: int, stopping: Stopping | None = None) -> None:
        """Create the service with an empty cache.

        Args:
            pool: times the steps.
            cores: number of jobs or trials that run at once.
            stopping: whether the server stops, or the client has left, for whom no more is timed.
        """
        self._stopping = stopping or Stopping()
        self._pool, self._cores = pool, cores
        self._cache: TTLCache[TimedSteps, float] = TTLCache(MAX_CACHED, CACHED_S)
        self._lock = threading.Lock()
        self.turns = Turns("estimates", MAX_WAITING)

    def of(self, start: TrainingStart | RaceStart | BranchStart | ManyPractices) -> float:
        """Return the estimated duration of a run once it has a core [s].

        Raises:
            InvalidInput: if an agent fails at once, or its steps take too long to be timed; or of a
                race that branches off.
            Busy: if too many requests wait for their turn, or the pool is closed.
        """
        if isinstance(start, ManyPractices):
            return self._all_practices_s(start) / start.at_once(self._cores)
        if isinstance(start, TrainingStart):
            check_training(start.config)
            parts = [*_practice(start.config)]
            return _seconds(parts, self._measured(part.steps for part in parts))
        if isinstance(start, BranchStart):
            raise InvalidInput("a branch takes what is left of its race; leave out branch_from")
        check_walk(start.walk)
        lanes = [_lane(lane, start) for lane in start.lanes]
        trainings = (lane.training for lane in start.lanes if lane.training is not None)
        practices = [[*_practice(training.config)] for training in trainings]
        measured = self._measured(part.steps for part in chain(lanes, *practices))
        alone = [_seconds(parts, measured) for parts in practices]
        at_once = max([*alone, ordered_sum(alone) / self._cores], default=0.0)
        return at_once + _seconds(lanes, measured)

    def workers_of(
        self, start: TrainingStart | RaceStart | BranchStart | ManyPractices
    ) -> int | None:
        """Return the number of practices that are computed at once; None for a training or race."""
        return start.at_once(self._cores) if isinstance(start, ManyPractices) else None

    def close(self) -> None:
        """Shut down the pool."""
        self._pool.close()

    def _all_practices_s(self, start: ManyPractices) -> float:
        """Return the computing time of all practices [s]."""
        parts = [_Part(_kind(config), steps) for config, steps in start.practices()]
        measured = self._measured(_one_per_class_first(part.steps for part in parts))
        by_class: defaultdict[_CostClass, list[float]] = defaultdict(list)
        for steps, step_s in measured.items():
            by_class[_cost_class(steps)].append(step_s)
        return ordered_sum(
            part.number
            * measured.get(
                part.steps, fmean(by_class[_cost_class(part.steps)] or [*measured.values()])
            )
            for part in parts
        )

    def _measured(self, wanted: Iterable[TimedSteps]) -> Mapping[TimedSteps, float]:
        """Return the time of a step of each kind [s], of the first `MAX_MEASURED` kinds."""
        kinds = list(dict.fromkeys(wanted))[:MAX_MEASURED]
        times_s = self._cached(kinds)
        if len(times_s) < len(kinds):
            with self.turns.turn(self._stopping.check):
                # A request that was answered meanwhile may have timed the same.
                times_s = self._cached(kinds)
                missing = [kind for kind in kinds if kind not in times_s]
                times_s |= zip(missing, self._timed(missing), strict=True)
                with self._lock:
                    self._cache.update({kind: times_s[kind] for kind in missing})
        return times_s

    def _timed(self, kinds: Sequence[TimedSteps]) -> Sequence[float]:
        try:
            return self._pool.map(step_s_of, kinds, self._stopping.check, LIMIT_S)
        except OutOfProcessorTime as error:
            agents = ", ".join(dict.fromkeys(kind.training.agent for kind in kinds))
            raise InvalidInput(
                f"a few steps ({agents}) took over {LIMIT_S:g} s of processor time, so the run "
                "would take very long; choose settings with less work in each step"
            ) from error

    def _cached(self, kinds: Iterable[TimedSteps]) -> dict[TimedSteps, float]:
        # At one time for all: what expires between two looks would raise.
        with self._lock, self._cache.timer:
            return {kind: self._cache[kind] for kind in kinds if kind in self._cache}


def _seconds(parts: Iterable[_Part], measured: Mapping[TimedSteps, float]) -> float:
    return ordered_sum(part.number * max(part.paced_s, measured[part.steps]) for part in parts)


def _cost_class(steps: TimedSteps) -> _CostClass:
    return _CostClass(steps.training.agent, steps.training.simulator)


def _one_per_class_first(kinds: Iterable[TimedSteps]) -> list[TimedSteps]:
    """Return the kinds without repetitions: first one of each cost class, then a second one."""
    by_class: defaultdict[_CostClass, list[TimedSteps]] = defaultdict(list)
    for kind in dict.fromkeys(kinds):
        by_class[_cost_class(kind)].append(kind)
    return [kind for kinds in zip_longest(*by_class.values()) for kind in kinds if kind]


def _kind(config: TrainingConfig) -> TimedSteps:
    """Return the kind of a config's steps: only the fields on which their time depends."""
    common = replace(config, seed=0, evaluate_every=0, pace="max", tolerance=0.0)
    practises = learns(config.agent)
    return TimedSteps(replace(common, world=config.world.at_start, steps=200), practises)


def _practice(config: TrainingConfig) -> Iterator[_Part]:
    kind = _kind(config)
    pace = config.pace
    paced_s = 0.0 if pace == "max" else config.robot.step_s / pace
    yield _Part(kind, config.steps, paced_s)
    evaluations = 1 + (config.steps // config.evaluate_every if config.evaluate_every else 0)
    yield _Part(kind, evaluations * RACE_STEPS)


def _lane(lane: LaneStart, start: RaceStart) -> _Part:
    walk = vars(start.walk)
    if lane.training is not None:
        return _Part(_kind(lane.training.config), start.steps)
    return _Part(_kind(training_config(lane.agent, **walk, **lane.settings)), start.steps)
