"""Routes of races: recording and timeline."""

from typing import Annotated, Literal

from fastapi import Query, Request
from starlette.responses import JSONResponse, Response, StreamingResponse

from app.api.contract import BINARY, answers
from app.api.deps import Services, ServicesDep
from app.api.formats import attachment, negotiated
from app.api.recorded_answers import RecordingView, TimelineView
from app.api.runs import RunPath, find, run_routes
from app.runs.clocks import Clock
from app.runs.race_config import RaceConfig
from app.runs.recording import LaneRecording
from app.stage import recording_export
from app.stage.race_show import original_of
from app.stage.timeline import timeline
from app.storage.artifact_file import ArtifactFile
from app.storage.errors import Conflict
from app.storage.run import NOT_ENDED, Run
from app.storage.stored_recordings import RACE

router = run_routes("race")


@router.get(
    "/{run_id}/recording",
    summary="Get a race's recording (JSON, .npz, viser)",
    response_model=RecordingView,
    responses=answers(200, {"application/x-npz": BINARY, "application/octet-stream": BINARY}),
)
def get_recording(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["json", "npz", "viser"] | None, Query()] = None,  # noqa: A002
    clock: Annotated[Clock, Query()] = "paper",
) -> Response:
    """Joint positions over time; `viser`, timed by `clock`, is for `/viewer/?playbackPath=…`."""
    run, config, _ = _find_recorded(services, run_id)
    kind = negotiated(request, format, ("json", "npz"))
    if kind == "viser":
        stream = _recorded_stream(services, run, config, clock)
        return attachment(stream, "application/octet-stream", f"race-{run_id}.viser")
    if kind == "npz":
        return attachment(
            _stored_recording(services, run), "application/x-npz", f"race-{run_id}.npz"
        )
    chunks = recording_export.as_json(
        lambda: _lanes(services, run), run.lane_training_ids, config.steps
    )
    return StreamingResponse(chunks, media_type="application/json")


@router.get(
    "/{run_id}/timeline",
    summary="Get each lane's distance over time under one clock",
    response_model=TimelineView,
)
def get_timeline(
    services: ServicesDep, run_id: RunPath, clock: Annotated[Clock, Query()] = "paper"
) -> Response:
    """Return each lane's distance over time; it is constant while the lane computes a decision."""
    run, config, lanes = _find_recorded(services, run_id)
    return JSONResponse(timeline(lanes, run.lane_training_ids, config.steps, clock))


def _stored_recording(services: Services, run: Run) -> ArtifactFile:
    """Return the stored recording of an ended race; a live one would be in memory twice."""
    file = None if run.state in NOT_ENDED else services.store.open_artifact(run.id, RACE)
    if file is None:
        raise Conflict(
            f"race {run.id} is {run.state}; its arrays are available once it has ended", run.state
        )
    return file


def _recorded_stream(
    services: Services, run: Run, config: RaceConfig, clock: Clock
) -> ArtifactFile:
    """Return the race as a recorded stream; cached as an artifact, as encoding takes seconds."""
    lanes = services.recordings.race(run.id)
    if run.state in NOT_ENDED or lanes is None:
        raise Conflict(
            f"race {run.id} is {run.state}; its recorded stream is available once it has ended",
            run.state,
        )
    name = f"film-{clock}.viser"
    while (stream := services.store.open_artifact(run.id, name)) is None:
        original = original_of(config, services.store, services.recordings)
        encoded = services.recorded_stream(config, lanes, run.name, clock, original)
        services.store.put_artifact(run.id, name, encoded)
    return stream


def _find_recorded(services: Services, run_id: str) -> tuple[Run, RaceConfig, list[LaneRecording]]:
    run = find(services, "race", run_id)
    lanes = _lanes(services, run)
    if not isinstance(run.config, RaceConfig):
        raise Conflict(f"race {run_id} is {run.state} and has no recording (yet)", run.state)
    return run, run.config, lanes


def _lanes(services: Services, run: Run) -> list[LaneRecording]:
    lanes = services.recordings.race(run.id)
    if lanes is None:
        raise Conflict(f"race {run.id} is {run.state} and has no recording (yet)", run.state)
    return lanes
