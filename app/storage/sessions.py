"""Sessions of operators' browsers: random ids in cookies, kept by the server as hashes."""

import hashlib
import secrets
import threading
from collections.abc import Callable, Collection, Sequence
from datetime import UTC, datetime, timedelta
from typing import NamedTuple, Protocol

SESSION_S = 30 * 24 * 3600
MAX_SESSIONS = 1000


class SessionRow(NamedTuple):
    """A session as it is stored.

    Attributes:
        id_sha256: hash of what is in the cookie.
        token_sha256: hash of the token that it was opened with.
        created_at, expires_at: in UTC.
    """

    id_sha256: str
    token_sha256: str
    created_at: datetime
    expires_at: datetime


class SessionRows(Protocol):
    """Where sessions outlive the server."""

    def load(self) -> Sequence[SessionRow]:
        """All that are stored, the oldest first."""

    def add(self, row: SessionRow) -> None:
        """Store one more."""

    def remove(self, ids_sha256: Collection[str]) -> None:
        """Forget some."""


class MemorySessionRows:
    """Implements `SessionRows` for as long as the process lives."""

    def __init__(self) -> None:
        self._rows: dict[str, SessionRow] = {}

    def load(self) -> Sequence[SessionRow]:
        """All that are stored, the oldest first."""
        return list(self._rows.values())

    def add(self, row: SessionRow) -> None:
        """Store one more."""
        self._rows[row.id_sha256] = row

    def remove(self, ids_sha256: Collection[str]) -> None:
        """Forget some."""
        for one in ids_sha256:
            self._rows.pop(one, None)


class Sessions:
    """The sessions that a token opened. Safe to use from any thread.

    They are looked up in memory, since one server has the store; what is stored is for the next.
    """

    def __init__(
        self,
        rows: SessionRows,
        token: str,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        """Load what is stored, and forget what has expired or another token opened.

        Args:
            rows: where they are stored.
            token: of the server.
            now: the clock.

        Raises:
            StorageFailed: if the store cannot be used.
        """
        self._rows, self._now = rows, now
        self._token_sha256 = _sha256(token)
        self._lock = threading.Lock()
        stored = rows.load()
        valid = [row for row in stored if self._is_valid(row)]
        self._open = {row.id_sha256: row for row in valid}
        ended = {row.id_sha256 for row in stored} - self._open.keys()
        if ended:
            rows.remove(ended)

    def open(self) -> str:
        """Open a session, in place of the oldest one if there are too many. Returns its id.

        Raises:
            StorageFailed, StorageFull: if it cannot be stored.
        """
        session_id, now = secrets.token_urlsafe(32), self._now()
        expires_at = now + timedelta(seconds=SESSION_S)
        row = SessionRow(_sha256(session_id), self._token_sha256, now, expires_at)
        with self._lock:
            ended = [key for key, one in self._open.items() if not self._is_valid(one)]
            left = [key for key in self._open if key not in ended]
            ended += left[: max(0, len(left) + 1 - MAX_SESSIONS)]
            self._rows.add(row)
            self._open[row.id_sha256] = row
            if ended:
                self._rows.remove(ended)
                for key in ended:
                    del self._open[key]
        return session_id

    def is_open(self, session_id: str) -> bool:
        """Whether a cookie's value is the id of a session that has not expired."""
        # By its hash: how long that takes to find says nothing of the id.
        row = self._open.get(_sha256(session_id))
        return row is not None and self._is_valid(row)

    def close(self, session_id: str) -> None:
        """End a session; nothing happens if there is none.

        Raises:
            StorageFailed: if the store cannot be used.
        """
        key = _sha256(session_id)
        with self._lock:
            if key in self._open:
                self._rows.remove([key])
                del self._open[key]

    def _is_valid(self, row: SessionRow) -> bool:
        return row.token_sha256 == self._token_sha256 and self._now() < row.expires_at


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
