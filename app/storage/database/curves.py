"""The evaluations of trainings, as rows."""

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.queries import Row, found, row_of_run
from app.storage.database.schema import EVALUATIONS


class Curves:
    """The curves of a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def append(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """See `RunStore.append_evaluations`."""
        if not rows:
            return
        first = min(row["step"] for row in rows)
        repeated = EVALUATIONS.c.run_id == run_id, EVALUATIONS.c.step >= first

        def work(connection: Connection) -> None:
            row_of_run(connection, run_id, and_hold=True)
            connection.execute(delete(EVALUATIONS).where(*repeated))
            self.insert(connection, run_id, rows)

        self._database.write(work)

    def insert(
        self, connection: Connection, run_id: str, rows: Sequence[Mapping[str, Any]]
    ) -> None:
        """Add rows to a run that has none of these steps, within a transaction."""
        if rows:
            connection.execute(insert(EVALUATIONS), [{"run_id": run_id, **row} for row in rows])

    def of(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """See `RunStore.evaluations`."""
        curve = select(EVALUATIONS).where(EVALUATIONS.c.run_id == run_id)

        def work(connection: Connection) -> Sequence[Row]:
            row_of_run(connection, run_id)
            return found(connection, curve.order_by(EVALUATIONS.c.step))

        return [
            {name: _number(row[name]) for name in ("step", "distance_m", "epsilon")}
            for row in self._database.read(work)
        ]

    def forget(self, run_id: str, after_step: int) -> None:
        """See `RunStore.forget_evaluations`."""
        later = EVALUATIONS.c.run_id == run_id, EVALUATIONS.c.step > after_step
        self._database.write(
            lambda connection: connection.execute(delete(EVALUATIONS).where(*later))
        )


def _number(value: Any) -> float:
    """NULL, and whatever else SQLite may have there, is NaN."""
    return value if isinstance(value, int | float) else float("nan")
