"""The trials of an experiment as the `trials.json` of its archive, and its files beside that."""

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from app.archive.untrusted_input import Large, Metres, Name, PortableText, Seconds, UntrustedInput
from app.domain.errors import DamagedFile
from app.domain.text import is_formula
from app.experiments.config import ExperimentConfig
from app.jobs.submissions import plan_of
from app.storage.store import SUMMARY, Run

TRIALS = "trials.json"
_REPORTED = re.compile(
    r"report\.html|summary\.json|trials\.csv|figures/[a-z0-9_-]{1,80}\.(png|svg|pdf)", re.ASCII
)
_BEGINS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-"}


class _Counts(UntrustedInput, frozen=True):
    done: Large
    total: Large
    failed: Large
    set_aside: Large


class _Claim(UntrustedInput, frozen=True):
    id: Name
    verdict: Name


class ExperimentResult(UntrustedInput, frozen=True):
    """The result of an experiment's run."""

    trials: _Counts
    claims: Annotated[list[_Claim], Meta(max_length=1_000)]
    files: Annotated[list[Name], Meta(max_length=128)]
    shared_machine: bool


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


class _Row(UntrustedInput, frozen=True):
    key: Annotated[str, Meta(max_length=1_000)]
    result: _Result | None
    set_aside: PortableText | None
    compute_s: Seconds


class _Cost(msgspec.Struct):
    wall_s: Seconds


class _Summary(msgspec.Struct):
    """What the server and the page rely on in a summary; the rest is for readers of it."""

    experiment: Name
    trials: dict[str, Any]
    cost: _Cost | None
    settings: list[Any]
    claims: list[Any]
    story: list[Any]


def trials_json(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """The trials of an experiment, as `RunStore.trials` has them."""
    return json.dumps(list(rows), indent=0, allow_nan=False).encode()


def read_trials_json(data: bytes, config: ExperimentConfig, said: str) -> list[dict[str, Any]]:
    """The trials.

    Args:
        data: what `trials_json` wrote.
        config: the experiment that they are of.
        said: what to call the file in messages.

    Raises:
        DamagedFile: if `trials_json` did not write it, or of another experiment.
    """
    try:
        rows = msgspec.json.decode(data, type=list[_Row])
    except (ValueError, RecursionError) as error:
        raise DamagedFile(f"{said} does not hold trials as it should: {error}") from error
    keys = {row.key for row in rows}
    if len(keys) < len(rows):
        raise DamagedFile(f"{said} has a trial twice")
    if keys - {trial.key for trial in plan_of(config).trials()}:
        raise DamagedFile(f"{said} has a trial that is none of this experiment's")
    if any((row.result is None) == (row.set_aside is None) for row in rows):
        raise DamagedFile(f"{said} has a trial with neither or both of result and set_aside")
    shown: list[dict[str, Any]] = msgspec.to_builtins(rows)
    return shown


def is_reported(name: str) -> bool:
    """Whether an experiment may have a file of this name."""
    return _REPORTED.fullmatch(name) is not None


def reported_files(run: Run) -> list[str]:
    """The files that an experiment may have left behind."""
    files: list[str] = (run.result or {}).get("files", [])
    return list(dict.fromkeys([SUMMARY, *files]))


def check_reported(run: Run, files: Mapping[str, bytes], said: str) -> None:
    """Make sure that files are what their names say; nothing is believed of what they show.

    Raises:
        DamagedFile: if one is not.
    """
    for name, data in files.items():
        suffix = name.rpartition(".")[2]
        if not is_reported(name) or name not in reported_files(run):
            raise DamagedFile(f"{said} has {name}, which this experiment has not")
        if not data.startswith(_BEGINS.get(suffix, b"")):
            raise DamagedFile(f"{said} has {name}, which is no {suffix.upper()}")
        if suffix == "csv":
            _check_cells(data, f"{name} of {said}")
    if SUMMARY not in files:
        return
    try:
        summary = msgspec.json.decode(files[SUMMARY], type=_Summary)
        if summary.experiment != run.config.experiment:  # type: ignore[union-attr]
            raise ValueError("it is of another experiment")
    except (ValueError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of {said} is no summary ({error})") from error


def _check_cells(data: bytes, said: str) -> None:
    """Make sure that a spreadsheet takes nothing in a table for a formula.

    Raises:
        DamagedFile: if it is no table, or it would.
    """
    try:
        rows = list(csv.reader(io.StringIO(data.decode(), newline="")))
    except (ValueError, csv.Error) as error:
        raise DamagedFile(f"{said} is no table ({error})") from error
    cell = next((cell for row in rows for cell in row if is_formula(cell)), None)
    if cell is not None:
        raise DamagedFile(
            f"{said} has a cell that a spreadsheet takes for a formula: {cell[:40]!r}"
        )
