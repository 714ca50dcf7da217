"""Trials and report files of an experiment in its archive: encode and validate them."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

import msgspec
from msgspec import UNSET, Meta, UnsetType

from app.features.experiments.start import plan_of
from app.storage.errors import Damaged
from app.storage.json_text import is_finite
from app.storage.run import Run
from app.storage.untrusted_input import (
    Large,
    Metres,
    Name,
    PortableText,
    Seconds,
    UntrustedInput,
    check_json,
)
from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, OtherFormat
from hexapods.domain.text import is_formula
from hexapods.experiments.config import (
    REPORT,
    SUMMARY,
    SUMMARY_FORMAT,
    TRIALS_TABLE,
    ExperimentConfig,
)

TRIALS = "trials.json"


class _Lane(UntrustedInput, frozen=True):
    agent: Name
    decision_s: Seconds
    finished_distance_m: Metres
    elapsed_s: Seconds
    rank: Annotated[int, Meta(ge=1)]


class _Result(UntrustedInput, frozen=True):
    distances_m: Annotated[list[Metres], Meta(max_length=1_000)]
    finished_distance_m: Metres | None
    elapsed_s: Seconds | None
    transitions: Large
    wall: list[_Lane] | None
    failure: PortableText | None
    earned_m: Annotated[list[Metres], Meta(max_length=1_000)] | UnsetType = UNSET


class _Row(UntrustedInput, frozen=True):
    key: Annotated[str, Meta(max_length=1_000)]
    result: _Result | None
    set_aside: PortableText | None
    compute_s: Seconds


class _Cost(msgspec.Struct):
    wall_s: Seconds


class _SummaryHead(msgspec.Struct):
    """Version of a summary's format."""

    format: int


class _Summary(msgspec.Struct):
    """Fields of a summary that the server and the page rely on; others are not validated."""

    experiment: Name
    trials: dict[str, Any]
    cost: _Cost | None
    settings: list[Any]
    claims: list[Any]
    story: list[Any]
    parameters: list[Name]


def trials_json(run_id: str, rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Encode the trials of an experiment, as returned by `Trials.get`, as `trials.json`.

    Raises:
        Damaged: if they have NaN or an infinity, which would be null in JSON.
    """
    if not is_finite(rows):
        raise Damaged(run_id, "its trials have NaN or an infinity")
    return json.dumps(list(rows), indent=0, allow_nan=False).encode()


def take_trials(
    members: dict[str, bytes], config: ExperimentConfig, label: str
) -> list[dict[str, Any]]:
    """Remove `trials.json` from the members of an archive, and return its rows.

    Raises:
        DamagedFile: as `read_trials_json`, or if it is not there.
    """
    if TRIALS not in members:
        raise DamagedFile(f"{label} is no archive of an experiment: it has no {TRIALS}")
    return read_trials_json(members.pop(TRIALS), config, f"{TRIALS} of {label}")


def read_trials_json(data: bytes, config: ExperimentConfig, label: str) -> list[dict[str, Any]]:
    """Parse and validate `trials.json`.

    Args:
        data: as written by `trials_json`.
        config: of the experiment.
        label: name of the file for error messages.

    Returns:
        rows for `Trials.append`.

    Raises:
        DamagedFile: if it is malformed, or has trials that are not in the experiment's plan.
    """
    try:
        check_json(data)
        rows = msgspec.json.decode(data, type=list[_Row])
    except (ValueError, RecursionError) as error:
        raise DamagedFile(f"{label} does not hold trials as it should: {error}") from error
    keys = {row.key for row in rows}
    if len(keys) < len(rows):
        raise DamagedFile(f"{label} has a trial twice")
    plan = plan_of(config)
    if any(plan.find(key) is None for key in keys):
        raise DamagedFile(f"{label} has a trial that is none of this experiment's")
    if any((row.result is None) == (row.set_aside is None) for row in rows):
        raise DamagedFile(f"{label} has a trial with neither or both of result and set_aside")
    trials: list[dict[str, Any]] = msgspec.to_builtins(rows)
    return trials


def is_report_file(name: str) -> bool:
    """Whether an experiment may have a file of this name."""
    return name in (REPORT, SUMMARY, TRIALS_TABLE)


def check_report_files(
    run: Run, names: Iterable[str], files: Mapping[str, bytes], label: str
) -> None:
    """Check that report files have the type of their names; their content is not trusted.

    Args:
        run: the experiment.
        names: of the files that it has by its result.
        files: contents of the archive's files by name.
        label: name of the archive for error messages.

    Raises:
        OtherFormat: if the summary is of another version.
        DamagedFile: if a file is unexpected or malformed.
    """
    for name, data in files.items():
        if not is_report_file(name) or name not in names:
            raise DamagedFile(f"{label} has {name}, which this experiment has not")
        if name == TRIALS_TABLE:
            _check_cells(data, f"{name} of {label}")
    if SUMMARY not in files:
        return
    try:
        head = msgspec.json.decode(files[SUMMARY], type=_SummaryHead)
        check_format(f"{SUMMARY} of {label}", head.format, SUMMARY_FORMAT)
        summary = msgspec.json.decode(files[SUMMARY], type=_Summary)
        if summary.experiment != run.config.experiment:
            raise ValueError("it is of another experiment")
    except OtherFormat:
        raise
    except (ValueError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of {label} is no summary ({error})") from error


def _check_cells(data: bytes, label: str) -> None:
    """Check that no cell of a CSV file would be a formula in a spreadsheet (CSV injection).

    Raises:
        DamagedFile: if it is no CSV file, or has such a cell.
    """
    try:
        rows = list(csv.reader(io.StringIO(data.decode(), newline="")))
    except (ValueError, csv.Error) as error:
        raise DamagedFile(f"{label} is no table ({error})") from error
    cell = next((cell for row in rows for cell in row if is_formula(cell)), None)
    if cell is not None:
        raise DamagedFile(
            f"{label} has a cell that a spreadsheet takes for a formula: {cell[:40]!r}"
        )
