"""A training as it is shown: a time-lapse, or as it happens.

Practice wanders off: the robot is never put back, and walks metres and in curves. So each episode
is *drawn* from the start line, straight ahead. What is seen is then what the robot makes of its
steps now, beside the ghosts of its evaluations, which start there too, and before the finish line
that it is to race to. Only the place on the track is redrawn; motion, steps and table are as they
were.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.domain.simulator import Motion
from app.domain.types import FloatArray
from app.runs.recording import PracticeRecording, pose_at
from app.runs.records import StepTaken
from app.stage.race_lane import MARCHING_M, MARCHING_STEPS, ValueRange
from app.stage.scene_spec import rest_pose
from app.stage.show import RunLabel
from app.stage.stage_frame import (
    ActionValuesView,
    Ghost,
    LaneView,
    Phase,
    SceneSpec,
    StageFrame,
    turned,
    yaw_rad,
)

SLOW_STEPS = 10
GROWTH_PER_S = 1.5
"""After the slow steps the time-lapse gets faster by this factor each second: 500 steps of 0.32 s
take 13 s, a million would take 32."""

SHOWN_GHOSTS = 12
EVALUATION_SHOWN_S = 0.6
_LAG_S, _LAG_MAX_S, _CATCH_UP = 0.4, 4.0, 0.8


class PracticeShow:
    """Plays a training's recording while it grows.

    Args:
        cast: who practises.
        steps: how many there are to be.
        step_s: duration of one step's motion.
        pace: asks how the training runs now: `max`, or times real time.
        recording: what is recorded by now, None before there is anything.
    """

    def __init__(
        self,
        cast: SceneSpec,
        steps: int,
        step_s: float,
        pace: Callable[[], float | str],
        recording: Callable[[], PracticeRecording | None],
    ) -> None:
        self.cast, self.steps, self._step_s = cast, steps, step_s
        self._pace, self._recording = pace, recording
        self._kept: list[_Kept] = []
        self._numbers: list[int] = []
        self._rest_qpos = rest_pose(cast).astype(np.float32)
        self._evaluated: list[Ghost] = []
        self._done: float | None = None
        """Steps done, with the part of the one under way; None before the first is known."""
        self._shown_s = 0.0
        """Motion shown since the time-lapse began; gaps in the recording do not count."""
        self._over = False
        self._rate = 1.0
        self._since_evaluation_s = math.inf
        self._range = ValueRange()
        self._origin = _Origin.none()

    @property
    def time_s(self) -> float:
        """Practice time: steps done, in seconds of motion."""
        return (self._done or 0.0) * self._step_s

    @property
    def ended(self) -> bool:
        """Whether the last step has been shown."""
        return self._over and (not self._numbers or (self._done or 0) >= self._numbers[-1])

    def advance(self, elapsed_s: float, speed: float | None, over: bool) -> None:
        """Go on; see `Show`."""
        self._over = over
        self._look()
        if not self._numbers:
            return
        if self._done is None:
            self._done = self._numbers[0] - 1.0
        self._rate = self._rate_now(speed)
        before = len(self._ghosts())
        target = min(self._done + elapsed_s * self._rate / self._step_s, self._numbers[-1])
        self._shown_s += max(0.0, target - self._done) * self._step_s
        self._done = self._past_gap(target)
        self._since_evaluation_s += elapsed_s
        if len(self._ghosts()) > before:
            self._since_evaluation_s = 0.0

    def seek(self, time_s: float) -> None:
        """Go to a practice time; where nothing is kept, to the next that is."""
        self._look()
        if not self._numbers:
            return
        low, high = self._numbers[0] - 1.0, float(self._numbers[-1])
        self._done = self._past_gap(min(max(time_s / self._step_s, low), high))
        self._shown_s = bisect_left(self._numbers, self._done) * self._step_s

    def retime(self, clock: str) -> None:
        """Practice has no other clock."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """What is to be seen now."""
        number = self._number()
        label = f"{run_label.name}, step {number} of {self.steps}" if number else run_label.name
        return StageFrame(
            cast=self.cast,
            run_id=run_label.run_id,
            phase=self._phase,
            label=label,
            lanes=(self._lane(),),
            ghosts=tuple(self._ghosts()[-SHOWN_GHOSTS:]),
            time_s=self.time_s,
            duration_s=self.steps * self._step_s,
            shown_speed=self._rate,
            playing=run_label.playing,
            replay=run_label.replay,
        )

    @property
    def _phase(self) -> Phase:
        if self._done is None:
            return "start-line"
        if self.ended:
            return "finished"
        shown = self._since_evaluation_s < EVALUATION_SHOWN_S
        return "evaluation" if shown else "practice"

    def _look(self) -> None:
        recording = self._recording()
        if recording is None:
            return
        self._rest_qpos = recording.rest_qpos
        taken = recording.steps
        self._kept = [_Kept(step, step.motion) for step in taken if step.motion is not None]
        self._numbers = [kept.taken.step for kept in self._kept]
        self._evaluated = [Ghost(e.step, e.distance_m) for e in recording.evaluations]

    def _rate_now(self, speed: float | None) -> float:
        if speed is not None:
            return speed
        pace = self._pace()
        if self._over or isinstance(pace, str):
            slow_s = SLOW_STEPS * self._step_s
            # Faster each second, as a function of what was shown: no state to get wrong.
            return 1.0 + math.log(GROWTH_PER_S) * max(0.0, self._shown_s - slow_s)
        lag_s = (self._numbers[-1] - (self._done or 0.0)) * self._step_s / pace
        if lag_s > _LAG_MAX_S:
            self._done = self._numbers[-1] - _LAG_S * pace / self._step_s
            return pace
        return pace * min(max(1.0 + _CATCH_UP * (lag_s - _LAG_S), 0.3), 2.5)

    def _past_gap(self, done: float) -> float:
        """The same place, or the next that is kept."""
        index = bisect_right(self._numbers, math.floor(done))
        if index == len(self._numbers):
            return done
        return max(done, self._numbers[index] - 1.0)

    def _ghosts(self) -> list[Ghost]:
        steps = [ghost.step for ghost in self._evaluated]
        return self._evaluated[: bisect_right(steps, math.floor(self._done or 0.0))]

    def _number(self) -> int:
        """The step it is in, counted from 1; 0 before the first."""
        return 0 if self._done is None else min(math.floor(self._done) + 1, self._numbers[-1])

    def _lane(self) -> LaneView:
        if self._done is None:
            return LaneView(rest_pose(self.cast), 0, self.steps, 0.0)
        index = min(bisect_left(self._numbers, self._number()), len(self._kept) - 1)
        step, motion = self._kept[index]
        into_s = (self._done - (step.step - 1)) * float(motion.time_s[-1])
        pose = pose_at(self._start(index), motion, into_s)
        qpos = self._from_start_line(index, pose)
        return LaneView(
            qpos,
            step.step,
            self.steps,
            float(qpos[1]),
            done=self.ended,
            marching=self._marching(index),
            knowledge=self._knowledge(step),
        )

    def _start(self, index: int) -> NDArray[np.float32]:
        """The pose in which a kept step began, as well as it is known."""
        number, poses = self._numbers[index], self._kept[index].motion.qpos
        if number == 1:
            return self._rest_qpos
        follows = index > 0 and self._numbers[index - 1] == number - 1
        start: NDArray[np.float32] = self._kept[index - 1].motion.qpos[-1] if follows else poses[0]
        return start

    def _from_start_line(self, index: int, pose: FloatArray) -> FloatArray:
        """The pose as if its episode had begun on the start line, straight ahead."""
        episode = self._kept[index].taken.episode
        if self._origin.episode != episode:
            first = index
            while first and self._kept[first - 1].taken.episode == episode:
                first -= 1
            self._origin = _Origin.of(episode, self._start(first), rest_pose(self.cast))
        return self._origin.seen_from(pose)

    def _marching(self, index: int) -> bool:
        before = index - MARCHING_STEPS
        if before < 0 or self._numbers[before] != self._numbers[index] - MARCHING_STEPS:
            return False
        gained = sum(kept.taken.reward_m for kept in self._kept[before:index])
        return gained < MARCHING_M

    def _knowledge(self, step: StepTaken) -> ActionValuesView | None:
        known = step.knowledge
        if known is None:
            return None
        low, high = self._range.including(known.values)
        return ActionValuesView(
            known.values, known.visits, step.observation, step.action, low, high
        )


class _Kept(NamedTuple):
    """A step whose motion is kept."""

    taken: StepTaken
    motion: Motion


class _Origin(NamedTuple):
    """Where an episode began, to be drawn from the start line."""

    episode: int
    place: FloatArray
    """(2,) [m]"""
    turn_rad: float
    """By how much it had turned from straight ahead, anticlockwise."""

    @classmethod
    def none(cls) -> "_Origin":
        return cls(-1, np.zeros(2), 0.0)

    @classmethod
    def of(cls, episode: int, start: NDArray[np.float32], rest: FloatArray) -> "_Origin":
        return cls(episode, start[:2].astype(float), yaw_rad(start[3:7]) - yaw_rad(rest[3:7]))

    def seen_from(self, pose: FloatArray) -> FloatArray:
        """The pose with this origin on the start line, straight ahead."""
        return turned(pose, self.place, -self.turn_rad)
