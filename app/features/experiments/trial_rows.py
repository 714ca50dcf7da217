"""Rows of the `trials` table: the trials of experiments."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, String, bindparam, cast, delete, insert, select

from app.features.experiments.tables import TRIALS
from app.storage.database.columns import decode_json
from app.storage.database.engine import Database
from app.storage.database.queries import Row, fetch_rows, fetch_run_row
from hexapods.domain.text import visible


class Trials:
    """Reads and writes the trials in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def append(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Add trials of an experiment, replacing those with the same key (upsert).

        Args:
            run_id: id of the experiment.
            rows: `key`, `result` (plain types, or None), `set_aside` (why there is no result, or
                None) and `compute_s` [s].

        Raises:
            NotFound: if there is no such run.
        """
        # Deduplicated by key, since one INSERT must not contain a primary key twice.
        added = [{"run_id": run_id, **row} for row in {row["key"]: row for row in rows}.values()]
        again = delete(TRIALS).where(TRIALS.c.run_id == run_id, TRIALS.c.key == bindparam("again"))

        def work(connection: Connection) -> None:
            fetch_run_row(connection, run_id, for_update=True)
            if added:
                connection.execute(again, [{"again": row["key"]} for row in added])
                connection.execute(insert(TRIALS), added)

        self._database.write(work)

    def get(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        """Return the trials of an experiment so far, sorted by key.

        A trial that cannot be decoded is returned as set aside.

        Raises:
            NotFound: if there is no such run.
        """
        query = select(*_UNDECODED).where(TRIALS.c.run_id == run_id).order_by(TRIALS.c.key)

        def work(connection: Connection) -> Sequence[Row]:
            fetch_run_row(connection, run_id)
            return fetch_rows(connection, query)

        return [_decode(row) for row in self._database.read(work)]


_UNDECODED = (
    TRIALS.c.key,
    cast(TRIALS.c.result, String).label("result"),
    TRIALS.c.set_aside,
    TRIALS.c.compute_s,
)


def _decode(row: Row) -> dict[str, Any]:
    seconds, set_aside = row["compute_s"], row["set_aside"]
    fields = {
        "key": visible(str(row["key"])),
        "set_aside": None if set_aside is None else visible(str(set_aside)),
        "compute_s": seconds if isinstance(seconds, int | float) else 0.0,
    }
    try:
        result = None if row["result"] is None else decode_json(json.loads(row["result"]))
        if not isinstance(result, dict | None):
            raise TypeError("it is no object")
    except (ValueError, TypeError, RecursionError):
        return {**fields, "result": None, "set_aside": "what the database holds of it is damaged"}
    return {**fields, "result": result}
