"""Rows of the `visitor_runs` table: runs of strangers who visit a demo."""

from collections.abc import Collection, Mapping, Sequence
from datetime import datetime
from typing import NamedTuple

from sqlalchemy import delete, insert, select, update

from app.storage.database.engine import Database
from app.storage.database.named_rows import all_rows
from app.storage.database.schema import RUNS, VISITOR_RUNS
from app.storage.run import STATES, State


class VisitorRun(NamedTuple):
    """A run of a visitor.

    Attributes:
        run_id: id of the run, which may have been deleted.
        visitor: SHA-256 of the key in the visitor's cookie, hexadecimal.
        steps: how many it was to compute; of a race summed over its lanes.
        is_main: whether it is what was started, not a training that it needs.
        created_at: in UTC.
    """

    run_id: str
    visitor: str
    steps: int
    is_main: bool
    created_at: datetime


class VisitorRows:
    """Reads and writes the runs of visitors in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def all(self) -> list[VisitorRun]:
        """Return all that can be decoded, oldest first."""
        return all_rows(self._database, VISITOR_RUNS, VisitorRun, VISITOR_RUNS.c.run_id)

    def states(
        self, states: Collection[State] = STATES, *, visitor: str | None = None
    ) -> Mapping[str, str]:
        """Return the states of the runs that are kept, by id.

        Args:
            states: of runs in these alone.
            visitor: of this visitor alone; None for all.
        """
        query = select(RUNS.c.id, RUNS.c.state).join(
            VISITOR_RUNS, VISITOR_RUNS.c.run_id == RUNS.c.id
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
        """Make runs those of another visitor, all or none."""
        statement = (
            update(VISITOR_RUNS).where(VISITOR_RUNS.c.run_id.in_(run_ids)).values(visitor=visitor)
        )
        self._database.write(lambda connection: connection.execute(statement))

    def remove(self, run_ids: Collection[str]) -> None:
        """Delete the links of runs."""
        statement = delete(VISITOR_RUNS).where(VISITOR_RUNS.c.run_id.in_(run_ids))
        self._database.write(lambda connection: connection.execute(statement))
