"""The recorded steps of each robot of a run, the source of most exports of its walk."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.runs.clocks import Clock, Timetable, motions_s
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import RecordedSteps
from hexapods.runs.recording import LaneRecording, LaneSteps, PracticeRecording
from hexapods.runs.records import LaneStep, StepTaken


@dataclass(frozen=True)
class ExportedLane(RecordedSteps):
    """Recording of one robot; after the first steps of a practice there may be a gap.

    Attributes:
        agent: name of its agent.
    """

    agent: str
    steps: Sequence[LaneStep] | Sequence[StepTaken]

    @property
    def frames(self) -> int:
        """Number of recorded frames."""
        if isinstance(self.steps, LaneSteps):
            return int(self.steps.figures["frames"].sum())
        return sum(len(self.motion(index).time_s) for index in range(len(self.steps)))

    def starts_s(self, step_s: float, clock: Clock) -> FloatArray:
        """Return when the motion of each step begins [s], in a race as a clock times it.

        With the clock `free`, and of a training, that is robot time.
        """
        if not isinstance(self.steps, LaneSteps):
            return np.array([(step.step - 1) * step_s for step in self.steps])
        if clock == "free":
            return np.arange(len(self.steps), dtype=float) * step_s
        return Timetable.of(self.steps, clock).thought

    def ends_s(self, step_s: float, clock: Clock) -> FloatArray:
        """Return when the motion of each step ends [s]; see `starts_s`."""
        if isinstance(self.steps, LaneSteps):
            durations = motions_s(self.steps.figures)
        else:
            last_s = [float(self.motion(index).time_s[-1]) for index in range(len(self.steps))]
            durations = np.array(last_s, float)
        ends: FloatArray = self.starts_s(step_s, clock) + durations
        return ends


@dataclass(frozen=True)
class RecordedWalks:
    """The robots of a run, and the walking problem that they have in common."""

    problem: WalkingProblem
    lanes: Sequence[ExportedLane]

    def clock_of(self, clock: Clock) -> Clock:
        """Return the clock by which the walks are timed: a training has the motion alone."""
        return clock if isinstance(self.problem, RaceConfig) else "free"

    @classmethod
    def of_race(cls, config: RaceConfig, lanes: Iterable[LaneRecording]) -> Self:
        """Return the recorded walks of the lanes of a race."""
        return cls(config, [ExportedLane(lane.rest_qpos, lane.steps, lane.agent) for lane in lanes])

    @classmethod
    def of_training(cls, config: TrainingConfig, recording: PracticeRecording) -> Self:
        """Return the recorded walk of a training, of the steps that have a motion."""
        steps = [step for step in recording.steps if step.motion is not None]
        return cls(config, [ExportedLane(recording.rest_qpos, steps, config.agent)])


def checked_lane(walks: RecordedWalks, lane: int | None) -> list[int]:
    """Return the numbers of the requested lanes: one, or all.

    Raises:
        InvalidInput: if there is no such lane.
    """
    last = len(walks.lanes) - 1
    if lane is None:
        return list(range(last + 1))
    if not 0 <= lane <= last:
        valid = f"from 0 to {last}" if last else "0"
        raise InvalidInput(f"lane must be {valid}, not {lane}")
    return [lane]
