"""Serialise runs to plain JSON types, as sent by the API and in `run` events."""

from datetime import UTC, datetime
from typing import Any

from app.storage.run import (
    PAUSED,
    RESUMABLE,
    AnyRun,
    DamagedRun,
    Run,
)
from app.storage.run_kind import added_kind
from app.storage.run_names import is_named
from hexapods.domain.records import to_json
from hexapods.runs.best_known import best_known_in_race_m
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import plans_with
from hexapods.runs.race_config import RaceConfig


def run_view(run: AnyRun, queue_position: int | None = None) -> dict[str, Any]:
    """Serialise a run; a damaged one with the fields that can be read, and the reason.

    Times are ISO 8601 in UTC.

    Args:
        run: in its present state.
        queue_position: of a queued run, 1 for the next to start; None for others.
    """
    if isinstance(run, DamagedRun):
        return _damaged_view(run)
    return _whole_view(run, queue_position)


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
        "is_named": is_named(run),
        "state": run.state,
        "config": _config(run),
        "queue_position": queue_position,
        "progress": {"done": run.done, "total": run.total},
        "eta_s": run.eta_s,
        "result": None if run.result is None else to_json(run.result),
        "error": run.error,
        "tags": list(run.tags),
        "notes": run.notes,
        "can_resume": run.state in RESUMABLE | PAUSED,
        "created_at": _time(run.created_at),
        "started_at": _time(run.started_at),
        "ended_at": _time(run.ended_at),
    }
    if run.kind == "race":
        view["waiting_for"] = list(run.waiting_for)
        view["best_known_m"] = _best_known_m(run)
    elif (kind := added_kind(run.kind)) is not None:
        view |= kind.view(run)
    else:
        view["greedy_distance_m"] = run.greedy_distance_m
        view["changes"] = [dict(change) for change in run.changes]
    return view


def _best_known_m(race: Run) -> float | None:
    return best_known_in_race_m(race.config) if isinstance(race.config, RaceConfig) else None


def _config(run: Run) -> dict[str, Any]:
    config = to_json(run.config)
    if isinstance(run.config, RaceConfig):
        lanes = zip(run.config.lanes, config["lanes"], run.lane_training_ids, strict=True)
        config["lanes"] = [
            {
                **fields,
                "plans_with": plans_with(lane, run.config),
                "plans_with_by_default": lane.plans_with is None,
                "training_id": training,
            }
            for lane, fields, training in lanes
        ]
    elif isinstance(run.config, TrainingConfig):
        config["continue_from"] = run.continued_from
    return config


def _time(time: datetime | None) -> str | None:
    if time is None:
        return None
    return time.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
