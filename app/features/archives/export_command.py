"""`hexapods export`: write runs with all their files to one archive, for another machine."""

import json
from typing import Annotated

from cyclopts import Parameter

from app.cli.files import check_writable, write_whole
from app.cli.options import AsJson, Data, RunId
from app.cli.stored_runs import find_run, open_for_reading
from app.settings import read_settings


def export_runs(
    *run_ids: Annotated[RunId, Parameter(required=True)],
    out: Annotated[str, Parameter(metavar="RUN.ZIP")],
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Write runs that have ended, with all their files, to one archive, for another machine.

    It works beside a running server.

    Args:
        out: archive to write

    Raises:
        HexapodError: if a run does not exist or has not ended, or the file cannot be written.
    """
    # Imported here, as the database modules would slow the start of other commands.
    from app.features.archives.transfer import export_chunks, export_many  # noqa: PLC0415

    check_writable(out)
    with open_for_reading(read_settings(data=data)) as store:
        exported = [store.get(find_run(store, run_id).id) for run_id in run_ids]
        first, *further = exported
        ids = [run.id for run in exported]
        archive = b"".join(export_many(store, ids) if further else export_chunks(store, first.id))
    write_whole(out, archive)
    if as_json:
        named = {"ids": ids} if further else {"id": first.id}
        print(json.dumps({**named, "file": out, "bytes": len(archive)}))
    else:
        subject = f"{len(exported)} runs are" if further else f"{first.kind} {first.id} is"
        print(
            f"{subject.capitalize()} in {out} ({len(archive) / 1e6:.1f} MB); `hexapods import` "
            f"takes {'them' if further else 'it'} in."
        )
    return 0
