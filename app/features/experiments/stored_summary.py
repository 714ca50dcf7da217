"""The summary of an experiment for commands: of a results folder, or of a run of the server."""

import json
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.stored_runs import find_run, open_for_reading
from app.settings import read_settings
from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, InvalidInput, OtherFormat
from hexapods.experiments.config import SUMMARY, SUMMARY_FORMAT

Results = Annotated[
    str,
    Parameter(
        name="RESULTS",
        help="folder of `hexapods experiment` or `sweep`, or the id of an experiment of the server",
    ),
]


def read_summary(results: str, data: str | None) -> dict[str, Any]:
    """Return the newest summary of an experiment.

    Args:
        results: path of a results folder, or id of a run.
        data: data folder with the run; None for the usual one.

    Raises:
        InvalidInput: if there is no such folder or run, or it has no summary yet.
        DamagedFile: if the summary cannot be read.
        OtherFormat: if it is of another version.
    """
    path = Path(results)
    if path.is_dir() or path.is_file():
        file = path / SUMMARY if path.is_dir() else path
        try:
            text: str | bytes = file.read_bytes()
        except OSError as error:
            raise InvalidInput(
                f"{results} has no {SUMMARY} of an experiment ({error.strerror}); "
                "`hexapods experiment` writes it at its end"
            ) from error
    else:
        text = _stored(results, data)
    try:
        summary = json.loads(text)
        version = summary["format"]
        check_format(str(results), version, SUMMARY_FORMAT)
        if not all(name in summary for name in ("experiment", "config", "settings", "parameters")):
            raise ValueError("it lacks its settings")
    except OtherFormat:
        raise
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise DamagedFile(f"{results} is no summary of an experiment ({error})") from error
    return dict(summary)


def _stored(run_id: str, data: str | None) -> bytes:
    with open_for_reading(read_settings(data=data)) as store:
        try:
            run = find_run(store, run_id)
        except InvalidInput as error:
            raise InvalidInput(f"there is no folder {run_id}, and {error}") from error
        if run.kind != "experiment":
            raise InvalidInput(f"{run_id} is a {run.kind}, not an experiment")
        summary = store.artifact(run.id, SUMMARY)
    if summary is None:
        raise InvalidInput(f"experiment {run_id} has no summary yet")
    return summary
