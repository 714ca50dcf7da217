"""Rows of the `baselines` table: distances of one-step look-ahead, which all jobs share."""

from collections.abc import Collection
from datetime import UTC, datetime
from math import isfinite

from sqlalchemy import Connection, delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.schema import BASELINES
from app.storage.database.stored_rows import Values, read_rows

MAX_ROWS = 10_000


class StoredBaselines:
    """Reads and writes the distances of baselines in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def get(self, ids: Collection[str]) -> dict[str, float]:
        """Return the distances that are stored [m], by the ids of the baselines.

        A damaged row counts as missing: its baseline is measured again.
        """
        rows = read_rows(self._database, BASELINES, Values, where=BASELINES.c.id.in_(ids))
        return {row["id"]: row["distance_m"] for row in rows.sound if isfinite(row["distance_m"])}

    def add(self, baseline: str, distance_m: float) -> None:
        """Store a distance [m], in place of the oldest if there are very many."""
        if baseline in self.get([baseline]):
            return
        created = BASELINES.c.created_at
        # NULL if there are fewer rows; a comparison with it deletes none.
        nth = select(created).order_by(created.desc()).offset(MAX_ROWS - 2).limit(1)
        replaced = (BASELINES.c.id == baseline) | (created < nth.scalar_subquery())
        row = {"id": baseline, "distance_m": distance_m, "created_at": datetime.now(UTC)}

        def work(connection: Connection) -> None:
            connection.execute(delete(BASELINES).where(replaced))
            connection.execute(insert(BASELINES), [row])

        self._database.write(work)
