"""List and count what is stored and cannot be read: runs, and rows of all other tables."""

from collections.abc import Callable, Mapping
from threading import Condition
from typing import Any

from cachetools import TTLCache, cached
from sqlalchemy import Table

from app.storage.database import stored_rows
from app.storage.database.schema import RUNS
from app.storage.database.store import RunStore
from app.storage.database.stored_rows import DamagedRow
from app.storage.run import DamagedRun

_PAGE_SIZE = 200
_CACHE_S = 300.0


def damaged_runs(store: RunStore) -> list[DamagedRun]:
    """Return all damaged runs of a store, newest first; reads every run.

    Those of a feature that is left out are none.

    Raises:
        StorageFailed: if the store cannot be read.
    """
    damaged: list[DamagedRun] = []
    cursor = None
    while True:
        page = store.list(limit=_PAGE_SIZE, cursor=cursor)
        damaged += [
            run for run in page.items if isinstance(run, DamagedRun) and not run.is_left_out
        ]
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

    Counting reads every row but those of single runs, which are too many; of one that is damaged
    the answer about its run tells. That is too slow for each request of the metrics.
    """

    def count() -> Mapping[str, int]:
        return {
            RUNS.name: len(damaged_runs(store)),
            **{
                table.name: len(stored_rows.damaged_rows(store.database, table))
                for table in store.database.tables
                if table is not RUNS and not _is_of_runs(table)
            },
        }

    cache: TTLCache[Any, Mapping[str, int]] = TTLCache(maxsize=1, ttl=_CACHE_S)
    return cached(cache, condition=Condition())(count)


def _is_of_runs(table: Table) -> bool:
    """Whether the rows of a table belong to runs, and are deleted with them."""
    return any(key.column.table is RUNS for key in table.foreign_keys)
