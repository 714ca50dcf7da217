"""Idempotency keys as rows: which request started which run."""

from datetime import UTC, datetime

from sqlalchemy import Connection, delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.queries import found
from app.storage.database.schema import IDEMPOTENCY_KEYS
from app.storage.store import KEY_KEPT, MAX_KEYS, IdempotencyKey, Started

_KEYS = IDEMPOTENCY_KEYS


class Keys:
    """The idempotency keys of a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def note(self, connection: Connection, key: IdempotencyKey | None, run_id: str) -> None:
        """Remember a key within the transaction that adds its run, and forget those of old."""
        if key is None:
            return
        now = datetime.now(UTC)
        made = _KEYS.c.created_at
        # NULL, and so before none, where there are fewer.
        last = select(made).order_by(made.desc()).offset(MAX_KEYS - 2).limit(1).scalar_subquery()
        is_old = (made < now - KEY_KEPT) | (made < last) | (_KEYS.c.key == key.key)
        connection.execute(delete(_KEYS).where(is_old))
        connection.execute(insert(_KEYS), [{**key._asdict(), "run_id": run_id, "created_at": now}])

    def find(self, key: str) -> Started | None:
        """See `RunStore.started_by`."""
        since = datetime.now(UTC) - KEY_KEPT
        wanted = select(_KEYS.c.digest, _KEYS.c.run_id).where(
            _KEYS.c.key == key, _KEYS.c.created_at >= since
        )
        rows = self._database.read(lambda connection: found(connection, wanted))
        return Started(**rows[0]) if rows else None
