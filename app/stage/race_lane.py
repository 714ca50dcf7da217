"""One lane of a race as it is shown: where it is, what it does, what it knows at a time."""

import numpy as np

from app.domain.types import FloatArray
from app.runs.clocks import Clock, Moment, Timetable, crossing_s, distance_at
from app.runs.recording import LaneRecording, pose_at
from app.stage.stage_frame import ActionValuesView, LaneView

MARCHING_STEPS, MARCHING_M = 10, 0.01


class RaceLane:
    """A lane's recording with its timetable, both up to date as of the last `look`."""

    def __init__(self, recording: LaneRecording, steps: int, clock: Clock) -> None:
        self.recording, self.steps = recording, steps
        self._clock = clock
        self._timetable = Timetable((), ())
        self._crossing_s: float | None = None
        self._range = ValueRange()

    @property
    def walked_all(self) -> bool:
        """Whether it has used all its steps."""
        return len(self._timetable.ends) == self.steps

    @property
    def end_s(self) -> float:
        """Race time at the end of its last step so far."""
        return self._timetable.total_s

    def look(self, over: bool) -> None:
        """Take in what was recorded since; of a long race not each step at once."""
        known, recorded = len(self._timetable.ends), len(self.recording.steps)
        if recorded > 1.02 * known or (recorded > known and (over or recorded == self.steps)):
            self.retime(self._clock)

    def retime(self, clock: Clock) -> None:
        """Time its steps by a clock."""
        self._clock = clock
        self._timetable = Timetable.of(list(self.recording.steps), clock)
        self._crossing_s = None
        if self.recording.distance_m > 0:
            done = len(self._timetable.ends)
            known = LaneRecording("", self.recording.rest_qpos, self.recording.steps[:done])
            self._crossing_s = crossing_s(known, self._timetable)

    def at(self, time_s: float) -> Moment:
        """Where it is in its own course."""
        return self._timetable.at(time_s)

    def time_of(self, moment: Moment) -> float:
        """When it is there, the inverse of `at`."""
        ends = self._timetable.ends
        if moment.step >= len(ends):
            return self.end_s
        began = ends[moment.step - 1] if moment.step else 0.0
        thought = self._timetable.thought[moment.step]
        return began + moment.thinking * (thought - began) + moment.motion_s

    def distance_at(self, time_s: float) -> float:
        """How far along the track it is [m]."""
        return distance_at(self.recording, self._timetable, time_s)

    def view(self, time_s: float, complete: bool) -> LaneView:
        """What is to be seen of it.

        Args:
            time_s: of the race.
            complete: whether it will take no further steps.
        """
        moment, lane = self.at(time_s), self.recording
        taken = len(self._timetable.ends)
        behind = not complete and time_s >= self.end_s  # it still computes, in earnest
        at_end = complete and time_s >= self.end_s
        if moment.step >= taken or at_end or (behind and taken):
            return self._still(time_s, complete, behind)
        step = lane.steps[moment.step]
        start = lane.start_qpos(moment.step)
        moves = moment.motion_s > 0 or moment.thinking >= 1
        return LaneView(
            pose_at(start, step.motion, moment.motion_s) if moves else start,
            moment.step + 1,
            self.steps,
            self.distance_at(time_s),
            thinking=not moves and step.transitions > 0,
            futures=round(min(moment.thinking, 1.0) * step.transitions),
            futures_total=step.transitions,
            crossed=self._crossed(time_s),
            marching=self._marching(moment.step),
            knowledge=self._knowledge(moment.step),
        )

    def _still(self, time_s: float, complete: bool, behind: bool) -> LaneView:
        """At its end, or waiting for its own next decision."""
        lane, taken = self.recording, len(self._timetable.ends)
        total = lane.steps[taken - 1].transitions if taken else 0
        return LaneView(
            lane.start_qpos(taken),
            min(taken + (not complete), self.steps),
            self.steps,
            lane.steps[taken - 1].distance_m if taken else 0.0,
            thinking=behind and total > 0,
            futures_total=total if behind else 0,
            done=complete,
            crossed=self._crossed(time_s),
            marching=self._marching(taken),
            failure=lane.failure,
            knowledge=self._knowledge(taken - 1),
        )

    def _crossed(self, time_s: float) -> bool:
        return self._crossing_s is not None and time_s >= self._crossing_s

    def _marching(self, taken: int) -> bool:
        """Whether it gained next to nothing in the last ten of the steps taken."""
        if taken < MARCHING_STEPS:
            return False
        steps = self.recording.steps
        before = taken - MARCHING_STEPS
        start = steps[before - 1].distance_m if before else 0.0
        return steps[taken - 1].distance_m - start < MARCHING_M

    def _knowledge(self, step: int) -> ActionValuesView | None:
        taken = self.recording.steps[step] if 0 <= step < len(self.recording.steps) else None
        if taken is None or taken.knowledge is None:
            return None
        known = taken.knowledge
        low, high = self._range.including(known.values)
        return ActionValuesView(
            known.values, known.visits, taken.observation, taken.action, low, high
        )


class ValueRange:
    """The ends of a colour scale: it grows with what is shown, so colours keep their meaning."""

    def __init__(self) -> None:
        self._low = self._high = 0.0

    def including(self, values: FloatArray) -> tuple[float, float]:
        """The range, with these values in it."""
        self._low = min(self._low, float(np.nanmin(values)))
        self._high = max(self._high, float(np.nanmax(values)))
        return self._low, self._high
