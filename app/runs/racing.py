"""The race loop: every lane has its own physics, and no lane's motion depends on thinking time."""

from collections.abc import Callable, Iterator, Sequence
from typing import cast

import numpy as np

from app.domain.errors import Diverged, HexapodError
from app.domain.simulator import Motion
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.runs.records import LaneFailed, LaneStep, RaceRecord
from app.runs.walker import Walker


def race(walkers: Sequence[Walker], steps: int, timer: Callable[[], float]) -> Iterator[RaceRecord]:
    """Walk every lane for `steps` steps, a step of each in turn.

    Args:
        walkers: one for each lane, at rest.
        steps: of each lane.
        timer: seconds, to measure decisions with, such as `time.perf_counter`.
    """
    running = dict(enumerate(walkers))
    for step in range(1, steps + 1):
        for lane, walker in list(running.items()):
            record = _lane_step(lane, step, walker, timer)
            yield record
            if isinstance(record, LaneFailed):
                del running[lane]


def record_race(
    walkers: Sequence[Walker], config: RaceConfig, timer: Callable[[], float]
) -> Iterator[list[LaneRecording]]:
    """Race into a recording, and yield it, grown, after every step of a lane."""
    lanes = [
        LaneRecording(lane.agent, walker.simulator.pose(walker.state).astype(np.float32))
        for lane, walker in zip(config.lanes, walkers, strict=True)
    ]
    for record in race(walkers, config.steps, timer):
        if isinstance(record, LaneFailed):
            lanes[record.lane].failure = record.reason
        else:
            lanes[record.lane].steps.append(record)
        yield lanes


def _lane_step(lane: int, step: int, walker: Walker, timer: Callable[[], float]) -> RaceRecord:
    seen, before = walker.seen, walker.transitions
    try:
        knowledge = walker.knowledge()
        began = timer()
        action = walker.decide()
        decision_s = timer() - began
    except HexapodError as error:
        return LaneFailed(lane, step, str(error))
    except Exception as error:  # an agent of the user's own may raise anything
        return LaneFailed(lane, step, f"its agent failed: {type(error).__name__}: {error}")
    try:
        done = walker.carry_out(action, record=True)
    except Diverged as error:
        return LaneFailed(lane, step, str(error))
    return LaneStep(
        lane,
        step,
        seen,
        action,
        done.reward_m,
        walker.state.distance_m,
        walker.transitions - before,
        decision_s,
        cast(Motion, done.motion),
        knowledge,
    )
