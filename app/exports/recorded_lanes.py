"""The recorded steps of each robot of an ended run, the source of all exports of its walk."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from app.domain.errors import InvalidInput
from app.runs.clocks import Clock, Timetable
from app.runs.config import TrainingConfig, WalkingProblem
from app.runs.race_config import RaceConfig
from app.runs.recorded_walk import RecordedSteps
from app.runs.records import LaneStep, StepTaken
from app.storage.errors import Conflict, Damaged
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, AnyRun, DamagedRun


@dataclass(frozen=True)
class RecordedLane(RecordedSteps):
    """Recording of one robot; after the first steps of a practice there may be a gap.

    Attributes:
        agent: name of its agent.
    """

    agent: str
    steps: Sequence[LaneStep] | Sequence[StepTaken]

    def starts_s(self, step_s: float, clock: Clock) -> list[float]:
        """Return when the motion of each step begins [s], in a race as a clock times it.

        With the clock `free`, and of a training, that is robot time.
        """
        if clock == "free" or not self.steps or isinstance(self.steps[0], StepTaken):
            return [(one.step - 1) * step_s for one in self.steps]
        return list(Timetable.of(cast(Sequence[LaneStep], self.steps), clock).thought)


@dataclass(frozen=True)
class RecordedWalks:
    """The robots of a run, and the walking problem that they have in common."""

    problem: WalkingProblem
    lanes: Sequence[RecordedLane]


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
        lanes = [RecordedLane(one.rest_qpos, list(one.steps), one.agent) for one in race or ()]
    else:
        practice = recordings.training(run.id)
        lanes = []
        if practice is not None:
            steps = [step for step in practice.steps if step.motion is not None]
            lanes = [RecordedLane(practice.rest_qpos, steps, config.agent)]
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
