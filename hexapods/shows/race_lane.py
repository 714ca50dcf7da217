"""Playback of one lane of a race: pose, progress and action values at a given race time."""

from hexapods.domain.robot import Robot
from hexapods.domain.world import World
from hexapods.runs.clocks import Clock, Moment, Timetable, crossing_s, crossing_step, distance_at
from hexapods.runs.recording import LaneRecording, pose_at
from hexapods.runs.results import fell_at_step
from hexapods.shows.stage_frame import ActionValuesView, LaneFrame

MARCHING_STEPS, MARCHING_M = 10, 0.01


class RaceLane:
    """A lane's recording with its timetable, which is as new as the last `update`.

    Args:
        recording: the recording, which may grow.
        steps: number of steps of the race.
        clock: clock that times the steps.
        robot: the robot that walks.
        world: the world in which it walks.

    Attributes:
        timetable: race times of the steps recorded so far.
        crossing_s: race time at which it crosses the finish line [s]; None until that is recorded.
        fell_at_step: first step in which it fell, counted from 0; None until that is recorded.
    """

    def __init__(
        self, recording: LaneRecording, steps: int, clock: Clock, robot: Robot, world: World
    ) -> None:
        self.recording, self.steps = recording, steps
        self._robot, self._world = robot, world
        self.timetable = Timetable(clock)
        self._searched = 0
        """Number of steps in which a crossing and a fall were looked for."""
        self.crossing_step: int | None = None
        self.crossing_s: float | None = None
        self.fell_at_step: int | None = None

    @property
    def all_recorded(self) -> bool:
        """Whether all steps of the lane are recorded."""
        return len(self.timetable) == self.steps

    @property
    def is_over(self) -> bool:
        """Whether the lane can take no further steps: all are recorded, or it has failed."""
        return self.all_recorded or self.recording.failure is not None

    @property
    def end_s(self) -> float:
        """Race time at the end of the last step recorded so far [s]."""
        return self.timetable.total_s

    def update(self) -> None:
        """Extend the timetable by new steps, and look for a crossing or a fall in them."""
        self.timetable.extend(self.recording.steps)
        first, end = self._searched, len(self.timetable)
        if first == end:
            return
        self._searched = end
        if self.crossing_step is None:
            self.crossing_step = crossing_step(self.recording, first, end)
            self._time_crossing()
        if self.fell_at_step is None:
            self.fell_at_step = fell_at_step(self.recording, self._robot, self._world, first)

    def retime(self, clock: Clock) -> None:
        """Recompute the timetable under a clock."""
        self.timetable = Timetable(clock)
        self.timetable.extend(self.recording.steps)
        self._time_crossing()
        self.update()

    def _time_crossing(self) -> None:
        if self.crossing_step is not None:
            self.crossing_s = crossing_s(self.recording, self.timetable, self.crossing_step)

    def time_of(self, moment: Moment) -> float:
        """Return the race time of a moment [s]: the inverse of `moment_at`."""
        ends = self.timetable.ends
        if moment.step >= len(ends):
            return self.end_s
        began = float(ends[moment.step - 1]) if moment.step else 0.0
        thought = float(self.timetable.thought[moment.step])
        return began + moment.thinking * (thought - began) + moment.motion_s

    def distance_at(self, time_s: float) -> float:
        """Return the distance along the track at a race time [m]."""
        return distance_at(self.recording, self.timetable, time_s)

    def view(self, time_s: float, complete: bool) -> LaneFrame:
        """Return the lane as shown at a race time, its pose interpolated.

        Args:
            time_s: race time [s].
            complete: whether the lane will take no further steps.
        """
        moment, lane = self.timetable.at(time_s), self.recording
        steps_taken = len(self.timetable)
        computing = not complete and time_s >= self.end_s  # its next decision is not recorded yet
        at_end = complete and time_s >= self.end_s
        if moment.step >= steps_taken or at_end or (computing and steps_taken):
            return self._standing_view(time_s, complete, computing)
        step = lane.steps[moment.step]
        start = lane.start_qpos(moment.step)
        moves = moment.motion_s > 0 or moment.thinking >= 1
        return LaneFrame(
            pose_at(start, step.motion, moment.motion_s) if moves else start,
            moment.step + 1,
            self.steps,
            self.distance_at(time_s),
            steps_made=self.timetable.made(time_s),
            thinking=not moves and step.transitions > 0,
            futures=round(min(moment.thinking, 1.0) * step.transitions),
            futures_total=step.transitions,
            crossed_s=self._crossed_s(time_s),
            marching=self._marching(moment.step),
            fell_at_step=self._fall_before(moment.step),
            action_values=self._action_values(moment.step),
            conditions=self._world.as_of(moment.step),
            pushes=self._world.pushes_at(moment.step),
        )

    def _standing_view(self, time_s: float, complete: bool, computing: bool) -> LaneFrame:
        """Return the lane at its end, or while its next decision is still being computed."""
        lane, steps_taken = self.recording, len(self.timetable)
        total = int(lane.steps.figures[steps_taken - 1]["transitions"]) if steps_taken else 0
        return LaneFrame(
            lane.start_qpos(steps_taken),
            min(steps_taken + (not complete), self.steps),
            self.steps,
            self._distance_after(steps_taken),
            steps_made=steps_taken,
            thinking=computing and total > 0,
            futures_total=total if computing else 0,
            done=complete and self.is_over,
            halted=complete and not self.is_over,
            crossed_s=self._crossed_s(time_s),
            marching=self._marching(steps_taken),
            failure=lane.failure,
            fell_at_step=self._fall_before(steps_taken),
            action_values=self._action_values(steps_taken - 1),
            conditions=self._world.as_of(max(0, steps_taken - complete)),
        )

    def _fall_before(self, steps_taken: int) -> int | None:
        fell = self.fell_at_step
        return fell if fell is not None and fell < steps_taken else None

    def _crossed_s(self, time_s: float) -> float | None:
        """Return when it crossed the finish line, if that was before a race time [s]."""
        is_before = self.crossing_s is not None and time_s >= self.crossing_s
        return self.crossing_s if is_before else None

    def _marching(self, steps_taken: int) -> bool:
        """Whether the last `MARCHING_STEPS` of the steps taken gained under `MARCHING_M`."""
        if steps_taken < MARCHING_STEPS:
            return False
        start_m = self._distance_after(steps_taken - MARCHING_STEPS)
        return self._distance_after(steps_taken) - start_m < MARCHING_M

    def _distance_after(self, steps_taken: int) -> float:
        figures = self.recording.steps.figures
        return float(figures[steps_taken - 1]["distance_m"]) if steps_taken else 0.0

    def _action_values(self, step: int) -> ActionValuesView | None:
        step_taken = self.recording.steps[step] if 0 <= step < len(self.recording.steps) else None
        if step_taken is None or step_taken.action_values is None:
            return None
        learned, figures = step_taken.action_values, self.recording.steps.figures[step]
        low, high = float(figures["lowest"]), float(figures["highest"])
        return ActionValuesView(
            learned.values, learned.visits, step_taken.observation, step_taken.action, low, high
        )
