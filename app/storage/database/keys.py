"""Rows of the `idempotency_keys` table: which request created which runs.

`run_id` has the ids of an import of several, separated by spaces.
"""

from collections.abc import Iterable
from datetime import UTC, datetime

from sqlalchemy import Connection, delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.queries import fetch_rows
from app.storage.database.schema import IDEMPOTENCY_KEYS
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
        """Look up an idempotency key; None if it was not used within its lifetime."""
        since = datetime.now(UTC) - KEY_LIFETIME
        query = select(_KEYS.c.digest, _KEYS.c.run_id).where(
            _KEYS.c.key == key, _KEYS.c.created_at >= since
        )
        rows = self._database.read(lambda connection: fetch_rows(connection, query))
        return KeyRecord(rows[0]["digest"], tuple(rows[0]["run_id"].split())) if rows else None
