"""Rows of the `idempotency_keys` table: which request created which runs.

`run_id` has the ids of an import of several, separated by spaces.
"""

from collections.abc import Iterable
from datetime import UTC, datetime

from sqlalchemy import Connection, delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.schema import IDEMPOTENCY_KEYS
from app.storage.database.stored_rows import Values, read_rows
from app.storage.errors import Conflict
from app.storage.run import KEY_LIFETIME, MAX_KEYS, IdempotencyKey, KeyRecord

_KEYS = IDEMPOTENCY_KEYS


class Keys:
    """Reads and writes the idempotency keys in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def insert(
        self, connection: Connection, key: IdempotencyKey | None, run_ids: Iterable[str]
    ) -> None:
        """Insert a key within the transaction that inserts its runs; delete expired keys."""
        if key is None:
            return
        now = datetime.now(UTC)
        created = _KEYS.c.created_at
        # NULL if there are fewer keys; a comparison with it deletes none.
        nth = select(created).order_by(created.desc()).offset(MAX_KEYS - 2).limit(1)
        oldest_kept = nth.scalar_subquery()
        is_expired = (
            (created < now - KEY_LIFETIME) | (created < oldest_kept) | (_KEYS.c.key == key.key)
        )
        connection.execute(delete(_KEYS).where(is_expired))
        row = {**key._asdict(), "run_id": " ".join(run_ids), "created_at": now}
        connection.execute(insert(_KEYS), [row])

    def delete_expired(self) -> None:
        """Delete the keys that were not used within their lifetime."""
        statement = delete(_KEYS).where(_KEYS.c.created_at < datetime.now(UTC) - KEY_LIFETIME)
        self._database.write(lambda connection: connection.execute(statement))

    def find(self, key: str) -> KeyRecord | None:
        """Look up an idempotency key; None if it was not used within its lifetime.

        Raises:
            Conflict: if what is stored of it is damaged.
        """
        rows = read_rows(self._database, _KEYS, Values, where=_KEYS.c.key == key)
        if rows.damaged:
            raise Conflict(
                "what the database holds of this Idempotency-Key is damaged; see whether its run "
                "is there, and send a new key to start another",
                "damaged",
            )
        since = datetime.now(UTC) - KEY_LIFETIME
        recent = (row for row in rows.sound if row["created_at"] >= since)
        return next(
            (KeyRecord(row["digest"], tuple(row["run_id"].split())) for row in recent), None
        )
