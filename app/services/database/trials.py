"""The trials of experiments, as rows."""

from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, bindparam, delete, insert, select

from app.services.database.engine import Database
from app.services.database.finding import Row, found, row_of_run
from app.services.database.schema import TRIALS

_FIELDS = ("key", "result", "set_aside", "compute_s")


class Trials:
    """The trials in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def append(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """See `RunStore.append_trials`."""
        # By key, since a statement may name a row once only.
        added = [{"run_id": run_id, **row} for row in {row["key"]: row for row in rows}.values()]
        again = delete(TRIALS).where(TRIALS.c.run_id == run_id, TRIALS.c.key == bindparam("again"))

        def work(connection: Connection) -> None:
            row_of_run(connection, run_id, and_hold=True)
            if added:
                connection.execute(again, [{"again": row["key"]} for row in added])
                connection.execute(insert(TRIALS), added)

        self._database.write(work)

    def of(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """See `RunStore.trials`."""
        wanted = select(TRIALS).where(TRIALS.c.run_id == run_id).order_by(TRIALS.c.key)

        def work(connection: Connection) -> Sequence[Row]:
            row_of_run(connection, run_id)
            return found(connection, wanted)

        return [{name: row[name] for name in _FIELDS} for row in self._database.read(work)]
