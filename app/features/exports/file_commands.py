"""Verbs of `hexapods runs` that write a run's walk to a file, one for each export format."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import AsJson, Data, RunId
from app.cli.setting_options import DeclaredOptions, with_options
from app.cli.stored_runs import find_run, open_for_reading
from app.settings import read_settings
from app.storage.run import Run
from hexapods.domain.errors import InvalidInput
from hexapods.exports.export_format import IN_PROCESS, EncodedReplay, ExportFormat, as_bytes
from hexapods.exports.registry import EXPORTS
from hexapods.runs.clocks import Clock


def add_to(verbs: App) -> None:
    """Add the verbs."""
    for name, export in EXPORTS.items():
        verbs.command(with_options(_verb(export)), name=name, help=f"Write {export.title}.")


def _verb(export: ExportFormat) -> Callable[..., int]:
    """Return the verb that writes files of a format."""
    endings = " or ".join(f".{ending}" for ending in export.endings)

    def write_file(
        run_id: RunId,
        /,
        *,
        out: Annotated[
            str,
            Parameter(
                metavar=f"FILE.{export.endings[0]}", help=f"file to write, ending with {endings}"
            ),
        ],
        data: Data = None,
        as_json: AsJson = False,
        **settings: Annotated[Any, DeclaredOptions(export.settings, flags=export.flags)],
    ) -> int:
        run, size = _write(export, run_id, Path(out), settings, data)
        if as_json:
            print(json.dumps({"id": run.id, "file": out, "bytes": size}))
        else:
            print(f"{run.kind.capitalize()} {run.id} is in {out} ({size_text(size)}).")
        return 0

    return write_file


def _write(
    export: ExportFormat, run_id: str, out: Path, settings: Mapping[str, Any], data: str | None
) -> tuple[Run, int]:
    """Write the file; return the run and the file's size. Works beside a running server."""
    # Imported here, as these modules would slow the start of other commands.
    from app.features.exports.stored_walks import source_of  # noqa: PLC0415
    from app.stage.playback import Replays  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415

    try:
        file = export.file(out.suffix.removeprefix("."))
    except InvalidInput as error:
        raise InvalidInput(f"{error}: {out}") from error
    options = export.options(**settings)
    check_writable(str(out))
    with open_for_reading(read_settings(data=data)) as store:
        run = store.get(find_run(store, run_id).id)
        recordings = Recordings(store)

        def encode(run_id: str, clock: Clock) -> EncodedReplay:
            from app.viewer.replay_frames import ReplayFrames  # noqa: PLC0415 - takes a second

            return ReplayFrames(Replays(store, recordings)).encoded(run_id, clock)

        source = source_of(run, recordings, encode)
        content = b"".join(as_bytes(export.write(source, file, options, IN_PROCESS)))
    write_whole(str(out), content)
    return run, len(content)
