"""Route of the gait analysis of a race or training."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from starlette.responses import JSONResponse, Response

from app.api.deps import Services, ServicesDep
from app.api.descriptions import VALID
from app.api.gait_answers import GaitView
from app.api.runs import RunPath
from app.runs.config import TrainingConfig
from app.runs.gait_analysis import (
    RecordedWalk,
    gait_figures,
    walk_of_evaluation,
    walk_of_lane,
    walk_of_practice,
    window_of,
)
from app.runs.race_config import RaceConfig
from app.storage.errors import Conflict, Damaged
from app.storage.run import DamagedRun, Run, world_of

TrainingPart = Literal["practice", "evaluation"]

router = APIRouter(prefix="/runs", tags=["runs"])


@router.get(
    "/{run_id}/gait",
    summary="Footfalls, speed, posture, torque and energy of a walk",
    response_model=GaitView,
)
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
    """Analyse what is recorded of a race or training, also while it runs.

    Times are robot time: the motion of all steps, without the time that decisions take. By default
    all of a race, and the newest of a practice.
    """
    run = services.store.find(run_id)
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    if isinstance(run.config, RaceConfig):
        shown, agents, walks = (
            "race",
            [lane.agent for lane in run.config.lanes],
            _lanes(services, run),
        )
    elif isinstance(run.config, TrainingConfig):
        shown, agents, walks = part, [run.config.agent], [_training(services, run, part, from_s)]
    else:
        raise Conflict(f"{run_id} is an experiment, whose walks are not recorded", run.state)
    begin_s, end_s = window_of(walks, from_s, to_s, newest=shown == "practice")
    lanes = [_lane(agent, walk, begin_s, end_s) for agent, walk in zip(agents, walks, strict=True)]
    return JSONResponse({"part": shown, "step_s": run.config.robot.step_s, "lanes": lanes})


def _lanes(services: Services, run: Run) -> Sequence[RecordedWalk]:
    lanes = services.recordings.race(run.id)
    if lanes is None or not isinstance(run.config, RaceConfig):
        raise Conflict(f"race {run.id} is {run.state} and has no recording (yet)", run.state)
    return [walk_of_lane(lane, run.config, world_of(run)) for lane in lanes]


def _training(
    services: Services, run: Run, part: TrainingPart, from_s: float | None
) -> RecordedWalk:
    recording = services.recordings.training(run.id)
    if recording is None or not isinstance(run.config, TrainingConfig):
        raise Conflict(f"training {run.id} is {run.state} and has no recording (yet)", run.state)
    if part == "practice":
        return walk_of_practice(recording, run.config, world_of(run), from_s)
    evaluations = [one for one in recording.evaluations if one.motion is not None]
    if not evaluations:
        raise Conflict(
            f"training {run.id} is {run.state} and has no recorded evaluation", run.state
        )
    return walk_of_evaluation(evaluations[-1], recording, run.config, world_of(run))


def _lane(agent: str, walk: RecordedWalk, from_s: float, to_s: float) -> dict[str, Any]:
    figures = gait_figures(walk, from_s, to_s)
    return {
        "agent": agent,
        "recorded_from_s": walk.from_s,
        "recorded_to_s": walk.to_s,
        "figures": None if figures is None else asdict(figures),
        "no_effort": None if figures and figures.effort else _no_effort(walk),
    }


def _no_effort(walk: RecordedWalk) -> str:
    """Return why torque and work of a walk are not known."""
    if walk.problem.simulator == "kinematic":
        return "The ideal simulator has no servos, so there are neither torque nor energy."
    if isinstance(walk.problem, TrainingConfig):
        return "A training does not record torque and energy; race its learner to see them."
    return "Torque and energy were not recorded when this race was run; run it again to see them."
