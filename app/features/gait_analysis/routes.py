"""Route of the gait analysis of a race or training."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

from fastapi import Query
from starlette.responses import Response

from app.api.deps import Services, ServicesDep
from app.api.descriptions import VALID
from app.api.policy import WATCH_RUN, api_router, policy
from app.api.runs import RunPath
from app.api.work import ANALYSIS
from app.storage.errors import Conflict, Damaged
from app.storage.run import DamagedRun, Run, world_of
from app.storage.run_kind import with_article
from hexapods.domain.records import Record, to_json_bytes
from hexapods.runs.config import TrainingConfig
from hexapods.runs.gait_analysis import MAX_WINDOW_S, GaitFigures, gait_figures, window_of
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recorded_walk import (
    RecordedWalk,
    walk_of_evaluation,
    walk_of_lane,
    walk_of_practice,
)

TrainingPart = Literal["practice", "evaluation"]
Part = Literal["race", "practice", "evaluation"]

VALID.update(
    {
        "from_s": (
            "a number of seconds of robot time, 0 or more; by default the beginning of the walk"
        ),
        "to_s": (
            f"a number of seconds of robot time over from_s, at most {MAX_WINDOW_S:g} s later; by "
            "default the end of the walk"
        ),
        "part": "practice, or evaluation for the newest one; of a training",
    }
)
router = api_router(prefix="/runs", tags=["runs"])


@dataclass(frozen=True)
class GaitLane(Record):
    """A robot's walk; `figures` are null if nothing of it lies in the window.

    Attributes:
        agent: name of its agent.
        recorded_from_s, recorded_to_s: robot time at the beginning and at the end of the recording.
        figures: figures of the gait within the window.
        no_effort: why there are neither torque nor energy, in a sentence.
    """

    agent: str
    recorded_from_s: float
    recorded_to_s: float
    figures: GaitFigures | None
    no_effort: str | None


@dataclass(frozen=True)
class GaitAnalysis(Record):
    """Gait analysis of a race, lane by lane, or of a training; times are robot time [s].

    Attributes:
        part: part of the run that is analysed.
        step_s: duration of a step.
        lanes: all lanes of a race, or the one of a training.
    """

    part: Part
    step_s: float
    lanes: list[GaitLane]


@router.get(
    "/{run_id}/gait",
    summary="Analyse the gait: footfalls, speed, posture, torque, energy",
    response_model=GaitAnalysis,
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_gait(
    services: ServicesDep,
    run_id: RunPath,
    from_s: Annotated[
        float | None, Query(ge=0, allow_inf_nan=False, description=VALID["from_s"])
    ] = None,
    to_s: Annotated[
        float | None, Query(ge=0, allow_inf_nan=False, description=VALID["to_s"])
    ] = None,
    part: Annotated[TrainingPart, Query(description=VALID["part"])] = "practice",
) -> Response:
    """Analyse the recorded walk of a race or training, also while it runs.

    Times are robot time: the motion of all steps, without the time that decisions take. By default
    the window is all of a race, and the newest part of a practice.
    """
    run = services.store.find(run_id)
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    shown = _walks(services, run, part, from_s)
    window = window_of(shown.walks, from_s, to_s, newest=shown.part == "practice")
    recorded = tuple((walk.from_s, walk.to_s) for walk in shown.walks)
    key = ("gait", run.id, shown.part, window, recorded, shown.step, len(run.changes))

    def compute() -> bytes:
        # It may have waited for other requests.
        services.stopping.check()
        return to_json_bytes(_analysis(shown, *window))

    return Response(services.shared_answers.computed(key, compute), media_type="application/json")


class _Walks(NamedTuple):
    """Recorded walks of a run that are analysed: one of each agent."""

    part: Part
    agents: Sequence[str]
    walks: Sequence[RecordedWalk]
    step: int = 0
    """Number of steps of practice before an evaluation."""


def _walks(services: Services, run: Run, part: TrainingPart, from_s: float | None) -> _Walks:
    """Return the recorded walks of a run.

    Raises:
        Conflict: if there are none.
    """
    config = run.config
    if isinstance(config, RaceConfig):
        lanes = services.recordings.race(run.id)
        if lanes is None:
            raise Conflict(f"race {run.id} is {run.state} and has no recording (yet)", run.state)
        agents = [lane.agent for lane in config.lanes]
        return _Walks("race", agents, [walk_of_lane(lane, config, world_of(run)) for lane in lanes])
    if not isinstance(config, TrainingConfig):
        kind = with_article(run.kind)
        raise Conflict(f"{run.id} is {kind}, whose walks are not recorded", run.state)
    recording = services.recordings.training(run.id)
    if recording is None:
        raise Conflict(f"training {run.id} is {run.state} and has no recording (yet)", run.state)
    if part == "practice":
        walk = walk_of_practice(recording, config, world_of(run), from_s)
        return _Walks(part, [config.agent], [walk])
    evaluation = next((e for e in reversed(recording.evaluations) if e.motion is not None), None)
    if evaluation is None:
        raise Conflict(
            f"training {run.id} is {run.state} and has no recorded evaluation", run.state
        )
    walk = walk_of_evaluation(evaluation, recording, config, world_of(run))
    return _Walks(part, [config.agent], [walk], evaluation.step)


def _analysis(shown: _Walks, from_s: float, to_s: float) -> GaitAnalysis:
    lanes = [
        _lane(agent, walk, from_s, to_s)
        for agent, walk in zip(shown.agents, shown.walks, strict=True)
    ]
    step_s = shown.walks[0].problem.robot.step_s
    return GaitAnalysis(shown.part, step_s, lanes)


def _lane(agent: str, walk: RecordedWalk, from_s: float, to_s: float) -> GaitLane:
    figures = gait_figures(walk, from_s, to_s)
    no_effort = None if figures and figures.effort else _no_effort(walk)
    return GaitLane(agent, walk.from_s, walk.to_s, figures, no_effort)


def _no_effort(walk: RecordedWalk) -> str:
    """Return in a sentence why a walk has neither torque nor energy."""
    if walk.problem.simulator == "kinematic":
        return "The ideal simulator has no servos, so there are neither torque nor energy."
    if isinstance(walk.problem, TrainingConfig):
        return "A training does not record torque and energy; race its learner to see them."
    return "Torque and energy were not recorded when this race was run; run it again to see them."
