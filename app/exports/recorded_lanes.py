"""The recorded steps of each robot of an ended run, the source of all exports of its walk."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.storage.errors import Conflict, Damaged
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, AnyRun, DamagedRun
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.runs.clocks import Clock, Timetable, motions_s
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import RecordedSteps
from hexapods.runs.recording import LaneSteps
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
            return np.array([(one.step - 1) * step_s for one in self.steps])
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


def recorded_walks(run: AnyRun, recordings: Recordings) -> RecordedWalks:
    """Return what is recorded of a race or training that has ended.

    Raises:
        InvalidInput: if the run is an experiment.
        Damaged: if it cannot be read.
        Conflict: if it has not ended, or has no recording.
    """
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    config = run.config
    if not isinstance(config, RaceConfig | TrainingConfig):
        raise InvalidInput(
            f"{run.id} is an experiment, which records no walk; choose a race or a training"
        )
    if run.state in NOT_ENDED:
        raise Conflict(
            f"{run.kind} {run.id} is {run.state}; its walk can be had as a file once it ended, or "
            "was stopped",
            run.state,
        )
    if isinstance(config, RaceConfig):
        race = recordings.race(run.id)
        lanes = [ExportedLane(one.rest_qpos, one.steps, one.agent) for one in race or ()]
    else:
        practice = recordings.training(run.id)
        lanes = []
        if practice is not None:
            steps = [step for step in practice.steps if step.motion is not None]
            lanes = [ExportedLane(practice.rest_qpos, steps, config.agent)]
    if not any(lane.steps for lane in lanes):
        raise Conflict(f"{run.kind} {run.id} is {run.state} and has no recording", run.state)
    return RecordedWalks(config, lanes)


def checked_lane(walks: RecordedWalks, lane: int | None) -> list[int]:
    """Return the number of the lane that is asked for, or those of all.

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
