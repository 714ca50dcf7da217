"""Three clocks that time a race; a lane's time is decision time plus motion time."""

from collections.abc import Mapping
from typing import Literal, NamedTuple, get_args

import numpy as np

from hexapods.domain.errors import UnknownName
from hexapods.domain.types import FloatArray
from hexapods.runs.recording import LaneRecording, LaneSteps, pose_at
from hexapods.runs.step_figures import GrowingArray, Rows

Clock = Literal["paper", "wall", "free"]
"""`paper`: a decision costs a fixed share of a motion for each transition that was simulated;
`wall`: its measured wall time; `free`: nothing."""

CLOCK_TITLES: Mapping[Clock, str] = {
    "paper": "paper clock",
    "wall": "real clock",
    "free": "no clock",
}
CLOCK_SENTENCES: Mapping[Clock, str] = {
    "paper": "Times by the paper clock: a decision takes a fixed share of a motion for each "
    "transition that was simulated.",
    "wall": "Times by the real clock: decisions take as long as was measured.",
    "free": "Times of the motion alone, without decisions.",
}
"""What times in a file are."""
CLOCKS: tuple[Clock, ...] = get_args(Clock)

PAPER_MOTIONS_PER_TRANSITION = 0.03
"""Decision time per simulated transition, in durations of a motion. Fitted to the paper's Table 1:
greedy made 71, 81, 74 and 68 % of its distance at the finish, so its step took 1.36 motions with
12 transitions. Fitted to greedy only."""

FINISH_LINE_M = 0.45

SAME_MOMENT_S = 0.001
"""Times of a run that differ by no more are one moment: pages are told, and name, milliseconds, and
sums of steps' durations differ in their last bits. A step lasts longer."""


def check_clock(name: str) -> None:
    """Check that a clock exists.

    Raises:
        UnknownName: if it does not.
    """
    if name not in CLOCKS:
        raise UnknownName("clock", name, CLOCKS)


def decisions_s(figures: Rows, clock: Clock) -> FloatArray:
    """Return the durations of the steps' decisions under a clock [s], (steps,)."""
    if clock == "free":
        return np.zeros(len(figures))
    if clock == "wall":
        return figures["decision_s"].astype(float)
    return PAPER_MOTIONS_PER_TRANSITION * figures["transitions"] * motions_s(figures)


def motions_s(figures: Rows) -> FloatArray:
    """Return the durations of the steps' motions [s], (steps,)."""
    return figures["motion_s"].astype(float)


class Moment(NamedTuple):
    """Progress of a lane at a time of the race."""

    step: int
    """Index of the current step, from 0; the number of steps taken once the lane has finished."""
    thinking: float
    """Elapsed share of the decision time, 0 to 1; 1 during the motion."""
    motion_s: float
    """Elapsed time of the motion [s]."""


class Timetable:
    """Times at which a lane's decisions and motions end, in race time [s].

    One thread extends it, others read.
    """

    def __init__(self, clock: Clock) -> None:
        """Create the timetable of a lane without steps."""
        self.clock: Clock = clock
        self._times = GrowingArray(np.empty(0, [("thought", "f8"), ("end", "f8")]))

    @classmethod
    def of(cls, steps: LaneSteps, clock: Clock) -> "Timetable":
        """Compute the timetable of the steps taken so far."""
        timetable = cls(clock)
        timetable.extend(steps)
        return timetable

    def extend(self, steps: LaneSteps) -> None:
        """Add the steps of the lane that were taken since."""
        if len(steps) == len(self):
            return
        figures = steps.figures[len(self) :]
        motions = motions_s(figures)
        times = np.empty(len(figures), self._times.rows.dtype)
        # From one step to the next, as if all had been added at once.
        durations = np.append(self.total_s, decisions_s(figures, self.clock) + motions)
        times["end"] = np.cumsum(durations)[1:]
        times["thought"] = times["end"] - motions
        self._times.extend(times)

    def __len__(self) -> int:
        """Number of steps."""
        return len(self._times)

    @property
    def thought(self) -> FloatArray:
        """End of each step's decision, (steps,)."""
        thought: FloatArray = self._times.rows["thought"]
        return thought

    @property
    def ends(self) -> FloatArray:
        """End of each step's motion, (steps,)."""
        ends: FloatArray = self._times.rows["end"]
        return ends

    @property
    def total_s(self) -> float:
        """End of the last step taken so far [s]; 0 without steps."""
        return float(self.ends[-1]) if len(self) else 0.0

    def made(self, time_s: float) -> int:
        """Return the number of steps that have ended at a time of the race [s]."""
        return int(np.searchsorted(self.ends, time_s + SAME_MOMENT_S, side="right"))

    def at(self, time_s: float) -> Moment:
        """Return the lane's progress at a time of the race [s], by binary search."""
        ends = self.ends
        step = int(np.searchsorted(ends, time_s))
        if step == len(ends):
            return Moment(step, 0.0, 0.0)
        start_s, thought = float(ends[step - 1]) if step else 0.0, float(self.thought[step])
        if time_s < thought:
            return Moment(step, (time_s - start_s) / (thought - start_s), 0.0)
        return Moment(step, 1.0, time_s - thought)


def distance_at(lane: LaneRecording, timetable: Timetable, time_s: float) -> float:
    """Return a lane's distance at a time of the race [m], interpolated within a motion."""
    if time_s >= timetable.total_s:
        return lane.distance_m
    step, _, elapsed_s = timetable.at(time_s)
    if elapsed_s == 0.0:
        return float(lane.steps.figures[step - 1]["distance_m"]) if step else 0.0
    return float(pose_at(lane.start_qpos(step), lane.steps[step].motion, elapsed_s)[1])


def crossing_step(lane: LaneRecording, first: int, end: int) -> int | None:
    """Return the first step, from one to before another, that crosses the finish line.

    Steps are counted from 0. None if none does.
    """
    crosses = lane.steps.figures["furthest_m"][first:end] >= FINISH_LINE_M
    return first + int(crosses.argmax()) if crosses.any() else None


def crossing_s(lane: LaneRecording, timetable: Timetable, step: int | None = None) -> float | None:
    """Return the time at which a lane first crosses the finish line [s]; None if it never does.

    Interpolates linearly between the two frames around the crossing.

    Args:
        lane: the recording.
        timetable: of its steps so far.
        step: the `crossing_step`, if it is known.
    """
    if step is None:
        step = crossing_step(lane, 0, len(timetable))
    if step is None:
        return None
    motion = lane.steps[step].motion
    track = motion.qpos[:, 1]
    frame = int((track >= FINISH_LINE_M).argmax())
    before = lane.start_qpos(step)[1] if frame == 0 else track[frame - 1]
    start_s = 0.0 if frame == 0 else float(motion.time_s[frame - 1])
    share = float((FINISH_LINE_M - before) / (track[frame] - before))
    thought = float(timetable.thought[step])
    return thought + start_s + share * (float(motion.time_s[frame]) - start_s)
