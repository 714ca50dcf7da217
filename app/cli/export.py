"""`hexapods export`: a run with all it has, in one file that another machine takes in."""

import argparse
import json

from app.cli.files import check_writable, write_whole
from app.cli.options import CommandParser
from app.cli.runs import add_data, find_run, open_for_reading
from app.settings import read_settings


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("export", help="put a run into a file", description=__doc__)
    parser.add_argument("run_id", metavar="RUN", help="its id, as `hexapods runs list` tells it")
    parser.add_argument("--out", required=True, metavar="RUN.ZIP", help="where to put it")
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Export a run that has ended; works beside a running server.

    Raises:
        HexapodError: if the run does not exist or has not ended, or the file cannot be written.
    """
    # Imported here, as the database modules would slow the start of other commands.
    from app.archive.transfer import export_run  # noqa: PLC0415

    check_writable(options.out)
    with open_for_reading(read_settings(data=options.data)) as store:
        exported = store.get(find_run(store, options.run_id).id)
        data = export_run(store, exported.id)
    write_whole(options.out, data)
    if options.json:
        print(json.dumps({"id": exported.id, "file": options.out, "bytes": len(data)}))
    else:
        print(
            f"{exported.kind.capitalize()} {exported.id} is in {options.out} "
            f"({len(data) / 1e6:.1f} MB); `hexapods import` takes it in."
        )
    return 0
