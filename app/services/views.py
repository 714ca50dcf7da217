"""Runs as the API and the events show them: plain types, fit for JSON."""

from datetime import UTC, datetime
from typing import Any

from app.runs.config import RaceConfig, TrainingConfig
from app.services.configs import config_as_json
from app.services.store import PAUSED, RESUMABLE, Run


def run_view(run: Run, queue_position: int | None = None) -> dict[str, Any]:
    """The resource of a run. Times are ISO 8601 in UTC.

    Args:
        run: as it is now.
        queue_position: of a run that waits, 1 for the next.
    """
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
