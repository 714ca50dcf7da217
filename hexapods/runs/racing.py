"""Race loop: every lane has its own simulation, independent of measured decision times."""

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from hexapods.agents.explanation import ExplainingSearch
from hexapods.agents.registry import is_memoryless
from hexapods.domain.errors import Diverged, HexapodError
from hexapods.domain.simulator import Motion
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneFailed, LaneStep, RaceRecord
from hexapods.runs.walker import Walker

_logger = logging.getLogger(__name__)


def race(
    walkers: Sequence[Walker],
    steps: int,
    timer: Callable[[], float],
    prefix: Sequence[Sequence[LaneStep]] = (),
) -> Iterator[RaceRecord]:
    """Run every lane for `steps` steps, one step of each in turn (round-robin).

    A lane whose agent raises or whose physics diverges yields `LaneFailed` and stops; the others
    continue. A walker that `keeps_learning` learns from each step before it decides on the next, as
    in a training; the time that this takes is part of that decision.

    Args:
        walkers: one per lane, at rest.
        steps: number of steps of each lane.
        timer: clock in seconds that measures decisions, such as `time.perf_counter`.
        prefix: for each lane the first steps of a race that is the same until then, whose motions
            are not used. A memoryless agent does not search for them again: its actions are
            carried out, and what its decisions took is taken over. From the step on that does not
            repeat, which is logged, a lane decides by itself.
    """
    running: dict[int, tuple[Walker, LaneStep | None]] = {
        lane: (walker, None) for lane, walker in enumerate(walkers)
    }
    repeated = {lane: list(recorded) for lane, recorded in enumerate(prefix)}
    for step in range(1, steps + 1):
        for lane, (walker, last) in list(running.items()):
            shared = repeated.get(lane, [])[step - 1 : step]
            repetition = None
            if shared and is_memoryless(walker.agent):
                repetition = _repeat_step(walker, shared[0])
            record = repetition or _lane_step(lane, step, walker, last, timer)
            if shared and _parts(record, shared[0]):
                del repeated[lane]
                _logger.warning(
                    "lane %d differs from step %d on from the race that it repeats: another "
                    "processor, NumPy or MuJoCo has computed that",
                    lane + 1,
                    step,
                )
            yield record
            if isinstance(record, LaneFailed):
                del running[lane]
            else:
                running[lane] = walker, record


def record_race(
    walkers: Sequence[Walker],
    config: RaceConfig,
    timer: Callable[[], float],
    prefix: Sequence[Sequence[LaneStep]] = (),
) -> Iterator[list[LaneRecording]]:
    """Run a race as `race` does, and yield its recording after each step."""
    lanes = [
        LaneRecording(lane.agent, walker.simulator.pose(walker.state).astype(np.float32))
        for lane, walker in zip(config.lanes, walkers, strict=True)
    ]
    for record in race(walkers, config.steps, timer, prefix):
        if isinstance(record, LaneFailed):
            lanes[record.lane].failure = record.reason
        else:
            lanes[record.lane].steps.append(record)
        yield lanes


def _parts(record: RaceRecord, recorded: LaneStep) -> bool:
    """Whether a step differs from the recorded one that it repeats."""
    if isinstance(record, LaneFailed):
        return True
    return (record.action, record.reward_m) != (recorded.action, recorded.reward_m)


def _repeat_step(walker: Walker, recorded: LaneStep) -> LaneStep | None:
    """Carry out a recorded step's action; None if the robot does not come to the same place."""
    if walker.observed != recorded.observation or recorded.action not in walker.legal:
        return None
    before = walker.state
    outcome = walker.carry_out(recorded.action, record=True, effort=True)
    if outcome.reward_m != recorded.reward_m:
        walker.set_state(before)
        return None
    return replace(recorded, motion=cast(Motion, outcome.motion))


def _lane_step(
    lane: int, step: int, walker: Walker, last: LaneStep | None, timer: Callable[[], float]
) -> RaceRecord:
    """Take a step of a lane; `last` is the one before it, from which the agent may learn first."""
    observation, transitions_before = walker.observed, walker.transitions
    next_action, learning_s = None, 0.0
    try:
        if last is not None and walker.keeps_learning:
            started_s = timer()
            next_action = walker.learn(last.observation, last.action, last.reward_m)
            learning_s = timer() - started_s
        action_values = walker.action_values()
        started_s = timer()
        action = walker.decide() if next_action is None else next_action
        decision_s = learning_s + timer() - started_s
        agent = walker.agent
        futures = tuple(agent.futures()) if isinstance(agent, ExplainingSearch) else ()
    except HexapodError as error:
        return LaneFailed(lane, step, str(error))
    except Exception as error:  # a user-supplied agent may raise anything
        return LaneFailed(lane, step, f"its agent failed: {type(error).__name__}: {error}")
    try:
        outcome = walker.carry_out(action, record=True, effort=True)
    except Diverged as error:
        return LaneFailed(lane, step, str(error))
    return LaneStep(
        lane,
        step,
        observation,
        action,
        outcome.reward_m,
        walker.state.distance_m,
        walker.transitions - transitions_before,
        decision_s,
        cast(Motion, outcome.motion),
        action_values,
        futures,
    )
