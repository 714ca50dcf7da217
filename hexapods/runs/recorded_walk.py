"""Recorded steps of a robot in a race, a practice or an evaluation, alike for all readers."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action, Cells
from hexapods.domain.world import World
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.recording import LaneRecording, LaneSteps, PracticeRecording
from hexapods.runs.records import Evaluated, LaneStep, StepTaken


class EvaluatedStep(NamedTuple):
    """A step of an evaluation, whose choice was not recorded."""

    step: int
    motion: Motion
    observation: None = None
    action: None = None


WalkedStep = LaneStep | StepTaken | EvaluatedStep
"""A recorded step; those here have a motion."""


@dataclass(frozen=True)
class RecordedSteps:
    """Recorded steps of one robot.

    Attributes:
        start_qpos: the pose before the first step of the walk, (7 + joints,).
        steps: recorded steps in order, each with its motion; steps between them may be missing.
    """

    start_qpos: NDArray[np.float32]
    steps: Sequence[WalkedStep]

    def motion(self, index: int) -> Motion:
        """Return the motion of the step with this index in `steps`."""
        return cast(Motion, self.steps[index].motion)

    def choices(self, newest: int) -> list[tuple[Cells | None, Action | None]]:
        """Return observation and action of each of the `newest` steps at the end, in order."""
        if isinstance(self.steps, LaneSteps):
            return list(self.steps.choices(newest))
        return [(step.observation, step.action) for step in self.steps[-newest:]]

    def pose_before(self, index: int) -> NDArray[np.float32]:
        """Return the pose before the step with this index in `steps`, (7 + joints,).

        After a gap that is the first pose of the step's own motion.
        """
        pose: NDArray[np.float32]
        if self.steps[index].step == 1:
            pose = self.start_qpos
        elif index and self.steps[index - 1].step == self.steps[index].step - 1:
            pose = self.motion(index - 1).qpos[-1]
        else:
            pose = self.motion(index).qpos[0]
        return pose


@dataclass(frozen=True)
class RecordedWalk(RecordedSteps):
    """Recorded steps without a gap.

    Attributes:
        problem: the walking problem.
        world: all that happens in the run.
    """

    problem: WalkingProblem
    world: World

    @property
    def from_s(self) -> float:
        """Robot time at the beginning of the first step [s]."""
        return (self.steps[0].step - 1) * self.problem.robot.step_s if self.steps else 0.0

    @property
    def to_s(self) -> float:
        """Robot time at the end of the last step [s]."""
        return self.steps[-1].step * self.problem.robot.step_s if self.steps else 0.0


def walk_of_lane(lane: LaneRecording, problem: WalkingProblem, world: World) -> RecordedWalk:
    """Return the walk of a race's lane."""
    return RecordedWalk(lane.rest_qpos, lane.steps.so_far(), problem, world)


def walk_of_practice(
    recording: PracticeRecording,
    problem: WalkingProblem,
    world: World,
    from_s: float | None = None,
) -> RecordedWalk:
    """Return steps of a practice that are recorded without a gap.

    Args:
        recording: the practice; of its first and its newest steps there are records.
        problem: the walking problem.
        world: all that happens in the practice.
        from_s: a time before the end of those steps; None for the newest.
    """
    steps: list[StepTaken] = []
    for taken in recording.steps:
        if taken.motion is None:
            continue
        if steps and steps[-1].step != taken.step - 1:
            if from_s is not None and from_s < steps[-1].step * problem.robot.step_s:
                break
            steps = []
        steps.append(taken)
    return RecordedWalk(recording.rest_qpos, steps, problem, world)


def walk_of_evaluation(
    evaluated: Evaluated, recording: PracticeRecording, problem: WalkingProblem, world: World
) -> RecordedWalk:
    """Return the walk of an evaluation: 50 steps from rest in the world as it was then."""
    motion, steps = evaluated.motion, list[WalkedStep]()
    if motion is not None:
        frames = len(motion.time_s) // RACE_STEPS
        for number in range(RACE_STEPS):
            frames_of_step = slice(number * frames, (number + 1) * frames)
            begin_s = np.float32(number * problem.robot.step_s)
            motion_of_step = Motion(
                motion.time_s[frames_of_step] - begin_s, motion.qpos[frames_of_step]
            )
            steps.append(EvaluatedStep(number + 1, motion_of_step))
    conditions = world.as_of(max(0, evaluated.step - 1))
    return RecordedWalk(recording.rest_qpos, steps, problem, conditions)
