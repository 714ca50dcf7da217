"""Serialise runs to plain JSON types, as sent by the API and in `run` events."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import msgspec

from app.runs.clocks import CLOCKS
from app.runs.config import RaceConfig, TrainingConfig
from app.storage.json_text import is_finite
from app.storage.run import PAUSED, RESUMABLE, AnyRun, DamagedRun, Kind, Run, config_as_json


class _TrainingResult(msgspec.Struct):
    """Fields of a training's result that clients rely on; further fields are ignored."""

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
    """Serialise a run; a damaged one with the fields that can be read, and the reason.

    Times are ISO 8601 in UTC.

    Args:
        run: in its present state.
        queue_position: of a queued run, 1 for the next to start; None for others.
    """
    checked = as_shown(run)
    if isinstance(checked, DamagedRun):
        return _damaged_view(checked)
    return _whole_view(checked, queue_position)


def as_shown(run: AnyRun) -> AnyRun:
    """Return the run, or a `DamagedRun` if clients could not use its JSON.

    The store detects rows that it cannot decode; this detects non-finite numbers and results that
    lack fields.
    """
    damage = None if isinstance(run, DamagedRun) else _damage(run)
    if damage is None:
        return run
    fields = {name: getattr(run, name) for name in ("id", "kind", "name", "state", "created_at")}
    return DamagedRun(**fields, damaged=damage)


def _damage(run: Run) -> str | None:
    """Return why clients could not use a run's JSON; None if they can."""
    try:
        return _non_finite_field(run) or _invalid_result(run)
    except RecursionError:
        return "its result is nested too deeply"


def _non_finite_field(run: Run) -> str | None:
    for name in ("eta_s", "greedy_distance_m", "changes", "result"):
        if not is_finite(getattr(run, name)):
            return f"its {name} has a number that is none"
    return None


def _invalid_result(run: Run) -> str | None:
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
    view: dict[str, Any] = {
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
        view["waiting_for"] = list(run.waiting_for)
    elif run.kind == "experiment":
        view["workers"] = run.workers
    else:
        view["greedy_distance_m"] = run.greedy_distance_m
        view["changes"] = [dict(change) for change in run.changes]
    return view


def _config(run: Run) -> dict[str, Any]:
    config = config_as_json(run.config)
    if isinstance(run.config, RaceConfig):
        lanes = zip(config["lanes"], run.lane_training_ids, strict=True)
        config["lanes"] = [{**lane, "training_id": training} for lane, training in lanes]
    elif isinstance(run.config, TrainingConfig):
        config["continue_from"] = run.continued_from
    return config


def _time(time: datetime | None) -> str | None:
    if time is None:
        return None
    return time.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
