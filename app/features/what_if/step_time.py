"""The time that a step or a trial of an agent takes on this machine.

A module of its own for the processes that time them: what `estimate` imports besides, such as the
database, takes them longer than the steps.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hexapods.assembly import build_learner, build_walkers
from hexapods.experiments.trial import TrialConfig, TrialResult, run_trial
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import race
from hexapods.runs.records import StepTaken
from hexapods.runs.training import train

MEASURE_S, MEASURED_STEPS = 0.1, 200
"""For how long the steps of an agent are timed at most [s], and how many of them."""
MAX_WAIT_S = 1.0
"""For how long it waits for these on a busy machine [s]."""


@dataclass(frozen=True)
class TimedSteps:
    """Steps of one kind, whose time is measured once.

    Attributes:
        training: agent, settings and walking problem.
        practises: whether the agent learns; else it walks as in a race.
    """

    training: TrainingConfig
    practises: bool


def step_s_of(steps: TimedSteps) -> float:
    """Time the steps of a kind, and return a trimmed mean [s].

    In time of this process, not of the clock on the wall: on a busy machine that would measure how
    long it waits for a core. The first step, which fills caches, counts only if there is no time
    for a second. The slowest tenth is left out.
    """
    records = _practised(steps.training) if steps.practises else _raced(steps.training)
    began_s, moments = time.perf_counter(), [time.process_time()]
    for _ in records:
        moments.append(time.process_time())
        is_long = moments[-1] - moments[0] > MEASURE_S or len(moments) > MEASURED_STEPS
        if is_long or time.perf_counter() - began_s > MAX_WAIT_S:
            break
    durations = np.diff(moments)
    sorted_s = np.sort(durations[1:] if len(durations) > 1 else durations)
    return float(sorted_s[: max(1, len(sorted_s) * 9 // 10)].mean()) if len(sorted_s) else 0.0


def timed_trial(config: TrialConfig) -> tuple[TrialResult, float]:
    """Return the result of a trial, and the time of this process that it took [s]."""
    began_s = time.process_time()
    return run_trial(config), time.process_time() - began_s


def _practised(config: TrainingConfig) -> Iterator[object]:
    records = train(build_learner(config), config)
    return (record for record in records if isinstance(record, StepTaken))


def _raced(config: TrainingConfig) -> Iterator[object]:
    lane = LaneConfig(agent=config.agent, settings=config.settings)
    walk = vars(config.walk())
    problem = RaceConfig(**walk, lanes=(lane,))
    return race(build_walkers(problem, [None]), problem.steps, time.perf_counter)
