"""Schema 0005: the settings of agents as a member of their own in configs and changes."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

from hexapods.runs.version_1 import nested_change, nested_config

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Rewrite the configs and the changes of existing rows."""
    connection = op.get_bind()
    rows = connection.execute(
        sa.text("SELECT id, CAST(config AS VARCHAR), CAST(changes AS VARCHAR) FROM runs")
    ).all()
    is_postgresql = connection.dialect.name == "postgresql"
    change = sa.text(
        "UPDATE runs SET config = CAST(:config AS JSON), changes = CAST(:changes AS JSON) "
        "WHERE id = :id"
        if is_postgresql
        else "UPDATE runs SET config = :config, changes = :changes WHERE id = :id"
    )
    for run_id, config, changes in rows:
        nested = _nested(config, changes)
        # A damaged row may have an id of any type, or one that is not UTF-8; it stays damaged.
        if nested is not None and isinstance(run_id, str) and run_id.isascii():
            connection.execute(change, {**nested, "id": run_id})


def _nested(config: Any, changes: Any) -> dict[str, str] | None:
    try:
        new = {
            "config": nested_config(json.loads(config)),
            "changes": [nested_change(one) for one in json.loads(changes)],
        }
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None  # damaged
    return {name: json.dumps(value) for name, value in new.items()}
