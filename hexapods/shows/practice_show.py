"""Playback of a training: as a time-lapse, or live at the training's pace.

During practice the robot is never reset, and walks metres and in curves. So each episode is drawn
from the start line, straight ahead, by a rigid transformation of its poses in the plane. That
makes it comparable with the ghosts of evaluations, which start there too. Only the position and
heading on the track are changed; motion, steps and action values are as recorded. Where that
puts the ground under it is the frame's `origin`.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import replace
from operator import attrgetter, itemgetter

import numpy as np

from hexapods.domain.posture import has_fallen, yaw_rad
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.clocks import SAME_MOMENT_S, Clock
from hexapods.runs.recorded_walk import RecordedSteps
from hexapods.runs.recording import PracticeRecording, pose_at
from hexapods.runs.records import ActionValues, StepTaken
from hexapods.shows.race_lane import MARCHING_M, MARCHING_STEPS
from hexapods.shows.scene_spec import rest_pose
from hexapods.shows.show import PlayedShow, ReplayMark, RunLabel, on_start_line
from hexapods.shows.stage_frame import (
    AT_ORIGIN,
    ActionValuesView,
    Ghost,
    LaneFrame,
    Origin,
    Phase,
    SceneSpec,
    StageFrame,
    rotated,
)

SLOW_STEPS = 10
GROWTH_PER_S = 1.5
"""Factor by which the time-lapse accelerates each second after the slow steps: 500 steps of 0.32 s
take 13 s, a million would take 32 s."""

SHOWN_GHOSTS = 12
EVALUATION_SHOWN_S = 0.6
_TARGET_LAG_S, _MAX_LAG_S, _CATCH_UP_GAIN = 0.4, 4.0, 0.8


class PracticeShow(PlayedShow):
    """Plays a training's recording while it grows.

    Args:
        spec: the scene.
        steps: number of steps of the training.
        step_s: duration of one step's motion [s].
        pace: returns the training's present pace: `max`, or times real time.
        recording: returns the recording so far, None before there is any.
        world: returns all that happens in the training, as far as it is known.
        fell_at_step: first step in which the robot fell, if that is known from the result; else it
            is found in the recording.
    """

    def __init__(
        self,
        spec: SceneSpec,
        steps: int,
        step_s: float,
        pace: Callable[[], float | str],
        recording: Callable[[], PracticeRecording | None],
        *,
        world: Callable[[], World] = lambda: UNDISTURBED,
        fell_at_step: int | None = None,
    ) -> None:
        self.spec, self.steps, self._step_s = spec, steps, step_s
        self.duration_s = steps * step_s
        """Practice time of all the steps that were ordered [s]."""
        self.ends_at_time_out = False
        self.time_out_s: float | None = None
        self._pace, self._recording, self._world = pace, recording, world
        self._fell_at_step = fell_at_step
        self._searched = 0
        """Number of the last step in which a fall was looked for."""
        self._steps: list[StepTaken] = []
        """The steps whose motion is recorded."""
        self._step_numbers: list[int] = []
        self._walk = RecordedSteps(rest_pose(spec).astype(np.float32), self._steps)
        self._evaluations: list[Ghost] = []
        self._done: float | None = None
        """Playback position in steps, with a fraction; None before the first step is recorded."""
        self._is_sought = False
        """Whether playback is far behind the newest step because it was sought there."""
        self._played_s = 0.0
        """Motion played since the time-lapse began [s]; gaps in the recording do not count."""
        self._run_ended = False
        self._rate = 1.0
        self._since_evaluation_s = math.inf
        self._range = ValueRange()
        self._episode, self._origin = -1, AT_ORIGIN
        """The shown episode, and the position and heading in which it began."""

    @property
    def time_s(self) -> float:
        """Playback position in practice time: steps done times the duration of a step [s]."""
        return (self._done or 0.0) * self._step_s

    @property
    def ended(self) -> bool:
        """Whether the run has ended and its last step was shown."""
        return self._run_ended and (
            not self._step_numbers or (self._done or 0) >= self._step_numbers[-1]
        )

    @property
    def computed_s(self) -> float:
        """Practice time up to which steps are recorded [s]."""
        return self._step_numbers[-1] * self._step_s if self._step_numbers else 0.0

    @property
    def recorded(self) -> tuple[tuple[float, float], ...]:
        """Intervals of practice time that can be shown [s]; a long practice has gaps."""
        numbers, step_s = self._step_numbers, self._step_s
        breaks = [n for n in range(1, len(numbers)) if numbers[n] != numbers[n - 1] + 1]
        starts, ends = [0, *breaks], [*breaks, len(numbers)]
        return tuple(
            ((numbers[start] - 1) * step_s, numbers[end - 1] * step_s)
            for start, end in zip(starts, ends, strict=True)
            if end > start
        )

    @property
    def step_ends_s(self) -> list[tuple[float, ...]]:
        """The practice times at which the recorded steps end [s], as of one lane."""
        return [tuple(number * self._step_s for number in self._step_numbers)]

    def marks(self) -> list[ReplayMark]:
        """Return marks of the evaluations, disturbances and the fall so far, in order of time."""
        last = self._step_numbers[-1] if self._step_numbers else 0
        marks = [
            ReplayMark("evaluation", ghost.step * self._step_s, 0, ghost.step, ghost.distance_m)
            for ghost in self._evaluations
        ]
        marks += [
            ReplayMark("disturbance", step * self._step_s, 0, step, None)
            for step in self._world().change_steps
            if step <= last
        ]
        if (fell := self._fell_at_step) is not None:
            marks.append(ReplayMark("fall", (fell + 1) * self._step_s, 0, fell, None))
        return sorted(marks, key=lambda mark: mark.time_s)

    def update(self, *, run_ended: bool) -> None:
        """Take in what the training has recorded; see `Show.update`."""
        self._run_ended = run_ended
        self._update()
        if self._step_numbers and self._done is None:
            self._done = self._step_numbers[0] - 1.0

    def move(self, elapsed_s: float, speed: float | None) -> None:
        """Advance the playback position; see `Show.move`."""
        if self._done is None:
            return
        self._rate = self._playback_rate(speed)
        before = self._ghost_count()
        target = min(self._done + elapsed_s * self._rate / self._step_s, self._step_numbers[-1])
        self._played_s += max(0.0, target - self._done) * self._step_s
        self._done = self._skip_gap(target)
        self._since_evaluation_s += elapsed_s
        if self._ghost_count() > before:
            self._since_evaluation_s = 0.0

    def seek(self, time_s: float) -> None:
        """Set the playback position to a practice time [s], or to the next one recorded."""
        self._update()
        if not self._step_numbers:
            return
        self._is_sought = True
        low, high = self._step_numbers[0] - 1.0, float(self._step_numbers[-1])
        self._done = self._skip_gap(min(max(self._steps_in(time_s), low), high))
        self._played_s = bisect_left(self._step_numbers, self._done) * self._step_s

    def _steps_in(self, time_s: float) -> float:
        """Return the steps done at a time [s]: a whole number where it is the end of a step."""
        done = time_s / self._step_s
        if math.isinf(done):
            return done
        is_end = abs(done - round(done)) * self._step_s <= SAME_MOMENT_S
        return float(round(done)) if is_end else done

    def seek_end(self) -> None:
        """Set the playback position to the last step that is recorded."""
        self.seek(math.inf)

    def retime(self, clock: Clock) -> None:
        """Do nothing: practice has no clocks."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the frame at the playback position."""
        number = self._current_step()
        label = run_label.at_step(number, self.steps, halted=self._is_halted)
        return StageFrame(
            spec=self.spec,
            run_id=run_label.run_id,
            phase=self._phase,
            label=label if number else run_label.name,
            lanes=(self._lane(),),
            ghosts=tuple(self._ghosts()[-SHOWN_GHOSTS:]),
            time_s=self.time_s,
            duration_s=self.duration_s,
            computed_s=self.computed_s,
            ended=self.ended,
            shown_speed=self._rate,
            playing=run_label.playing,
            replay=run_label.replay,
        )

    def start(self, run_label: RunLabel) -> StageFrame:
        """Return the frame before the first step, which what is recorded does not change."""
        frame = on_start_line(self.spec, run_label, (self._at_rest(),))
        return replace(frame, duration_s=self.duration_s)

    def _at_rest(self) -> LaneFrame:
        at_start = self._world().as_of(0)
        return LaneFrame(rest_pose(self.spec), 0, self.steps, 0.0, conditions=at_start)

    @property
    def _is_halted(self) -> bool:
        """Whether the last step of a run that ended early is shown."""
        return self.ended and bool(self._step_numbers) and self._step_numbers[-1] < self.steps

    @property
    def _phase(self) -> Phase:
        if self._done is None:
            return "start-line"
        if self.ended:
            return "finished"
        shown = self._since_evaluation_s < EVALUATION_SHOWN_S
        return "evaluation" if shown else "practice"

    def _update(self) -> None:
        recording = self._recording()
        if recording is None:
            return
        steps = recording.steps
        self._steps = [step for step in steps if step.motion is not None]
        self._walk = RecordedSteps(recording.rest_qpos, self._steps)
        self._step_numbers = [step.step for step in self._steps]
        for step in steps[bisect_right(steps, self._range.last_step, key=attrgetter("step")) :]:
            self._range.include(step.step, step.action_values)
        world, last = self._world(), self.steps - 1
        self._evaluations = [
            Ghost(e.step, e.distance_m, world.as_of(min(e.step, last)))
            for e in recording.evaluations
        ]
        self._look_for_fall(world)

    def _look_for_fall(self, world: World) -> None:
        if self._fell_at_step is None:
            first = bisect_right(self._step_numbers, self._searched)
            for index, number in enumerate(self._step_numbers[first:], first):
                pose = self._walk.motion(index).qpos[-1].tolist()
                if has_fallen(self.spec.robot, pose, world.ground_m(number - 1)):
                    self._fell_at_step = number - 1
                    break
        self._searched = self._step_numbers[-1] if self._step_numbers else 0

    def _fall_so_far(self) -> int | None:
        fell = self._fell_at_step
        return fell if fell is not None and fell + 1 <= (self._done or 0.0) else None

    def _playback_rate(self, speed: float | None) -> float:
        if speed is not None:
            return speed
        pace = self._pace()
        if self._run_ended or isinstance(pace, str):
            slow_s = SLOW_STEPS * self._step_s
            # Growth by a factor each second is linear in the motion played, so it needs no state.
            return 1.0 + math.log(GROWTH_PER_S) * max(0.0, self._played_s - slow_s)
        lag_s = (self._step_numbers[-1] - (self._done or 0.0)) * self._step_s / pace
        self._is_sought &= lag_s > _MAX_LAG_S
        if self._is_sought:
            return pace
        if lag_s > _MAX_LAG_S:
            self._done = self._step_numbers[-1] - _TARGET_LAG_S * pace / self._step_s
            return pace
        return pace * min(max(1.0 + _CATCH_UP_GAIN * (lag_s - _TARGET_LAG_S), 0.3), 2.5)

    def _skip_gap(self, done: float) -> float:
        """Return the position itself, or the next one whose motion is recorded."""
        index = bisect_right(self._step_numbers, math.floor(done))
        if index == len(self._step_numbers):
            return done
        return max(done, self._step_numbers[index] - 1.0)

    def _ghosts(self) -> list[Ghost]:
        return self._evaluations[: self._ghost_count()]

    def _ghost_count(self) -> int:
        done = math.floor(self._done or 0.0)
        return bisect_right(self._evaluations, done, key=attrgetter("step"))

    def _current_step(self) -> int:
        """Return the number of the step at the position, from 1; 0 before the first."""
        return 0 if self._done is None else min(math.floor(self._done) + 1, self._step_numbers[-1])

    def _lane(self) -> LaneFrame:
        world = self._world()
        if self._done is None:
            return self._at_rest()
        index = min(bisect_left(self._step_numbers, self._current_step()), len(self._steps) - 1)
        step, motion = self._steps[index], self._walk.motion(index)
        elapsed_s = (self._done - (step.step - 1)) * float(motion.time_s[-1])
        pose = pose_at(self._walk.pose_before(index), motion, elapsed_s)
        qpos = self._relative_to_start_line(index, pose)
        return LaneFrame(
            qpos,
            step.step,
            self.steps,
            float(qpos[1]),
            steps_made=math.floor(self._done),
            done=self.ended and not self._is_halted,
            halted=self._is_halted,
            marching=self._marching(index),
            fell_at_step=self._fall_so_far(),
            action_values=self._action_values(step),
            conditions=world.as_of(step.step - 1),
            pushes=() if self.ended else world.pushes_at(step.step - 1),
            origin=self._origin,
        )

    def _relative_to_start_line(self, index: int, pose: FloatArray) -> FloatArray:
        """Return the pose as if its episode had begun on the start line, straight ahead."""
        episode = self._steps[index].episode
        if self._episode != episode:
            first = index
            while first and self._steps[first - 1].episode == episode:
                first -= 1
            start, rest = self._walk.pose_before(first), rest_pose(self.spec)
            x_m, y_m = start[:2].tolist()
            turn_rad = yaw_rad(start[3:7].tolist()) - yaw_rad(rest[3:7].tolist())
            self._episode, self._origin = episode, Origin(x_m, y_m, turn_rad)
        x_m, y_m, turn_rad = self._origin
        return rotated(pose, np.array([x_m, y_m]), -turn_rad)

    def _marching(self, index: int) -> bool:
        before = index - MARCHING_STEPS
        if before < 0 or self._step_numbers[before] != self._step_numbers[index] - MARCHING_STEPS:
            return False
        gained = ordered_sum(step.reward_m for step in self._steps[before:index])
        return gained < MARCHING_M

    def _action_values(self, step: StepTaken) -> ActionValuesView | None:
        learned = step.action_values
        if learned is None:
            return None
        low, high = self._range.at(step.step)
        return ActionValuesView(
            learned.values, learned.visits, step.observation, step.action, low, high
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

    def include(self, step: int, before: ActionValues | None) -> None:
        """Include the values before a step, NaN ignored; earlier steps have been included."""
        if step <= self.last_step:
            return
        self.last_step = step
        if before is None:
            return
        _, low, high = self._changes[-1]
        lowest, highest = float(np.nanmin(before.values)), float(np.nanmax(before.values))
        if lowest < low or highest > high:
            self._changes.append((step, min(low, lowest), max(high, highest)))

    def at(self, step: int) -> tuple[float, float]:
        """Return (low, high) of the values up to a step."""
        _, low, high = self._changes[bisect_right(self._changes, step, key=itemgetter(0)) - 1]
        return low, high
