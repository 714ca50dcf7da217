"""Encode runs as rows of the database, and decode them, tolerating damaged rows."""

import json
from collections.abc import Collection, Mapping
from dataclasses import fields
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any

from app.storage.database.columns import decode_json, decode_tags
from app.storage.database.queries import MAX_CELL_CHARS, public_id
from app.storage.errors import Damaged
from app.storage.json_text import finite, is_finite
from app.storage.run import (
    STATES,
    AnyRun,
    Config,
    DamagedRun,
    Run,
    ranking_distance_m,
)
from app.storage.run_kind import run_kinds
from hexapods.domain.records import from_json, to_json
from hexapods.domain.text import MAX_MESSAGE, NOTES_CONTROLS, message, visible
from hexapods.runs.config import WalkingProblem
from hexapods.runs.race_config import RaceConfig

_MAX_TEXT = 10_000
_MAX_CACHED_CONFIG_CHARS = 10_000
"""Longer configs are parsed anew each time instead of being cached."""
_CHANGES = ("step", "pace", "settings", "disturbance", "presses")
_LISTS = ("lane_training_ids", "waiting_for", "changes")
_TIMES = ("created_at", "started_at", "ended_at")


def encode_run(run: Run) -> dict[str, Any]:
    """Encode a run as a row with all columns."""
    return encode_fields({field.name: getattr(run, field.name) for field in fields(run)})


def encode_fields(values: Mapping[str, Any]) -> dict[str, Any]:
    """Encode some fields of a run as column values."""
    columns = dict(values)
    for name in ("config", "result"):
        if columns.get(name) is not None:
            columns[name] = to_json(columns[name])
    for name in _LISTS:
        if name in columns:
            columns[name] = [dict(v) if isinstance(v, Mapping) else v for v in columns[name]]
    if "result" in columns:
        columns["distance_m"] = ranking_distance_m(values["result"])
    if columns.get("error") is not None:
        columns["error"] = message(columns["error"])
    return columns


def decode_run(row: Mapping[str, Any], kinds: Collection[str]) -> Run:
    """Decode a row that `queries` read.

    Args:
        row: of a run.
        kinds: names of the kinds of runs that are not left out.

    Raises:
        Damaged: if this version cannot decode it, or its kind is left out.
    """
    run = try_decode_run(row, kinds)
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    return run


def try_decode_run(row: Mapping[str, Any], kinds: Collection[str]) -> AnyRun:
    """Decode a row as `decode_run` does; return a `DamagedRun` if that fails."""
    kind = row["kind"] if row["kind"] in run_kinds() else None
    is_left_out = kind is not None and kind not in kinds
    try:
        if not is_left_out:
            return _decode(row)
        reason = f"it can be seen again once the feature of {kind}s is not left out any more"
    except Exception as error:  # parsing a config of another version may raise anything
        reason = f"this version cannot read what the database holds of it ({_describe(error)})"
    return DamagedRun(
        id=public_id(row["id"]),
        kind=kind,
        name=visible(row["name"])[:_MAX_TEXT] if isinstance(row["name"], str) else None,
        state=row["state"] if row["state"] in STATES else None,
        created_at=_created_at_or_none(row["created_at"]),
        damaged=reason,
        is_left_out=is_left_out,
    )


def _decode(row: Mapping[str, Any]) -> Run:
    if public_id(row["id"]) != row["id"]:
        raise ValueError("its id is malformed")
    if (kind := run_kinds().get(row["kind"])) is None:
        kinds = ", ".join(run_kinds())
        name = str(row["kind"])[:40]
        raise ValueError(
            f"its kind, {name}, is none of {kinds}; if a feature adds it, put that feature back "
            "before you delete the run"
        )
    values = {k: v for k, v in row.items() if k not in ("config", "result")}
    for name in _LISTS:
        values[name] = tuple(_json(name, row[name]))
    values |= {name: decode_time(name, row[name]) for name in _TIMES}
    for name in ("name", "error", "continued_from"):
        values[name] = _text(name, row[name], is_needed=name == "name")
    values["tags"] = tuple(visible(tag) for tag in decode_tags(_limited("tags", row["tags"])))
    values["notes"] = visible(_limited("notes", row["notes"]), NOTES_CONTROLS)
    parse = _config if len(row["config"]) <= _MAX_CACHED_CONFIG_CHARS else _config.__wrapped__
    values["config"] = config = parse(row["kind"], row["config"])
    if (result := _json("result", row["result"])) is not None:
        # JSON has no NaN: what was not measured is null.
        values["result"] = from_json(kind.result, finite(result), extra="ignore")
    if isinstance(config, RaceConfig) and len(config.lanes) != len(values["lane_training_ids"]):
        raise ValueError("its numbers of lanes and of training ids differ")
    run = from_json(Run, values)
    if any(change.keys() - _CHANGES or "step" not in change for change in run.changes):
        raise ValueError(f"its changes are none of {', '.join(_CHANGES)}, with a step")
    for name in ("eta_s", "greedy_distance_m", "changes"):
        # Of the run, as `NaN` in a column of text is read as a number.
        if not is_finite(getattr(run, name)):
            raise ValueError(f"its {name} has NaN or an infinity")
    return run


@lru_cache(maxsize=512)
def _config(kind: str, text: str) -> Config:
    """Parse a config, cached: parsing dominates a listing, and many runs have the same config."""
    values, config = _json("config", text), run_kinds()[kind].config
    # Whoever starts a run may leave the gait out; a row without one was not written by this app.
    if issubclass(config, WalkingProblem) and "gait" not in values:
        raise ValueError("its config names no gait")
    return from_json(config, values)


def forget_configs() -> None:
    """Parse all configs anew, as robots in them have other names."""
    _config.cache_clear()


def _json(name: str, text: Any) -> Any:
    if text is None:
        return None
    if len(text) > MAX_CELL_CHARS:
        raise ValueError(f"its {name} is too long")
    return decode_json(json.loads(text))


def decode_time(name: str, text: Any) -> datetime | None:
    """Return the time of a column in UTC; None if there is none.

    Args:
        name: of the column, for errors.
        text: what it holds.

    Raises:
        ValueError: if it is no plausible time.
    """
    if text is None:
        return None
    moment = datetime.fromisoformat(text)
    # SQLite drops the time zone.
    moment = moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)
    if not 1970 <= moment.year < 9999:
        raise ValueError(f"its {name} is not between the years 1970 and 9998")
    return moment


def _created_at_or_none(text: Any) -> datetime | None:
    try:
        return decode_time("created_at", text)
    except (ValueError, TypeError, OverflowError):
        return None


def _text(name: str, value: Any, *, is_needed: bool) -> str | None:
    if value is None and not is_needed:
        return None
    if not isinstance(value, str):
        raise ValueError(f"its {name} is not a text")
    if name == "error":
        # Not checked by `visible`: an agent's exception may have several lines.
        return value[:MAX_MESSAGE].encode("utf-8", "replace").decode()
    return visible(_limited(name, value))


def _limited(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"its {name} is not a text")
    if len(value) > _MAX_TEXT:
        raise ValueError(f"its {name} is too long")
    return value


def _describe(error: Exception) -> str:
    return visible(f"{type(error).__name__}: {error}" if str(error) else type(error).__name__)[:300]
