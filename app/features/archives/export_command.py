"""`hexapods export`: write runs with all their files to one archive, for another machine."""

import argparse
import json

from app.cli.files import check_writable, write_whole
from app.cli.options import CommandParser
from app.cli.stored_runs import add_data, find_run, open_for_reading
from app.settings import read_settings


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("export", help="write runs to an archive", description=__doc__)
    parser.add_argument(
        "run_ids", nargs="+", metavar="RUN", help="id of a run, as listed by `hexapods runs list`"
    )
    parser.add_argument("--out", required=True, metavar="RUN.ZIP", help="archive to write")
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Export runs that have ended; works beside a running server.

    Raises:
        HexapodError: if a run does not exist or has not ended, or the file cannot be written.
    """
    # Imported here, as the database modules would slow the start of other commands.
    from app.features.archives.transfer import export_chunks, export_many  # noqa: PLC0415

    check_writable(options.out)
    with open_for_reading(read_settings(data=options.data)) as store:
        exported = [store.get(find_run(store, run_id).id) for run_id in options.run_ids]
        first, *others = exported
        ids = [run.id for run in exported]
        data = b"".join(export_many(store, ids) if others else export_chunks(store, first.id))
    write_whole(options.out, data)
    if options.json:
        named = {"ids": ids} if others else {"id": first.id}
        print(json.dumps({**named, "file": options.out, "bytes": len(data)}))
    else:
        these = f"{len(exported)} runs are" if others else f"{first.kind} {first.id} is"
        print(
            f"{these.capitalize()} in {options.out} ({len(data) / 1e6:.1f} MB); `hexapods import` "
            f"takes {'them' if others else 'it'} in."
        )
    return 0
