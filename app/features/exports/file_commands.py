"""Verbs of `hexapods runs` that write a run's walk to a file, one for each export format."""

import argparse
import json
from pathlib import Path

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import CommandParser, add_settings
from app.cli.stored_runs import add_data, add_run, find_run, open_for_reading
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput
from hexapods.exports.export_format import IN_PROCESS, EncodedReplay, ExportFormat, as_bytes
from hexapods.exports.registry import EXPORTS
from hexapods.runs.clocks import Clock


def add_to(verbs: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the parsers of the verbs."""
    for name, export in EXPORTS.items():
        _add(verbs, name, export)


def _add(
    verbs: "argparse._SubParsersAction[CommandParser]", name: str, export: ExportFormat
) -> None:
    parser = verbs.add_parser(name, help=f"export {export.title}")
    add_run(parser)
    endings = " or ".join(f".{ending}" for ending in export.endings)
    parser.add_argument(
        "--out",
        required=True,
        metavar=f"FILE.{export.endings[0]}",
        help=f"file to write, ending with {endings}",
    )
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_settings(parser, export.settings, flags=export.flags)
    parser.set_defaults(run=lambda options: _write(options, export))


def _write(given: argparse.Namespace, export: ExportFormat) -> int:
    """Write the file; works beside a running server."""
    # Imported here, as these modules would slow the start of other commands.
    from app.features.exports.stored_walks import source_of  # noqa: PLC0415
    from app.stage.playback import Replays  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415

    try:
        file = export.file(Path(given.out).suffix.removeprefix("."))
    except InvalidInput as error:
        raise InvalidInput(f"{error}: {given.out}") from error
    options = export.options(**{name: getattr(given, name) for name in export.settings})
    check_writable(given.out)
    with open_for_reading(read_settings(data=given.data)) as store:
        run = store.get(find_run(store, given.run_id).id)
        recordings = Recordings(store)

        def encode(run_id: str, clock: Clock) -> EncodedReplay:
            from app.viewer.replay_frames import ReplayFrames  # noqa: PLC0415 - takes a second

            return ReplayFrames(Replays(store, recordings)).encoded(run_id, clock)

        source = source_of(run, recordings, encode)
        data = b"".join(as_bytes(export.write(source, file, options, IN_PROCESS)))
    write_whole(given.out, data)
    if given.json:
        print(json.dumps({"id": run.id, "file": given.out, "bytes": len(data)}))
    else:
        print(f"{run.kind.capitalize()} {run.id} is in {given.out} ({size_text(len(data))}).")
    return 0
