"""The trials of experiments, as rows."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, String, bindparam, cast, delete, insert, select

from app.domain.text import visible
from app.storage.database.columns import decoded
from app.storage.database.engine import Database
from app.storage.database.queries import Row, found, row_of_run
from app.storage.database.schema import TRIALS


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
                self.insert(connection, run_id, added)

        self._database.write(work)

    def insert(
        self, connection: Connection, run_id: str, rows: Sequence[Mapping[str, Any]]
    ) -> None:
        """Add rows to a run that has none of these keys, within a transaction."""
        if rows:
            connection.execute(insert(TRIALS), [{"run_id": run_id, **row} for row in rows])

    def of(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """See `RunStore.trials`. One that cannot be read has no result, and says so."""
        wanted = select(*_RAW).where(TRIALS.c.run_id == run_id).order_by(TRIALS.c.key)

        def work(connection: Connection) -> Sequence[Row]:
            row_of_run(connection, run_id)
            return found(connection, wanted)

        return [_decoded(row) for row in self._database.read(work)]


_RAW = (
    TRIALS.c.key,
    cast(TRIALS.c.result, String).label("result"),
    TRIALS.c.set_aside,
    TRIALS.c.compute_s,
)


def _decoded(row: Row) -> dict[str, Any]:
    seconds, set_aside = row["compute_s"], row["set_aside"]
    fields = {
        "key": visible(str(row["key"])),
        "set_aside": None if set_aside is None else visible(str(set_aside)),
        "compute_s": seconds if isinstance(seconds, int | float) else 0.0,
    }
    try:
        result = None if row["result"] is None else decoded(json.loads(row["result"]))
        if not isinstance(result, dict | None):
            raise TypeError("it is no object")
    except (ValueError, TypeError, RecursionError):
        return {**fields, "result": None, "set_aside": "what the database holds of it is damaged"}
    return {**fields, "result": result}
