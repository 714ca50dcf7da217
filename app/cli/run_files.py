"""Verbs of `hexapods runs` that write a run's walk to a file for other programs."""

import argparse
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from app.cli.files import check_writable, write_whole
from app.cli.options import CommandParser, integer
from app.cli.stored_runs import add_data, add_run, find_run, open_for_reading
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput
from hexapods.runs.clocks import CLOCKS

if TYPE_CHECKING:
    from app.exports.recorded_lanes import RecordedWalks
    from app.storage.database.store import RunStore
    from app.storage.recordings import Recordings
    from app.storage.run import Run

_TABLES = (".csv", ".parquet")


class Source(NamedTuple):
    """A run, and where all that it recorded is."""

    run: "Run"
    walks: "RecordedWalks"
    store: "RunStore"
    recordings: "Recordings"


Export = Callable[[Source, argparse.Namespace], Iterable[bytes]]


def add_to(verbs: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the parsers of the verbs."""
    table = _add(verbs, "trajectory", "joint angles and feet over time", _trajectory, _TABLES)
    table.add_argument(
        "--lane", type=integer, help="number of a race's lane, from 0 on (default: all lanes)"
    )
    page = _add(verbs, "page", "a replay that plays in any browser, offline", _page, (".html",))
    video = _add(verbs, "video", "a video, rendered off screen", _video, (".mp4", ".gif"))
    video.add_argument("--width", type=integer, default=640, help="width in pixels (default 640)")
    video.add_argument("--height", type=integer, default=360, help="height in pixels (default 360)")
    video.add_argument("--fps", type=integer, default=30, help="frames per second (default 30)")
    video.add_argument(
        "--speed",
        type=float,
        default=1.0,
        help="playback speed, as a multiple of the run's own (default 1)",
    )
    log = _add(verbs, "mcap", "joint states and frames, for robotics tools", _mcap, (".mcap",))
    for verb in (page, video, log):
        _add_clock(verb)


def _add(
    verbs: "argparse._SubParsersAction[CommandParser]",
    name: str,
    words: str,
    export: Export,
    endings: tuple[str, ...],
) -> CommandParser:
    """Add the parser of a verb that writes files with one of these endings."""
    parser = verbs.add_parser(name, help=f"export {words}")
    add_run(parser)
    parser.add_argument(
        "--out",
        required=True,
        metavar=f"FILE{endings[0]}",
        help=f"file to write, ending with {_one_of(endings)}",
    )
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=lambda options: _write(options, export, endings))
    return parser


def _add_clock(parser: CommandParser) -> None:
    parser.add_argument("--clock", choices=CLOCKS, default="paper", help="clock that times a race")


def _write(options: argparse.Namespace, export: Export, endings: tuple[str, ...]) -> int:
    """Write the file; works beside a running server."""
    # Imported here, as these modules would slow the start of other commands.
    from app.exports.recorded_lanes import recorded_walks  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415

    if Path(options.out).suffix not in endings:
        raise InvalidInput(f"the name of the file must end with {_one_of(endings)}: {options.out}")
    check_writable(options.out)
    with open_for_reading(read_settings(data=options.data)) as store:
        run = store.get(find_run(store, options.run_id).id)
        recordings = Recordings(store)
        source = Source(run, recorded_walks(run, recordings), store, recordings)
        data = b"".join(export(source, options))
    write_whole(options.out, data)
    if options.json:
        print(json.dumps({"id": run.id, "file": options.out, "bytes": len(data)}))
    else:
        size = f"{len(data) / 1e6:.1f} MB" if len(data) >= 1e6 else f"{len(data) / 1e3:.0f} kB"
        print(f"{run.kind.capitalize()} {run.id} is in {options.out} ({size}).")
    return 0


def _one_of(endings: tuple[str, ...]) -> str:
    return " or ".join(endings)


def _trajectory(source: Source, options: argparse.Namespace) -> Iterable[bytes]:
    from app.exports.recorded_lanes import checked_lane  # noqa: PLC0415
    from app.exports.trajectory import trajectory_csv, trajectory_parquet  # noqa: PLC0415

    walks = source.walks
    lanes = checked_lane(walks, options.lane)
    if Path(options.out).suffix == ".parquet":
        return trajectory_parquet(lambda: walks, lanes)
    return (text.encode() for text in trajectory_csv(lambda: walks, lanes))


def _page(source: Source, options: argparse.Namespace) -> Iterable[bytes]:
    from app.stage.playback import Replays  # noqa: PLC0415
    from app.viewer.replay_frames import ReplayFrames  # noqa: PLC0415

    run = source.run
    frames = ReplayFrames(Replays(source.store, source.recordings))
    return frames.page(run.id, run.name or f"{run.kind} {run.id}", options.clock)


def _video(source: Source, options: argparse.Namespace) -> Iterable[bytes]:
    from app.exports.extras import no_opengl  # noqa: PLC0415

    try:
        from app.exports.video import VideoOptions, render_video  # noqa: PLC0415
    # MuJoCo loads the OpenGL of MUJOCO_GL when it is imported, and PyOpenGL fails in many ways.
    except (ImportError, AttributeError, RuntimeError) as error:
        raise no_opengl(error) from error
    video = VideoOptions(
        ending=Path(options.out).suffix,
        width=options.width,
        height=options.height,
        fps=options.fps,
        speed=options.speed,
        clock=options.clock,
    )
    return [render_video(source.walks, video)]


def _mcap(source: Source, options: argparse.Namespace) -> Iterable[bytes]:
    from app.exports.mcap_log import mcap_log  # noqa: PLC0415

    return mcap_log(source.walks, options.clock)
