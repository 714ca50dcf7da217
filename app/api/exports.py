"""Routes of a run's walk as files for other programs."""

from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Query, Request
from starlette.responses import Response

from app.api.contract import ATTACHMENT, BINARY, TEXT, answers
from app.api.deps import Services, ServicesDep
from app.api.formats import attachment, negotiated
from app.api.replays import ClockQuery
from app.api.runs import RunPath
from app.exports.mcap_log import MAX_SERVED_FRAMES as MAX_MCAP_FRAMES
from app.exports.mcap_log import MCAP_TYPE, mcap_log
from app.exports.recorded_lanes import RecordedWalks, checked_lane, recorded_walks
from app.exports.trajectory import (
    CSV_TYPE,
    PARQUET_TYPE,
    trajectory_csv,
    trajectory_parquet,
)
from app.exports.video import (
    MAX_FPS,
    MAX_HEIGHT,
    MAX_SPEED,
    MAX_WIDTH,
    MIN_SIDE,
    MIN_SPEED,
    VideoOptions,
)
from app.exports.video_renderer import MAX_SERVED_FRAMES
from app.storage.run import AnyRun

router = APIRouter(prefix="/runs/{run_id}", tags=["exports"])


def _video_options(
    *,
    format: Annotated[Literal["mp4", "gif"], Query()] = "mp4",  # noqa: A002
    width: Annotated[int, Query(ge=MIN_SIDE, le=MAX_WIDTH, multiple_of=2)] = 640,
    height: Annotated[int, Query(ge=MIN_SIDE, le=MAX_HEIGHT, multiple_of=2)] = 360,
    fps: Annotated[int, Query(ge=1, le=MAX_FPS)] = 30,
    playback_speed: Annotated[float, Query(ge=MIN_SPEED, le=MAX_SPEED)] = 1.0,
    clock: ClockQuery = "paper",
) -> VideoOptions:
    return VideoOptions(f".{format}", width, height, fps, playback_speed, clock)


VideoDep = Annotated[VideoOptions, Depends(_video_options)]


@router.get(
    "/trajectory",
    summary="Export joint angles, feet and torques over time (CSV, Parquet)",
    response_class=Response,
    responses=answers(200, {"text/csv": TEXT, PARQUET_TYPE: BINARY}, headers=ATTACHMENT),
)
def get_trajectory(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["csv", "parquet"] | None, Query()] = None,  # noqa: A002
    lane: Annotated[
        int | None, Query(ge=0, description="of a race, from 0 on; all if absent")
    ] = None,
) -> Response:
    """Return every recorded frame of a race or training that has ended, as a row of numbers.

    The columns have their units in their names; `docs/exports.md` describes them.
    """
    run = services.store.find(run_id)
    lanes = checked_lane(_walks(services, run), lane)

    def look() -> RecordedWalks:
        return _walks(services, run)

    name = f"{run.kind}-{run.id}"
    if negotiated(request, format, ("csv", "parquet")) == "parquet":
        return attachment(trajectory_parquet(look, lanes), PARQUET_TYPE, f"{name}.parquet")
    return attachment(trajectory_csv(look, lanes), CSV_TYPE, f"{name}.csv")


@router.get(
    "/page",
    summary="Export an HTML page that replays the run without a server",
    response_class=Response,
    responses=answers(200, {"text/html": TEXT}, headers=ATTACHMENT),
)
def get_page(services: ServicesDep, run_id: RunPath, clock: ClockQuery = "paper") -> Response:
    """Return an HTML file that plays offline, and in an iframe of any page.

    `docs/exports.md` describes its size and its interface.
    """
    run = services.store.get(run_id)
    _walks(services, run)
    title = run.name or f"{run.kind} {run.id}"
    chunks = services.replay_page(run.id, title, clock)
    return attachment(chunks, "text/html; charset=utf-8", f"{run.kind}-{run.id}.html")


@router.get(
    "/mcap",
    summary="Export joint states and frames (MCAP log)",
    response_class=Response,
    responses=answers(200, {MCAP_TYPE: BINARY}, headers=ATTACHMENT),
)
def get_mcap(services: ServicesDep, run_id: RunPath, clock: ClockQuery = "paper") -> Response:
    """Return `foxglove.JointStates` of each lane, and `foxglove.FrameTransforms` of all links.

    It needs `racing-hexapods[mcap]` on the server.
    """
    run = services.store.get(run_id)
    chunks = mcap_log(_walks(services, run), clock, services.stopping, MAX_MCAP_FRAMES)
    return attachment(chunks, MCAP_TYPE, f"{run.kind}-{run.id}.mcap")


@router.post(
    "/video",
    summary="Render a video of the run (MP4, GIF)",
    response_class=Response,
    responses=answers(200, {"video/mp4": BINARY, "image/gif": BINARY}, headers=ATTACHMENT),
    description=(
        f"Render an MP4 or GIF of at most {MAX_SERVED_FRAMES} pictures, which takes up to minutes; "
        "one at a time.\n\nIt needs `racing-hexapods[video]` and OpenGL on the server; "
        "see `docs/exports.md`."
    ),
)
def render(services: ServicesDep, run_id: RunPath, options: VideoDep) -> Response:
    """Return a video of the run."""
    run = services.store.get(run_id)
    video = services.videos.render(_walks(services, run), options)
    media_type = "image/gif" if options.ending == ".gif" else "video/mp4"
    return attachment(video, media_type, f"{run.kind}-{run.id}{options.ending}")


def _walks(services: Services, run: AnyRun) -> RecordedWalks:
    return recorded_walks(run, services.recordings)
