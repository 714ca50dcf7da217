"""The trials of an experiment as the `trials.json` of its archive, and its files beside that."""

import json
import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from app.domain.errors import DamagedFile
from app.experiments.config import ExperimentConfig
from app.services.experiment_entry import plan_of
from app.services.store import SUMMARY, Run
from app.services.strict import Strict

TRIALS = "trials.json"
_REPORTED = re.compile(
    r"report\.html|summary\.json|trials\.csv|figures/[a-z0-9_-]{1,80}\.(png|svg|pdf)", re.ASCII
)
_BEGINS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-"}

_Count = Annotated[int, Meta(ge=0)]
_Words = Annotated[str, Meta(max_length=10_000)]
_Metres = float | None


class _Counts(Strict, frozen=True):
    done: _Count
    total: _Count
    failed: _Count
    set_aside: _Count


class _Claim(Strict, frozen=True):
    id: Annotated[str, Meta(max_length=100)]
    verdict: Annotated[str, Meta(max_length=100)]


class ExperimentResult(Strict, frozen=True):
    """The result of an experiment's run."""

    trials: _Counts
    claims: Annotated[list[_Claim], Meta(max_length=1_000)]
    files: Annotated[list[Annotated[str, Meta(max_length=100)]], Meta(max_length=128)]
    shared_machine: bool


class _Lane(Strict, frozen=True):
    agent: str
    decision_s: float
    finished_distance_m: float
    elapsed_s: float
    rank: Annotated[int, Meta(ge=1)]


class _Result(Strict, frozen=True):
    distances_m: Annotated[list[float], Meta(max_length=1_000)]
    finished_distance_m: _Metres
    elapsed_s: float | None
    transitions: _Count
    wall: list[_Lane] | None
    failure: _Words | None


class _Row(Strict, frozen=True):
    key: Annotated[str, Meta(max_length=1_000)]
    result: _Result | None
    set_aside: _Words | None
    compute_s: Annotated[float, Meta(ge=0)]


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
    if SUMMARY not in files:
        return
    try:
        summary = msgspec.json.decode(files[SUMMARY], type=dict[str, Any])
        if summary["experiment"] != run.config.experiment:  # type: ignore[union-attr]
            raise ValueError("it is of another experiment")
    except (ValueError, KeyError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of {said} is no summary ({error})") from error
