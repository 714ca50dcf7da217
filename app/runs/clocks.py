"""One race, timed under three clocks. A lane's time is decision time plus motion time."""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Literal, NamedTuple, get_args

from app.domain.errors import UnknownName
from app.runs.recording import LaneRecording, pose_at
from app.runs.records import LaneStep

Clock = Literal["paper", "wall", "free"]
"""`paper`: a decision costs a fixed share of a motion for each transition that was simulated;
`wall`: its measured wall time; `free`: nothing."""

CLOCKS: tuple[Clock, ...] = get_args(Clock)

PAPER_MOTIONS_PER_TRANSITION = 0.03
"""Fitted to the paper's Table 1: greedy made 71, 81, 74 and 68 % of its distance at the finish, so
its step took 1.36 motions with 12 transitions. Fitted to greedy only."""

FINISH_LINE_M = 0.45


def check_clock(name: str) -> None:
    """Raise `UnknownName` unless this is a clock."""
    if name not in CLOCKS:
        raise UnknownName("clock", name, CLOCKS)


def decision_s(step: LaneStep, clock: Clock) -> float:
    """Return the duration of a step's decision under a clock [s]."""
    if clock == "free":
        return 0.0
    if clock == "wall":
        return step.decision_s
    return PAPER_MOTIONS_PER_TRANSITION * step.transitions * motion_s(step)


def motion_s(step: LaneStep) -> float:
    """How long a step's motion lasts [s]."""
    return float(step.motion.time_s[-1])


class Moment(NamedTuple):
    """Where a lane is in its own course at a time of the race."""

    step: int
    """The step it is in, counted from 0; the number of steps taken once it is done."""
    thinking: float
    """The share of the decision that is done; 1 once it moves."""
    motion_s: float
    """How far into the motion it is [s]."""


@dataclass(frozen=True)
class Timetable:
    """When a lane thinks and moves, in race time [s].

    Attributes:
        thought: when each step's decision is made, (steps,).
        ends: when each step's motion is over, (steps,).
    """

    thought: tuple[float, ...]
    ends: tuple[float, ...]

    @classmethod
    def of(cls, steps: Sequence[LaneStep], clock: Clock) -> "Timetable":
        """The timetable of the steps taken so far."""
        ends = tuple(accumulate(decision_s(s, clock) + motion_s(s) for s in steps))
        thought = tuple(end - motion_s(s) for end, s in zip(ends, steps, strict=True))
        return cls(thought, ends)

    @property
    def total_s(self) -> float:
        """When the last step taken so far is over."""
        return self.ends[-1] if self.ends else 0.0

    def at(self, time_s: float) -> Moment:
        """Where the lane is at a time of the race."""
        step = bisect_left(self.ends, time_s)
        if step == len(self.ends):
            return Moment(step, 0.0, 0.0)
        began, thought = self.ends[step - 1] if step else 0.0, self.thought[step]
        if time_s < thought:
            return Moment(step, (time_s - began) / (thought - began), 0.0)
        return Moment(step, 1.0, time_s - thought)


def distance_at(lane: LaneRecording, timetable: Timetable, time_s: float) -> float:
    """How far a lane is at a time of the race, in the middle of a motion if need be [m]."""
    if time_s >= timetable.total_s:
        return lane.distance_m
    step, _, into = timetable.at(time_s)
    if into == 0.0:
        return lane.steps[step - 1].distance_m if step else 0.0
    return float(pose_at(lane.start_qpos(step), lane.steps[step].motion, into)[1])


def crossing_s(lane: LaneRecording, timetable: Timetable) -> float | None:
    """When a lane first crosses the red line [s]; None if it never does."""
    for step, (taken, thought) in enumerate(zip(lane.steps, timetable.thought, strict=True)):
        track = taken.motion.qpos[:, 1]
        if track.max() < FINISH_LINE_M:
            continue
        frame = int((track >= FINISH_LINE_M).argmax())
        before = lane.start_qpos(step)[1] if frame == 0 else track[frame - 1]
        began = 0.0 if frame == 0 else float(taken.motion.time_s[frame - 1])
        share = float((FINISH_LINE_M - before) / (track[frame] - before))
        return thought + began + share * (float(taken.motion.time_s[frame]) - began)
    return None
