"""List and count the stored runs that cannot be read."""

import threading
import time

from app.storage.database.store import RunStore
from app.storage.run import DamagedRun

_PAGE_SIZE = 200
_CACHE_S = 300.0


def damaged_runs(store: RunStore) -> list[DamagedRun]:
    """Return all damaged runs of a store, newest first; reads every run.

    Raises:
        StorageFailed: if the store cannot be read.
    """
    damaged: list[DamagedRun] = []
    cursor = None
    while True:
        page = store.list(limit=_PAGE_SIZE, cursor=cursor)
        damaged += [run for run in page.items if isinstance(run, DamagedRun)]
        cursor = page.next_cursor
        if cursor is None:
            return damaged


class DamageCount:
    """Number of damaged runs of a store, cached for five minutes. Thread-safe.

    Counting reads every run, which is too slow for each request of the metrics.
    """

    def __init__(self, store: RunStore) -> None:
        self._store, self._lock = store, threading.Lock()
        self._count, self._counted_s = 0, -float("inf")

    def __call__(self) -> int:
        """Return the cached number, counting again if it is too old.

        Raises:
            StorageFailed: if the store cannot be read.
        """
        with self._lock:
            if time.monotonic() - self._counted_s > _CACHE_S:
                self._count = len(damaged_runs(self._store))
                self._counted_s = time.monotonic()
            return self._count
