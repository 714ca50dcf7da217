"""Routes of races: recording and timeline."""

import gzip
from collections.abc import Iterator
from typing import Annotated, Literal

from fastapi import Query, Request
from starlette.responses import Response, StreamingResponse

from app.api.answers import RacePage
from app.api.compression import gzipped
from app.api.contract import BINARY, answers
from app.api.deps import Services, ServicesDep
from app.api.formats import attachment, negotiated
from app.api.policy import WATCH_RUN, policy
from app.api.recorded_answers import RecordingView
from app.api.runs import RunPath, find, run_routes
from app.api.work import ANALYSIS, DOWNLOAD
from app.events.run_view import RaceView
from app.stage.timeline import TimelineView, timeline
from app.storage.errors import Conflict
from app.storage.run import NOT_ENDED, Run
from hexapods.domain.records import to_json_bytes
from hexapods.exports import recording_json
from hexapods.runs.clocks import Clock
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording

router = run_routes("race", RaceView, RacePage)


@router.get(
    "/{run_id}/recording",
    summary="Get a race's recording (JSON, .npz)",
    response_model=RecordingView,
    responses=answers(200, {"application/x-npz": BINARY}),
)
@policy(access=WATCH_RUN, work=DOWNLOAD)
def get_recording(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["json", "npz"] | None, Query()] = None,  # noqa: A002
) -> Response:
    """Return joint positions over time; as arrays once the race has ended."""
    run, config, _ = _find_recorded(services, run_id)
    if negotiated(request, format, ("json", "npz")) == "npz":
        arrays = _stored_recording(services, run)
        return attachment(arrays, "application/x-npz", f"race-{run_id}.npz")
    chunks = recording_json.as_json(
        lambda: _lanes(services, run), run.lane_training_ids, config.steps
    )
    return StreamingResponse(chunks, media_type="application/json")


@router.get(
    "/{run_id}/timeline",
    summary="Get each lane's distance over time under one clock",
    response_model=TimelineView,
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_timeline(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    clock: Annotated[Clock, Query()] = "paper",
) -> Response:
    """Return each lane's distance over time; it is constant while the lane computes a decision."""
    run = find(services, "race", run_id)

    def compute() -> bytes:
        services.stopping.check()
        _, config, lanes = _find_recorded(services, run_id)
        content = to_json_bytes(timeline(lanes, run.lane_training_ids, config.steps, clock))
        return gzip.compress(content, compresslevel=1, mtime=0)

    # The timeline of a race that has ended is computed once, and cached for all clients.
    key = ("timeline", run.id, run.created_at, run.state, run.ended_at, clock)
    content = (
        compute() if run.state in NOT_ENDED else services.shared_answers.computed(key, compute)
    )
    return gzipped(request, content, "application/json")


def _stored_recording(services: Services, run: Run) -> Iterator[bytes]:
    """Return the stored recording of an ended race; of a live one some steps are in no file."""
    arrays = None if run.state in NOT_ENDED else services.recordings.race_file(run.id)
    if arrays is None:
        raise Conflict(
            f"race {run.id} is {run.state}; its arrays are available once it has ended", run.state
        )
    return arrays


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
