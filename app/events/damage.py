"""List and count the stored runs that cannot be read."""

from collections.abc import Callable
from threading import Condition
from typing import Any

from cachetools import TTLCache, cached

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


def damage_count(store: RunStore) -> Callable[[], int]:
    """Return a function that returns the number of damaged runs, cached for five minutes.

    Counting reads every run, which is too slow for each request of the metrics.
    """
    cache: TTLCache[Any, int] = TTLCache(maxsize=1, ttl=_CACHE_S)
    return cached(cache, condition=Condition())(lambda: len(damaged_runs(store)))
