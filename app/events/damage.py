"""Counts and names the stored runs that cannot be shown."""

import threading
import time

from app.events.run_view import as_shown
from app.storage.store import DamagedRun, RunStore

_PAGE = 200
_COUNT_AGAIN_S = 300.0


def damaged_runs(store: RunStore) -> list[DamagedRun]:
    """All runs of a store that cannot be shown, newest first; every run is read for it."""
    damaged: list[DamagedRun] = []
    cursor = None
    while True:
        page = store.list(limit=_PAGE, cursor=cursor)
        damaged += [run for run in map(as_shown, page.items) if isinstance(run, DamagedRun)]
        cursor = page.next_cursor
        if cursor is None:
            return damaged


class DamageCount:
    """How many runs of a store cannot be shown. Safe to use from any thread.

    All runs are read to know it, so that the number may be five minutes old.
    """

    def __init__(self, store: RunStore) -> None:
        self._store, self._lock = store, threading.Lock()
        self._count, self._counted_s = 0, -float("inf")

    def __call__(self) -> int:
        """The number.

        Raises:
            StorageFailed: if the store cannot be read.
        """
        with self._lock:
            if time.monotonic() - self._counted_s > _COUNT_AGAIN_S:
                self._count = len(damaged_runs(self._store))
                self._counted_s = time.monotonic()
            return self._count
