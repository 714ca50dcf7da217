"""Idempotency keys: a repeated start or import returns the runs that it created first.

The key is stored in the transaction that creates the runs. So neither is ever stored without the
other, even if the server crashes in between, and a retry after a restart finds the run.
"""

import hashlib
import threading
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from app.storage.database.store import RunStore
from app.storage.errors import Gone, NotFound
from app.storage.run import IdempotencyKey, Run
from hexapods.domain.errors import InvalidInput

Create = Callable[[IdempotencyKey | None], Sequence[Run]]
"""Creates runs, and passes the key to the store in the same call."""


@dataclass
class _KeyLock:
    """Lock for the requests with one key, and the number of requests that hold or await it."""

    lock: threading.Lock = field(default_factory=threading.Lock)
    users: int = 0


class Idempotency:
    """Creates runs unless the same key created some before. Thread-safe."""

    def __init__(self, store: RunStore) -> None:
        """Use the idempotency keys of a store."""
        self._store = store
        self._key_locks: defaultdict[str, _KeyLock] = defaultdict(_KeyLock)
        self._lock = threading.Lock()

    def runs(self, key: str | None, request: bytes, create: Create) -> Sequence[Run]:
        """Return the runs that this key created before, or create them now.

        Requests with the same key are serialised. A creation that fails stores no key, so that a
        retry with the same key starts again.

        Args:
            key: chosen by the client; None always creates runs.
            request: canonical bytes of the request; their SHA-256 is compared.
            create: creates the runs and stores the key.

        Returns:
            the runs in their present state.

        Raises:
            InvalidInput: if this key came with another request before.
            Gone: if a run that this key created was deleted.
        """
        if key is None:
            return create(None)
        digest = hashlib.sha256(request).hexdigest()
        with self._locked(key):
            record = self._store.keys.find(key)
            if record is None:
                return create(IdempotencyKey(key, digest))
            if record.digest != digest:
                raise InvalidInput(
                    "this Idempotency-Key came with another request before; send a new key with "
                    "each new request, and the same only to repeat one"
                )
            return [self._run(run_id) for run_id in record.run_ids]

    def _run(self, run_id: str) -> Run:
        try:
            return self._store.get(run_id)
        except NotFound as error:
            raise Gone(
                f"run {run_id}, which this Idempotency-Key started, was deleted; send a new key "
                "to start another"
            ) from error

    @contextmanager
    def _locked(self, key: str) -> Iterator[None]:
        with self._lock:
            key_lock = self._key_locks[key]
            key_lock.users += 1
        try:
            with key_lock.lock:
                yield
        finally:
            with self._lock:
                key_lock.users -= 1
                if not key_lock.users:
                    del self._key_locks[key]
