"""Browser sessions of operators: random session ids in cookies, stored only as SHA-256 hashes."""

import hashlib
import secrets
import threading
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

from sqlalchemy import delete, insert

from app.storage.database.engine import Database
from app.storage.database.schema import SESSIONS
from app.storage.database.stored_rows import read_rows

SESSION_S = 30 * 24 * 3600
"""Lifetime of a session [s]."""
MAX_SESSIONS = 1000
"""Open sessions at most; the oldest are closed first."""


class SessionRow(NamedTuple):
    """A stored session.

    Attributes:
        id_sha256: SHA-256 of the session id in the cookie, hexadecimal.
        token_sha256: SHA-256 of the access token that opened the session, hexadecimal.
        created_at, expires_at: in UTC.
    """

    id_sha256: str
    token_sha256: str
    created_at: datetime
    expires_at: datetime


class SessionRows:
    """Rows of the `sessions` table."""

    def __init__(self, database: Database) -> None:
        """Use the sessions of a database."""
        self._database = database

    def load(self) -> Sequence[SessionRow]:
        """Return all stored sessions that can be read, oldest first."""
        return read_rows(self._database, SESSIONS, SessionRow, SESSIONS.c.created_at).sound

    def add(self, row: SessionRow) -> None:
        """Store a session."""
        statement = insert(SESSIONS).values(row._asdict())
        self._database.write(lambda connection: connection.execute(statement))

    def keep(self, ids_sha256: Collection[str]) -> None:
        """Delete all sessions but those with these hashed ids; also those that are damaged."""
        statement = delete(SESSIONS).where(SESSIONS.c.id_sha256.not_in(ids_sha256))
        self._database.write(lambda connection: connection.execute(statement))

    def remove(self, ids_sha256: Collection[str]) -> None:
        """Delete the sessions with these hashed ids."""
        statement = delete(SESSIONS).where(SESSIONS.c.id_sha256.in_(ids_sha256))
        self._database.write(lambda connection: connection.execute(statement))


class Sessions:
    """Opens, checks and closes the sessions of one access token. Thread-safe.

    Lookups use an in-memory copy, since exactly one server owns the store; the rows are there so
    that sessions survive a restart.
    """

    def __init__(
        self,
        rows: SessionRows | None,
        token: str,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        """Load the stored sessions; delete those that expired, are damaged, or of another token.

        Args:
            rows: persistent storage, of the sessions of this token alone; None for none.
            token: the server's access token.
            now: the clock, with time zone.

        Raises:
            StorageFailed: if the store is unavailable.
        """
        self._rows, self._now = rows, now
        self._token_sha256 = _sha256(token)
        self._lock = threading.Lock()
        stored = [] if rows is None else rows.load()
        valid = [row for row in stored if self._is_valid(row)]
        self._open = {row.id_sha256: row for row in valid}
        if rows is not None:
            rows.keep(list(self._open))

    def open(self) -> str:
        """Open a session and return its id; beyond `MAX_SESSIONS` the oldest is closed.

        Raises:
            StorageFailed, StorageFull: if it cannot be stored.
        """
        session_id, now = secrets.token_urlsafe(32), self._now()
        expires_at = now + timedelta(seconds=SESSION_S)
        row = SessionRow(_sha256(session_id), self._token_sha256, now, expires_at)
        with self._lock:
            ended = [key for key, opened in self._open.items() if not self._is_valid(opened)]
            remaining = [key for key in self._open if key not in ended]
            ended += remaining[: max(0, len(remaining) + 1 - MAX_SESSIONS)]
            if self._rows is not None:
                self._rows.add(row)
            self._open[row.id_sha256] = row
            self._remove(ended)
        return session_id

    def is_open(self, session_id: str) -> bool:
        """Whether a cookie's value is the id of a session that has not expired."""
        # Looked up by hash, so the timing of the lookup reveals nothing about the id.
        row = self._open.get(_sha256(session_id))
        return row is not None and self._is_valid(row)

    def close(self, session_id: str) -> None:
        """Close a session; does nothing if it is not open.

        Raises:
            StorageFailed: if the store is unavailable.
        """
        key = _sha256(session_id)
        with self._lock:
            if key in self._open:
                self._remove([key])

    def _remove(self, keys: Collection[str]) -> None:
        if keys and self._rows is not None:
            self._rows.remove(keys)
        for key in keys:
            self._open.pop(key, None)

    def _is_valid(self, row: SessionRow) -> bool:
        return row.token_sha256 == self._token_sha256 and self._now() < row.expires_at


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
