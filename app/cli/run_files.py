"""Verbs of `hexapods runs` that write a run's walk into a file for other programs."""

import argparse
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.files import check_writable, write_whole
from app.cli.options import CommandParser, integer
from app.cli.stored_runs import add_data, add_run, find_run, open_for_reading
from app.domain.errors import InvalidInput
from app.settings import read_settings

if TYPE_CHECKING:
    from app.exports.recorded_lanes import RecordedWalks

_TABLES = (".csv", ".parquet")

Export = Callable[["RecordedWalks", argparse.Namespace], Iterable[bytes]]


def add_to(verbs: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the parsers of the verbs."""
    table = _add(verbs, "trajectory", "joint angles and feet over time", _trajectory, _TABLES)
    table.add_argument("--lane", type=integer, help="of a race, from 0 on; all by default")


def _add(
    verbs: "argparse._SubParsersAction[CommandParser]",
    name: str,
    words: str,
    export: Export,
    endings: tuple[str, ...],
) -> CommandParser:
    """Add the parser of a verb that writes files with one of these endings."""
    parser = verbs.add_parser(name, help=f"a file of {words}")
    add_run(parser)
    parser.add_argument(
        "--out", required=True, metavar=f"FILE{endings[0]}", help=f"ends with {_one_of(endings)}"
    )
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.set_defaults(run=lambda options: _write(options, export, endings))
    return parser


def _write(options: argparse.Namespace, export: Export, endings: tuple[str, ...]) -> int:
    """Write the file; works beside a running server."""
    # Imported here, as these modules would slow the start of other commands.
    from app.exports.recorded_lanes import recorded_walks  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415

    if Path(options.out).suffix not in endings:
        raise InvalidInput(f"the name of the file must end with {_one_of(endings)}: {options.out}")
    check_writable(options.out)
    with open_for_reading(read_settings(data=options.data)) as store:
        run = find_run(store, options.run_id)
        walks = recorded_walks(run, Recordings(store))
    data = b"".join(export(walks, options))
    write_whole(options.out, data)
    if options.json:
        print(json.dumps({"id": run.id, "file": options.out, "bytes": len(data)}))
    else:
        print(f"{run.kind} {run.id} is in {options.out} ({len(data) / 1e6:.1f} MB).".capitalize())
    return 0


def _one_of(endings: tuple[str, ...]) -> str:
    return " or ".join(endings)


def _trajectory(walks: "RecordedWalks", options: argparse.Namespace) -> Iterable[bytes]:
    from app.exports.recorded_lanes import checked_lane  # noqa: PLC0415
    from app.exports.trajectory import trajectory_csv, trajectory_parquet  # noqa: PLC0415

    lanes = checked_lane(walks, options.lane)
    if Path(options.out).suffix == ".parquet":
        return trajectory_parquet(lambda: walks, lanes)
    return (text.encode() for text in trajectory_csv(lambda: walks, lanes))
