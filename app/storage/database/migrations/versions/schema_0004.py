"""Schema 0004: tags and notes of runs, and the distance by which lists are sorted."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Add the columns, and take the distances from the results of existing rows."""
    is_postgresql = op.get_bind().dialect.name == "postgresql"
    text = sa.String(collation="C" if is_postgresql else None)
    op.add_column("runs", sa.Column("tags", text, nullable=False, server_default=""))
    op.add_column("runs", sa.Column("notes", text, nullable=False, server_default=""))
    op.add_column("runs", sa.Column("distance_m", sa.Double()))
    connection = op.get_bind()
    rows = connection.execute(sa.text("SELECT id, CAST(result AS VARCHAR) FROM runs")).all()
    change = sa.text("UPDATE runs SET distance_m = :distance_m WHERE id = :id")
    for run_id, result in rows:
        distance_m = _distance_m(result)
        # A damaged row may have an id of any type, or one that is not UTF-8.
        if distance_m is not None and isinstance(run_id, str) and run_id.isascii():
            connection.execute(change, {"distance_m": distance_m, "id": run_id})


def _distance_m(text: Any) -> float | None:
    """Return the distance of a training, or of the winner of a race [m]; None if there is none."""
    try:
        result = json.loads(text)
        if "lanes" in result:
            figures = [lane["clocks"]["paper"] for lane in result["lanes"]]
            distance = next(one["finished_distance_m"] for one in figures if one["rank"] == 1)
        else:
            distance = result["distance_m"]
        return float(distance)
    except (ValueError, KeyError, TypeError, AttributeError, StopIteration, RecursionError):
        return None  # not ended, of an experiment, NaN, or damaged
