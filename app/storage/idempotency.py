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

Start = Callable[[IdempotencyKey | None], Run]
"""Creates a run, and passes the key to the store in the same call."""
Import = Callable[[IdempotencyKey | None], Sequence[Run]]
"""Creates several runs in the same way."""


@dataclass
class _KeyLock:
    """Lock for the requests with one key, and the number of requests that hold or await it."""

    lock: threading.Lock = field(default_factory=threading.Lock)
    users: int = 0


class Idempotency:
    """Starts a run unless the same key started one before. Thread-safe."""

    def __init__(self, store: RunStore) -> None:
        """Use the idempotency keys of a store."""
        self._store = store
        self._key_locks: defaultdict[str, _KeyLock] = defaultdict(_KeyLock)
        self._lock = threading.Lock()

    def run(self, key: str | None, request: bytes, start: Start) -> Run:
        """Return the run that this key started before, or start it now.

        Requests with the same key are serialised. A start that fails stores no key, so that a
        retry with the same key starts again.

        Args:
            key: chosen by the client; None always starts a run.
            request: canonical bytes of the request; their SHA-256 is compared.
            start: creates the run and stores the key.

        Returns:
            the run in its present state.

        Raises:
            InvalidInput: if this key came with another request before.
            Gone: if the run that this key started was deleted.
        """
        return self.runs(key, request, lambda key: [start(key)])[0]

    def runs(self, key: str | None, request: bytes, create: Import) -> Sequence[Run]:
        """Return the runs that this key created before, or create them now; otherwise as `run`."""
        if key is None:
            return create(None)
        digest = hashlib.sha256(request).hexdigest()
        with self._locked(key):
            record = self._store.find_key(key)
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
