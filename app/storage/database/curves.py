"""Rows of the `evaluations` table: the learning curves of trainings."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, delete, func, insert, select

from app.storage.database.engine import Database
from app.storage.database.queries import Row, fetch_rows, fetch_run_row
from app.storage.database.schema import EVALUATIONS, RUNS

_ROWS_AT_ONCE = 10_000


class Curves:
    """Reads and writes the learning curves in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def append(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Append rows to a training's curve, replacing its rows from the first new step on.

        A training that resumes from a checkpoint repeats the evaluations after that checkpoint.

        Args:
            run_id: id of the training.
            rows: `step`, `distance_m` [m] and `epsilon` (exploration rate) of each evaluation.

        Raises:
            NotFound: if there is no such run.
        """
        if not rows:
            return
        first = min(row["step"] for row in rows)
        repeated = EVALUATIONS.c.run_id == run_id, EVALUATIONS.c.step >= first

        def work(connection: Connection) -> None:
            fetch_run_row(connection, run_id, for_update=True)
            connection.execute(delete(EVALUATIONS).where(*repeated))
            self.insert(connection, run_id, rows)

        self._database.write(work)

    def insert(
        self, connection: Connection, run_id: str, rows: Sequence[Mapping[str, Any]]
    ) -> None:
        """Insert rows within a transaction, for steps that the run does not have yet."""
        # In parts, since an import may have very many.
        for first in range(0, len(rows), _ROWS_AT_ONCE):
            chunk = rows[first : first + _ROWS_AT_ONCE]
            connection.execute(insert(EVALUATIONS), [{"run_id": run_id, **row} for row in chunk])

    def get(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """Return a training's curve so far, by step: `step`, `distance_m`, `epsilon`."""
        curve = select(EVALUATIONS).where(EVALUATIONS.c.run_id == run_id)

        def work(connection: Connection) -> Sequence[Row]:
            fetch_run_row(connection, run_id)
            return fetch_rows(connection, curve.order_by(EVALUATIONS.c.step))

        return [
            {name: _number(row[name]) for name in ("step", "distance_m", "epsilon")}
            for row in self._database.read(work)
        ]

    def thinned(
        self, run_ids: Collection[str], most: int
    ) -> Mapping[str, Sequence[tuple[int, float]]]:
        """Return a few points of several curves, with one query: by id (step, distance [m]).

        Args:
            run_ids: ids of trainings; those without evaluations have no entry.
            most: points of a curve at most, at even distances; the newest is one of them.
        """
        run_id, step = EVALUATIONS.c.run_id, EVALUATIONS.c.step
        deleted = select(RUNS.c.id).where(RUNS.c.deleted_at.is_not(None))
        numbered = (
            select(
                run_id,
                step,
                EVALUATIONS.c.distance_m,
                func.row_number().over(partition_by=run_id, order_by=step).label("number"),
                func.count().over(partition_by=run_id).label("total"),
            )
            .where(run_id.in_(run_ids), run_id.not_in(deleted))
            .subquery()
        )
        from_last = numbered.c.total - numbered.c.number
        stride = (numbered.c.total + most - 1) // most
        thinned = select(numbered).where(from_last % stride == 0).order_by(numbered.c.step)
        curves: dict[str, list[tuple[int, float]]] = {}
        for row in self._database.read(lambda connection: fetch_rows(connection, thinned)):
            point = (row["step"], _number(row["distance_m"]))
            curves.setdefault(row["run_id"], []).append(point)
        return curves

    def delete_after(self, run_id: str, after_step: int) -> None:
        """Delete the rows of a training's curve after this step."""
        later = EVALUATIONS.c.run_id == run_id, EVALUATIONS.c.step > after_step
        self._database.write(
            lambda connection: connection.execute(delete(EVALUATIONS).where(*later))
        )


def _number(value: Any) -> float:
    """Return a number; NaN for NULL and for any other type that SQLite may hold."""
    return value if isinstance(value, int | float) else float("nan")
