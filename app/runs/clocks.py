"""Three clocks that time a race; a lane's time is decision time plus motion time."""

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
"""Decision time per simulated transition, in durations of a motion. Fitted to the paper's Table 1:
greedy made 71, 81, 74 and 68 % of its distance at the finish, so its step took 1.36 motions with
12 transitions. Fitted to greedy only."""

FINISH_LINE_M = 0.45


def check_clock(name: str) -> None:
    """Check that a clock exists.

    Raises:
        UnknownName: if it does not.
    """
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
    """Return the duration of a step's motion [s]."""
    return float(step.motion.time_s[-1])


class Moment(NamedTuple):
    """Progress of a lane at a time of the race."""

    step: int
    """Index of the current step, from 0; the number of steps taken once the lane has finished."""
    thinking: float
    """Elapsed share of the decision time, 0 to 1; 1 during the motion."""
    motion_s: float
    """Elapsed time of the motion [s]."""


@dataclass(frozen=True)
class Timetable:
    """Times at which a lane's decisions and motions end, in race time [s].

    Attributes:
        thought: end of each step's decision, (steps,).
        ends: end of each step's motion, (steps,).
    """

    thought: tuple[float, ...]
    ends: tuple[float, ...]

    @classmethod
    def of(cls, steps: Sequence[LaneStep], clock: Clock) -> "Timetable":
        """Compute the timetable of the steps taken so far."""
        ends = tuple(accumulate(decision_s(s, clock) + motion_s(s) for s in steps))
        thought = tuple(end - motion_s(s) for end, s in zip(ends, steps, strict=True))
        return cls(thought, ends)

    @property
    def total_s(self) -> float:
        """End of the last step taken so far [s]; 0 without steps."""
        return self.ends[-1] if self.ends else 0.0

    def at(self, time_s: float) -> Moment:
        """Return the lane's progress at a time of the race [s], by binary search."""
        step = bisect_left(self.ends, time_s)
        if step == len(self.ends):
            return Moment(step, 0.0, 0.0)
        start_s, thought = self.ends[step - 1] if step else 0.0, self.thought[step]
        if time_s < thought:
            return Moment(step, (time_s - start_s) / (thought - start_s), 0.0)
        return Moment(step, 1.0, time_s - thought)


def distance_at(lane: LaneRecording, timetable: Timetable, time_s: float) -> float:
    """Return a lane's distance at a time of the race [m], interpolated within a motion."""
    if time_s >= timetable.total_s:
        return lane.distance_m
    step, _, elapsed_s = timetable.at(time_s)
    if elapsed_s == 0.0:
        return lane.steps[step - 1].distance_m if step else 0.0
    return float(pose_at(lane.start_qpos(step), lane.steps[step].motion, elapsed_s)[1])


def crossing_s(lane: LaneRecording, timetable: Timetable) -> float | None:
    """Return the time at which a lane first crosses the finish line [s]; None if it never does.

    Interpolates linearly between the two frames around the crossing.
    """
    for step, (lane_step, thought) in enumerate(zip(lane.steps, timetable.thought, strict=True)):
        track = lane_step.motion.qpos[:, 1]
        if track.max() < FINISH_LINE_M:
            continue
        frame = int((track >= FINISH_LINE_M).argmax())
        before = lane.start_qpos(step)[1] if frame == 0 else track[frame - 1]
        start_s = 0.0 if frame == 0 else float(lane_step.motion.time_s[frame - 1])
        share = float((FINISH_LINE_M - before) / (track[frame] - before))
        return thought + start_s + share * (float(lane_step.motion.time_s[frame]) - start_s)
    return None
