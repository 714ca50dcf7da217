"""Rows of the `visitor_runs` table: runs of the visitors of a demo."""

import re
from collections.abc import Collection, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, NamedTuple

from sqlalchemy import delete, insert, select, update

from app.features.demo.tables import VISITOR_RUNS
from app.storage.database.engine import Database
from app.storage.database.schema import RUNS
from app.storage.database.stored_rows import read_rows
from app.storage.run import STATES, State

UNREADABLE = "unreadable"
"""Visitor of runs whose visitor cannot be read; no key has such a hash."""


_HASH = re.compile("[0-9a-f]{64}")


class VisitorRun(NamedTuple):
    """A run of a visitor.

    Attributes:
        run_id: id of the run, which may have been deleted.
        visitor: SHA-256 of the key in the visitor's cookie, hexadecimal.
        steps: number of steps to compute; of a race summed over its lanes.
        is_main: whether the visitor started this run itself, not one that needs it.
        created_at: time of the start, in UTC.
    """

    run_id: str
    visitor: str
    steps: int
    is_main: bool
    created_at: datetime


_IF_DAMAGED = {
    "visitor": UNREADABLE,
    "steps": 0,
    "is_main": False,
    "created_at": datetime(1970, 1, 1, tzinfo=UTC),
}
"""Values in place of unreadable ones. A run of unknown age counts as old enough to be deleted."""


class VisitorRows:
    """Reads and writes the runs of visitors in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def all(self) -> list[VisitorRun]:
        """Return all runs, sound ones oldest first; unreadable values are as in `_IF_DAMAGED`.

        So each run is deleted in time: one that is left out here would stay for ever.
        """
        rows = read_rows(self._database, VISITOR_RUNS, _run, VISITOR_RUNS.c.run_id)
        damaged = (row.values for row in rows.damaged if "run_id" in row.values)
        return [
            *rows.sound,
            *(VisitorRun(**{**_IF_DAMAGED, **_checked(values)}) for values in damaged),
        ]

    def states(
        self, states: Collection[State] = STATES, *, visitor: str | None = None
    ) -> Mapping[str, str]:
        """Return the states of the runs that are kept and not deleted, by id.

        Args:
            states: only of runs in these states.
            visitor: only of runs of this visitor; None for all.
        """
        query = (
            select(RUNS.c.id, RUNS.c.state)
            .join(VISITOR_RUNS, VISITOR_RUNS.c.run_id == RUNS.c.id)
            .where(RUNS.c.deleted_at.is_(None))
        )
        if states is not STATES:
            query = query.where(RUNS.c.state.in_(states))
        if visitor is not None:
            query = query.where(VISITOR_RUNS.c.visitor == visitor)
        rows = self._database.read(lambda connection: connection.execute(query).all())
        return {str(run_id): str(state) for run_id, state in rows}

    def add(self, rows: Sequence[VisitorRun]) -> None:
        """Insert runs, all or none."""
        values = [row._asdict() for row in rows]
        statement = insert(VISITOR_RUNS)
        self._database.write(lambda connection: connection.execute(statement, values))

    def give(self, run_ids: Collection[str], visitor: str) -> None:
        """Assign runs to another visitor, all or none."""
        statement = (
            update(VISITOR_RUNS).where(VISITOR_RUNS.c.run_id.in_(run_ids)).values(visitor=visitor)
        )
        self._database.write(lambda connection: connection.execute(statement))

    def remove(self, run_ids: Collection[str]) -> None:
        """Delete the rows of runs; the runs themselves stay."""
        statement = delete(VISITOR_RUNS).where(VISITOR_RUNS.c.run_id.in_(run_ids))
        self._database.write(lambda connection: connection.execute(statement))


def _run(**values: Any) -> VisitorRun:
    if _checked(values) != values:
        raise ValueError("visitor: it is no SHA-256")
    return VisitorRun(**values)


def _checked(values: dict[str, Any]) -> dict[str, Any]:
    """Return the values of a row; without `visitor`, if that is no SHA-256."""
    is_hash = _HASH.fullmatch(values.get("visitor", ""))
    return {name: value for name, value in values.items() if is_hash or name != "visitor"}
