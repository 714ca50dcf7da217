"""Playback of one lane of a race: pose, progress and action values at a given race time."""

from bisect import bisect_right
from operator import itemgetter

import numpy as np

from app.domain.robot import Robot
from app.domain.world import World
from app.runs.clocks import Clock, Moment, Timetable, crossing_s, distance_at
from app.runs.recording import LaneRecording, pose_at
from app.runs.records import ActionValues
from app.runs.results import fell_at_step
from app.stage.stage_frame import ActionValuesView, LaneView

MARCHING_STEPS, MARCHING_M = 10, 0.01


class RaceLane:
    """A lane's recording with its timetable, which is as new as the last `update`.

    Args:
        recording: the recording, which may grow.
        steps: number of steps of the race.
        clock: clock that times the steps.
        robot: the robot that walks.
        world: the world in which it walks.
    """

    def __init__(
        self, recording: LaneRecording, steps: int, clock: Clock, robot: Robot, world: World
    ) -> None:
        self.recording, self.steps = recording, steps
        self._clock, self._robot, self._world = clock, robot, world
        self._fell_at_step: int | None = None
        self._searched = 0
        """Number of steps in which a fall was looked for."""
        self._timetable = Timetable((), ())
        self._crossing_s: float | None = None
        self._range = ValueRange()

    @property
    def all_recorded(self) -> bool:
        """Whether all steps of the lane are recorded."""
        return len(self._timetable.ends) == self.steps

    @property
    def step_ends_s(self) -> tuple[float, ...]:
        """Race times at which the steps recorded so far end [s]."""
        return self._timetable.ends

    @property
    def crossing_s(self) -> float | None:
        """Race time at which it crosses the finish line [s]; None until that is recorded."""
        return self._crossing_s

    @property
    def fell_at_step(self) -> int | None:
        """First step in which it fell, counted from 0; None until that is recorded."""
        return self._fell_at_step

    @property
    def end_s(self) -> float:
        """Race time at the end of the last step recorded so far [s]."""
        return self._timetable.total_s

    def update(self, run_ended: bool) -> None:
        """Extend the timetable by new steps.

        In a long race only by 2 % at a time, since each extension recomputes all of it.

        Args:
            run_ended: whether the run will record no more.
        """
        timed, recorded = len(self._timetable.ends), len(self.recording.steps)
        if recorded > 1.02 * timed or (recorded > timed and (run_ended or recorded == self.steps)):
            self.retime(self._clock)

    def retime(self, clock: Clock) -> None:
        """Recompute the timetable under a clock."""
        self._clock = clock
        self._timetable = Timetable.of(list(self.recording.steps), clock)
        self._crossing_s = None
        if self.recording.distance_m > 0:
            done = len(self._timetable.ends)
            timed = LaneRecording("", self.recording.rest_qpos, self.recording.steps[:done])
            self._crossing_s = crossing_s(timed, self._timetable)
        self._look_for_fall()

    def _look_for_fall(self) -> None:
        recorded = len(self.recording.steps)
        if self._fell_at_step is None:
            self._fell_at_step = fell_at_step(
                self.recording, self._robot, self._world, self._searched
            )
        self._searched = recorded

    def moment_at(self, time_s: float) -> Moment:
        """Return the step, and the part of it, that the lane is in at a race time [s]."""
        return self._timetable.at(time_s)

    def time_of(self, moment: Moment) -> float:
        """Return the race time of a moment [s]: the inverse of `moment_at`."""
        ends = self._timetable.ends
        if moment.step >= len(ends):
            return self.end_s
        began = ends[moment.step - 1] if moment.step else 0.0
        thought = self._timetable.thought[moment.step]
        return began + moment.thinking * (thought - began) + moment.motion_s

    def distance_at(self, time_s: float) -> float:
        """Return the distance along the track at a race time [m]."""
        return distance_at(self.recording, self._timetable, time_s)

    def view(self, time_s: float, complete: bool) -> LaneView:
        """Return the lane as shown at a race time, its pose interpolated.

        Args:
            time_s: race time [s].
            complete: whether the lane will take no further steps.
        """
        moment, lane = self.moment_at(time_s), self.recording
        steps_taken = len(self._timetable.ends)
        computing = not complete and time_s >= self.end_s  # its next decision is not recorded yet
        at_end = complete and time_s >= self.end_s
        if moment.step >= steps_taken or at_end or (computing and steps_taken):
            return self._standing_view(time_s, complete, computing)
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
            fell_at_step=self._fall_before(moment.step),
            action_values=self._action_values(moment.step),
            conditions=self._world.as_of(moment.step),
            pushes=self._world.pushes_at(moment.step),
        )

    def _standing_view(self, time_s: float, complete: bool, computing: bool) -> LaneView:
        """Return the lane at its end, or while its next decision is still being computed."""
        lane, steps_taken = self.recording, len(self._timetable.ends)
        total = lane.steps[steps_taken - 1].transitions if steps_taken else 0
        return LaneView(
            lane.start_qpos(steps_taken),
            min(steps_taken + (not complete), self.steps),
            self.steps,
            lane.steps[steps_taken - 1].distance_m if steps_taken else 0.0,
            thinking=computing and total > 0,
            futures_total=total if computing else 0,
            done=complete,
            crossed=self._crossed(time_s),
            marching=self._marching(steps_taken),
            failure=lane.failure,
            fell_at_step=self._fall_before(steps_taken),
            action_values=self._action_values(steps_taken - 1),
            conditions=self._world.as_of(max(0, steps_taken - complete)),
        )

    def _fall_before(self, steps_taken: int) -> int | None:
        fell = self._fell_at_step
        return fell if fell is not None and fell < steps_taken else None

    def _crossed(self, time_s: float) -> bool:
        return self._crossing_s is not None and time_s >= self._crossing_s

    def _marching(self, steps_taken: int) -> bool:
        """Whether the last `MARCHING_STEPS` of the steps taken gained under `MARCHING_M`."""
        if steps_taken < MARCHING_STEPS:
            return False
        steps = self.recording.steps
        first = steps_taken - MARCHING_STEPS
        start = steps[first - 1].distance_m if first else 0.0
        return steps[steps_taken - 1].distance_m - start < MARCHING_M

    def _action_values(self, step: int) -> ActionValuesView | None:
        step_taken = self.recording.steps[step] if 0 <= step < len(self.recording.steps) else None
        if step_taken is None or step_taken.action_values is None:
            return None
        learned = step_taken.action_values
        for earlier in self.recording.steps[self._range.last_step : step + 1]:
            self._range.include(earlier.step, earlier.action_values)
        low, high = self._range.at(step_taken.step)
        return ActionValuesView(
            learned.values, learned.visits, step_taken.observation, step_taken.action, low, high
        )


class ValueRange:
    """Minimum and maximum of all action values up to a step, and 0: a colour scale.

    They do not depend on the order in which a recording is looked at.
    """

    def __init__(self) -> None:
        self.last_step = 0
        """Number of the last step that is included, from 1."""
        self._changes = [(0, 0.0, 0.0)]
        """Steps at which the range grew, with the range from then on."""

    def include(self, step: int, known: ActionValues | None) -> None:
        """Include the values before a step, NaN ignored; earlier steps have been included."""
        if step <= self.last_step:
            return
        self.last_step = step
        if known is None:
            return
        _, low, high = self._changes[-1]
        lowest, highest = float(np.nanmin(known.values)), float(np.nanmax(known.values))
        if lowest < low or highest > high:
            self._changes.append((step, min(low, lowest), max(high, highest)))

    def at(self, step: int) -> tuple[float, float]:
        """Return (low, high) of the values up to a step."""
        _, low, high = self._changes[bisect_right(self._changes, step, key=itemgetter(0)) - 1]
        return low, high
