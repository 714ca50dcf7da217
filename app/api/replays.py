"""Routes of replays: a run's timeline, and its frames, for a page with a position of its own."""

from typing import Annotated, NamedTuple

from fastapi import Depends, Path, Query, Request
from starlette.responses import Response

from app.api.compression import Caching, gzipped
from app.api.contract import BINARY, answers
from app.api.deps import ServicesDep
from app.api.descriptions import VALID
from app.api.fields import RunId
from app.api.policy import WATCH_REPLAY, WATCH_STAGE, api_router, policy
from app.api.record_response import RecordResponse
from app.api.runs import RunPath
from app.api.work import ANALYSIS
from hexapods.runs.clocks import Clock
from hexapods.shows.replay import HIGHEST_LEVEL, LOWEST_LEVEL, ReplayView
from hexapods.version import __version__

router = api_router(prefix="/runs/{run_id}/replay", tags=["replays"])
start_line_router = api_router(tags=["replays"])

_MEDIA_TYPE = "application/octet-stream"
_FRAMES = answers(200, {_MEDIA_TYPE: BINARY})
_MAX_TIME_S = 1e9
_CELLS = r"^[0-9]{1,4}(,[0-9]{1,4}){0,15}$"
ClockQuery = Annotated[Clock, Query(description="times a race; a training has one clock")]
GhostQuery = Annotated[RunId | None, Query(description=VALID["ghost"])]


@router.get("", summary="Get a replay's plan: intervals, steps and marks")
@policy(access=WATCH_REPLAY, work=ANALYSIS)
def get_replay(
    services: ServicesDep, run_id: RunPath, clock: ClockQuery = "paper", ghost: GhostQuery = None
) -> RecordResponse[ReplayView]:
    """Return the recorded intervals of the run's time, its steps, and marks for a timeline.

    The frames are at `segments/{level}/{number}`. With `ghost` the robots of another run of the
    same kind are shown too, as ghosts; say so in all requests of a replay.
    """
    return RecordResponse(services.replays.plan(run_id, clock, ghost))


@router.get(
    "/scene",
    summary="Get the scene at the start of a replay",
    response_class=Response,
    responses=_FRAMES,
)
@policy(access=WATCH_REPLAY, work=ANALYSIS)
def get_replay_scene(
    services: ServicesDep, request: Request, run_id: RunPath, ghost: GhostQuery = None
) -> Response:
    """Return the scene on which all frames are based; for the format see `docs/replays.md`."""
    return gzipped(request, services.replays.scene(run_id, ghost), _MEDIA_TYPE)


@start_line_router.get(
    "/start-line",
    summary="Get the scene of a stage without a run",
    response_class=Response,
    responses=_FRAMES,
)
@policy(access=WATCH_STAGE, work=ANALYSIS)
def get_start_line(services: ServicesDep, request: Request) -> Response:
    """Return the robots on the start line, as the scene of a replay is encoded."""
    caching = Caching(tag=f"start-line-{__version__}", is_immutable=False, is_public=False)
    return gzipped(request, services.replays.start_line(), _MEDIA_TYPE, caching)


@router.get(
    "/moment", summary="Get one frame of a replay", response_class=Response, responses=_FRAMES
)
@policy(access=WATCH_REPLAY, work=ANALYSIS)
def get_replay_moment(
    *,
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    time_s: Annotated[float, Query(ge=0, le=_MAX_TIME_S, description=VALID["time_s"])],
    clock: ClockQuery = "paper",
    ghost: GhostQuery = None,
) -> Response:
    """Return the frame at a time of the run, or at the nearest that is recorded."""
    return gzipped(request, services.replays.moment(run_id, clock, time_s, ghost), _MEDIA_TYPE)


@router.get(
    "/posture",
    summary="Get messages that draw a ghost in a given state",
    response_class=Response,
    responses=_FRAMES,
)
@policy(access=WATCH_REPLAY, work=ANALYSIS)
def get_replay_posture(
    *,
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    cells: Annotated[str, Query(pattern=_CELLS, description=VALID["cells"])],
    lane: Annotated[int, Query(description="of a race, from 0 on")] = 0,
    time_s: Annotated[float, Query(ge=0, le=_MAX_TIME_S, description=VALID["time_s"])] = 0.0,
    clock: ClockQuery = "paper",
) -> Response:
    """Return messages that draw a lane's robot, translucent, with its feet in the given cells.

    They draw it in the node of the lane's foot grid, so that it moves along with the robot. Legs
    that are lost at the time are left out.
    """
    state = tuple(int(cell) for cell in cells.split(","))
    return gzipped(
        request, services.replays.posture(run_id, clock, time_s, lane, state), _MEDIA_TYPE
    )


class SegmentKey(NamedTuple):
    """Level and number of a segment."""

    level: int
    number: int


async def _segment_key(
    level: Annotated[int, Path(ge=LOWEST_LEVEL, le=HIGHEST_LEVEL, description=VALID["level"])],
    number: Annotated[int, Path(ge=0, lt=1 << 40, description=VALID["number"])],
) -> SegmentKey:
    return SegmentKey(level, number)


@router.get(
    "/segments/{level}/{number}",
    summary="Get a segment of a replay's frames",
    response_class=Response,
    responses=_FRAMES,
)
@policy(access=WATCH_REPLAY, work=ANALYSIS)
def get_replay_segment(
    *,
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    segment: Annotated[SegmentKey, Depends(_segment_key)],
    clock: ClockQuery = "paper",
    ghost: GhostQuery = None,
    version: Annotated[str | None, Query(max_length=64, description=VALID["version"])] = None,
) -> Response:
    """Return the frames of a segment; fewer than it can have where the run still computes.

    A segment of a run that has ended has an `ETag`, and is immutable if the request has the
    `version` of the plan. Caches on the way may store it where anyone may watch the run.
    """
    frames = services.replays.segment(run_id, clock, *segment, ghost)
    if not frames.is_final:
        return gzipped(request, frames.data, _MEDIA_TYPE)
    shown_ids = [shown for shown in (run_id, ghost) if shown is not None]
    is_public = services.settings.spectators == "public" and not any(
        services.features.is_hidden(shown, None) for shown in shown_ids
    )
    caching = Caching(
        tag=f"{frames.version}-{clock}-{segment.level}-{segment.number}",
        is_immutable=version == frames.version,
        is_public=is_public,
    )
    return gzipped(request, frames.data, _MEDIA_TYPE, caching)
