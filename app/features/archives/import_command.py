"""`hexapods import`: import the runs of an archive that `hexapods export` wrote."""

import json
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.files import read_bounded
from app.cli.options import AsJson, Data
from app.cli.server_client import call_server
from app.cli.stored_runs import open_for_writing
from app.features.archives.archive import MAX_BYTES
from app.settings import Settings, read_settings
from hexapods.runs.config import usable_agents


def import_archive(
    file: Annotated[str, Parameter(name="RUN.ZIP")],
    /,
    *,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Import the runs of an archive that `hexapods export` wrote, all or none.

    Nothing of the file is believed before it is checked; see docs/operations.md.

    Args:
        file: archive written by `hexapods export`

    Raises:
        HexapodError: if the file is not a valid archive, or a run cannot be stored.
    """
    views = _import(read_settings(data=data), read_bounded(file, MAX_BYTES), file)
    if as_json:
        print(json.dumps(views[0] if len(views) == 1 else {"items": views}))
        return 0
    for view in views:
        print(f"{file} is {view['kind']} {view['id']} here, {view['name']!r}.")
    return 0


def _import(settings: Settings, data: bytes, label: str) -> list[dict[str, Any]]:
    # Imported here, as the database modules would slow the start of other commands.
    from app.events.run_view import run_view  # noqa: PLC0415
    from app.features.archives.transfer import import_runs  # noqa: PLC0415
    from app.storage.run_ids import RunIds  # noqa: PLC0415
    from app.storage.server_lock import FolderInUse  # noqa: PLC0415

    try:
        with open_for_writing(settings) as store:
            runs = import_runs(store, data, RunIds.of(store), usable_agents(), label)
            return [run_view(run) for run in runs]
    except FolderInUse:
        answer = call_server(settings, "POST", "api/v1/runs/import", data)
        views: list[dict[str, Any]] = answer["items"]
        return views
