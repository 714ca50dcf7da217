"""Runs as the API and the events show them: plain types, fit for JSON."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import msgspec

from app.runs.clocks import CLOCKS
from app.runs.config import RaceConfig, TrainingConfig
from app.storage.configs import config_as_json
from app.storage.json_text import is_finite
from app.storage.store import PAUSED, RESUMABLE, AnyRun, DamagedRun, Kind, Run


class _TrainingResult(msgspec.Struct):
    """What readers of a training's result rely on; further fields are of no matter here."""

    distance_m: float | None
    greedy_distance_m: float | None = None


class _Figures(msgspec.Struct):
    finished_distance_m: float
    elapsed_s: float
    crossed_s: float | None
    rank: int


class _LaneResult(msgspec.Struct):
    agent: str
    clocks: dict[str, _Figures]
    steps: int
    decision_s: float
    simulated_transitions: int
    total_distance_m: float | None
    failure: str | None


class _RaceResult(msgspec.Struct):
    lanes: list[_LaneResult]


class _Claim(msgspec.Struct):
    verdict: str


class _ExperimentResult(msgspec.Struct):
    claims: list[_Claim]
    files: list[str]


_RESULTS: Mapping[Kind, Any] = {
    "training": _TrainingResult,
    "race": _RaceResult,
    "experiment": _ExperimentResult,
}


def run_view(run: AnyRun, queue_position: int | None = None) -> dict[str, Any]:
    """The resource of a run; of a damaged one what can be shown, and why that is not all.

    Times are ISO 8601 in UTC.

    Args:
        run: as it is now.
        queue_position: of a run that waits, 1 for the next.
    """
    shown = as_shown(run)
    if isinstance(shown, DamagedRun):
        return _damaged_view(shown)
    return _whole_view(shown, queue_position)


def as_shown(run: AnyRun) -> AnyRun:
    """The run itself, or as damaged if it cannot be shown as what it is.

    The store finds what it cannot read; here it is what readers of JSON could make nothing of.
    """
    why = None if isinstance(run, DamagedRun) else _trouble(run)
    if why is None:
        return run
    known = {name: getattr(run, name) for name in ("id", "kind", "name", "state", "created_at")}
    return DamagedRun(**known, damaged=why)


def _trouble(run: Run) -> str | None:
    try:
        return _wrong_number(run) or _wrong_result(run)
    except RecursionError:
        return "its result is nested too deeply"


def _wrong_number(run: Run) -> str | None:
    for name in ("eta_s", "greedy_distance_m", "changes", "result"):
        if not is_finite(getattr(run, name)):
            return f"its {name} has a number that is none"
    return None


def _wrong_result(run: Run) -> str | None:
    if run.result is None:
        return None
    try:
        result = msgspec.convert(run.result, _RESULTS[run.kind])
    except msgspec.ValidationError as error:
        return f"its result cannot be read ({error})"
    if isinstance(result, _RaceResult) and any(
        set(CLOCKS) - {*lane.clocks} for lane in result.lanes
    ):
        return "its result lacks a clock"
    return None


def _damaged_view(run: DamagedRun) -> dict[str, Any]:
    return {
        "id": run.id,
        "kind": run.kind,
        "name": run.name,
        "state": run.state,
        "created_at": _time(run.created_at),
        "damaged": run.damaged,
    }


def _whole_view(run: Run, queue_position: int | None) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "id": run.id,
        "kind": run.kind,
        "name": run.name,
        "state": run.state,
        "config": _config(run),
        "queue_position": queue_position,
        "progress": {"done": run.done, "total": run.total},
        "eta_s": run.eta_s,
        "result": run.result,
        "error": run.error,
        "can_resume": run.state in RESUMABLE[run.kind] | PAUSED,
        "created_at": _time(run.created_at),
        "started_at": _time(run.started_at),
        "ended_at": _time(run.ended_at),
    }
    if run.kind == "race":
        shown["waiting_for"] = list(run.waiting_for)
    elif run.kind == "experiment":
        shown["workers"] = run.workers
    else:
        shown["greedy_distance_m"] = run.greedy_distance_m
        shown["changes"] = [dict(change) for change in run.changes]
    return shown


def _config(run: Run) -> dict[str, Any]:
    shown = config_as_json(run.config)
    if isinstance(run.config, RaceConfig):
        lanes = zip(shown["lanes"], run.lane_training_ids, strict=True)
        shown["lanes"] = [{**lane, "training_id": training} for lane, training in lanes]
    elif isinstance(run.config, TrainingConfig):
        shown["continue_from"] = run.continued_from
    return shown


def _time(moment: datetime | None) -> str | None:
    if moment is None:
        return None
    return moment.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
