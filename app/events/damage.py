"""List and count what is stored and cannot be read: runs, and rows of all other tables."""

from collections.abc import Callable, Mapping
from threading import Condition
from typing import Any

from cachetools import TTLCache, cached

from app.storage.database import stored_rows
from app.storage.database.schema import ARTIFACTS, EVALUATIONS, RUNS, TRIALS
from app.storage.database.store import RunStore
from app.storage.database.stored_rows import DamagedRow
from app.storage.run import DamagedRun

OF_RUNS = (EVALUATIONS, TRIALS, ARTIFACTS)
"""Tables that may have very many rows; in the answer about a run one that is damaged is told."""
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


def damaged_rows(store: RunStore) -> Mapping[str, list[DamagedRow]]:
    """Return the damaged rows by table, of every table; reads all of them.

    What a row stands for is checked where this process has loaded it before, as a server has; of
    runs by `damaged_runs`.

    Raises:
        StorageFailed: if the store cannot be read.
    """
    return {
        table.name: stored_rows.damaged_rows(store.database, table)
        for table in store.database.tables
    }


def damage_counts(store: RunStore) -> Callable[[], Mapping[str, int]]:
    """Return a function that returns the number of damaged rows by table, cached for five minutes.

    Counting reads every row but those of `OF_RUNS`, which is too slow for each request of the
    metrics.
    """

    def count() -> Mapping[str, int]:
        return {
            RUNS.name: len(damaged_runs(store)),
            **{
                table.name: len(stored_rows.damaged_rows(store.database, table))
                for table in store.database.tables
                if table not in (RUNS, *OF_RUNS)
            },
        }

    cache: TTLCache[Any, Mapping[str, int]] = TTLCache(maxsize=1, ttl=_CACHE_S)
    return cached(cache, condition=Condition())(count)
