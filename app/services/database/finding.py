"""Rows as plain dictionaries, and the one of a run."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Connection, Executable, select

from app.services.database.schema import RUNS
from app.services.errors import NotFound

Row = dict[str, Any]


def found(connection: Connection, statement: Executable) -> Sequence[Row]:
    """What a statement finds."""
    return [{**row} for row in connection.execute(statement).mappings()]


def row_of_run(connection: Connection, run_id: str, and_hold: bool = False) -> Row:
    """The row of a run, which nobody else changes before the transaction ends if it is held.

    Raises:
        NotFound: if there is none.
    """
    wanted = select(RUNS).where(RUNS.c.id == run_id)
    rows = found(connection, wanted.with_for_update() if and_hold else wanted)
    if not rows:
        raise NotFound(f"there is no run {run_id!r} (any more)")
    return rows[0]
