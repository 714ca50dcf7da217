"""The race loop: every lane has its own physics, and no lane's motion depends on thinking time."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, cast

from app.agents.protocol import Agent
from app.domain.errors import Diverged
from app.domain.simulator import Motion
from app.domain.types import Action
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


def _lane_step(lane: int, step: int, walker: Walker, timer: Callable[[], float]) -> RaceRecord:
    seen, knowledge = walker.seen, walker.knowledge()
    before, began = walker.transitions, timer()
    try:
        action = walker.decide()
    except Exception as error:  # an agent of the user's own may raise anything
        return LaneFailed(lane, step, f"its agent failed: {type(error).__name__}: {error}")
    decision_s = timer() - began
    if action not in walker.legal:
        return LaneFailed(lane, step, _illegal(action, walker.agent))
    try:
        done = walker.carry_out(Action(*action), record=True)
    except Diverged as error:
        return LaneFailed(lane, step, str(error))
    return LaneStep(
        lane,
        step,
        seen,
        Action(*action),
        done.reward_m,
        walker.state.distance_m,
        walker.transitions - before,
        decision_s,
        cast(Motion, done.motion),
        knowledge,
    )


def _illegal(action: Any, agent: Agent) -> str:
    return f"{type(agent).__name__} chose {action!r}, which is not a legal action here"
