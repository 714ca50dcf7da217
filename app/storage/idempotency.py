"""Idempotency keys: a repeated start returns the run that it created first.

The key is kept in the database, in the transaction that creates the run. So there is never the one
without the other, whatever ends the server in between, and a retry after a restart finds it.
"""

import hashlib
import threading
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from app.domain.errors import InvalidInput
from app.storage.errors import Gone, NotFound
from app.storage.store import IdempotencyKey, Run, RunStore

Start = Callable[[IdempotencyKey | None], Run]
"""Creates a run, and gives the key to the store together with it."""


@dataclass
class _Turn:
    lock: threading.Lock = field(default_factory=threading.Lock)
    waiting: int = 0


class Idempotency:
    """Starts what was not started before with the same key. Safe to use from any thread."""

    def __init__(self, store: RunStore) -> None:
        """Look up keys in a store."""
        self._store = store
        self._turns: defaultdict[str, _Turn] = defaultdict(_Turn)
        self._lock = threading.Lock()

    def run(self, key: str | None, request: bytes, start: Start) -> Run:
        """The run that `start` creates, or created when this was asked for before.

        Requests with one key take turns. A start that fails is not remembered, so that the next
        with its key tries again.

        Args:
            key: chosen by the client; None starts in any case.
            request: what is asked for.
            start: starts it.

        Returns:
            the run as it is now.

        Raises:
            InvalidInput: if something else was asked for with this key.
            Gone: if the run that this key started was deleted.
        """
        if key is None:
            return start(None)
        digest = hashlib.sha256(request).hexdigest()
        with self._turn(key):
            started = self._store.started_by(key)
            if started is None:
                return start(IdempotencyKey(key, digest))
            if started.digest != digest:
                raise InvalidInput(
                    "this Idempotency-Key came with another request before; send a new key with "
                    "each new request, and the same only to repeat one"
                )
            try:
                return self._store.get(started.run_id)
            except NotFound as error:
                raise Gone(
                    f"run {started.run_id}, which this Idempotency-Key started, was deleted; send "
                    "a new key to start another"
                ) from error

    @contextmanager
    def _turn(self, key: str) -> Iterator[None]:
        with self._lock:
            turn = self._turns[key]
            turn.waiting += 1
        try:
            with turn.lock:
                yield
        finally:
            with self._lock:
                turn.waiting -= 1
                if not turn.waiting:
                    del self._turns[key]
