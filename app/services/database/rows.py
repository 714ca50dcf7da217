"""Runs as rows of the database, and back."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from app.domain.errors import HexapodError
from app.services.configs import config_as_json, config_of
from app.services.errors import StorageFailed
from app.services.store import Config, Run

_TUPLES = ("lane_training_ids", "waiting_for", "changes")


def row_of(run: Run) -> dict[str, Any]:
    """All columns of a run."""
    return columns_of({field.name: getattr(run, field.name) for field in fields(run)})


def columns_of(values: Mapping[str, Any]) -> dict[str, Any]:
    """Some fields of a run as the columns take them."""
    columns = dict(values)
    config: Config | None = columns.get("config")
    if config is not None:
        columns["config"] = config_as_json(config)
    for name in _TUPLES:
        if name in columns:
            columns[name] = [dict(v) if isinstance(v, Mapping) else v for v in columns[name]]
    return columns


def run_of(row: Mapping[str, Any]) -> Run:
    """The run of a row.

    Raises:
        StorageFailed: if no version of this product wrote it so.
    """
    values = dict(row)
    try:
        values["config"] = config_of(row["kind"], row["config"])
        values |= {name: tuple(row[name]) for name in _TUPLES}
    except (HexapodError, KeyError, TypeError, ValueError) as error:
        raise StorageFailed(
            f"the database holds run {row['id']} in a way that this version cannot read ({error})"
        ) from error
    return Run(**values)
