"""The roles of a stage's clients: operators by its token or a session, and spectators.

Spectators have read access, and may ask questions; operators may also start, change, stop and
delete runs.
"""

import hashlib
import hmac
from typing import Literal

from app.storage.sessions import SessionRows, Sessions

Role = Literal["operator", "spectator"]


class Roles:
    """Roles of clients on a stage: operators, and spectators if others may watch. Thread-safe."""

    def __init__(
        self, token: str | None, rows: SessionRows | None = None, *, is_public: bool = True
    ) -> None:
        """Load the sessions that were opened with the token.

        Args:
            token: makes its bearer an operator; None makes everyone one.
            rows: persistent storage of the sessions, which no other stage uses; None for none.
            is_public: whether spectators need no token.

        Raises:
            StorageFailed: if the sessions cannot be read.
        """
        self._token = token
        self._sessions = None if token is None else Sessions(rows, token)
        self.is_public = is_public or token is None

    @property
    def needs_token(self) -> bool:
        """Whether operators need a token."""
        return self._token is not None

    def of(self, token: str, session_id: str) -> Role:
        """Return the role of a client, by the token and the session id that it sent, or ""."""
        if self._sessions is None or self.is_token(token):
            return "operator"
        is_open = bool(session_id) and self._sessions.is_open(session_id)
        return "operator" if is_open else "spectator"

    def is_token(self, text: str) -> bool:
        """Whether this is the token."""
        return self._token is not None and _equal_in_constant_time(text, self._token)

    def open_session(self) -> str:
        """Open the session of an operator, and return its id; "" if no token is needed.

        Raises:
            StorageFailed, StorageFull: if it cannot be stored.
        """
        return "" if self._sessions is None else self._sessions.open()


def _equal_in_constant_time(first: str, other: str) -> bool:
    """Compare in constant time, against timing attacks; by hash, which hides the lengths, too."""
    hashes = [hashlib.sha256(text.encode("utf-8", "surrogateescape")) for text in (first, other)]
    return hmac.compare_digest(*(text_hash.digest() for text_hash in hashes))
