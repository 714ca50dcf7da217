"""Write-behind cache of the runs' progress, which is written to the database once a second."""

import threading
import time
from typing import Any, NamedTuple

WRITE_EVERY_S = 1.0
"""Interval of writes for each run. Jobs report about thirty times a second; a crash loses at most
this much progress."""


class _Entry(NamedTuple):
    fields: dict[str, Any]
    written_s: float


class ProgressCache:
    """Caches the newest progress of live runs. Thread-safe."""

    def __init__(self) -> None:
        self._entries: dict[str, _Entry] = {}
        self._lock = threading.Lock()

    def put(self, run_id: str, fields: dict[str, Any]) -> bool:
        """Cache a run's progress; return True if the caller must write it to the database now."""
        now = time.monotonic()
        with self._lock:
            entry = self._entries.get(run_id)
            is_due = entry is None or now - entry.written_s >= WRITE_EVERY_S
            written_s = now if entry is None or is_due else entry.written_s
            self._entries[run_id] = _Entry(fields, written_s)
            return is_due

    def get(self, run_id: str) -> dict[str, Any]:
        """Return the cached fields of a run, at least as new as its row; empty if none."""
        with self._lock:
            entry = self._entries.get(run_id)
            return {} if entry is None else entry.fields

    def snapshot(self) -> dict[str, dict[str, Any]]:
        """Return the cached fields of all runs by id."""
        with self._lock:
            return {run_id: entry.fields for run_id, entry in self._entries.items()}

    def drop_estimate(self, run_id: str) -> None:
        """Set the estimated time left to None, and keep the number of steps done."""
        with self._lock:
            entry = self._entries.get(run_id)
            if entry is not None:
                self._entries[run_id] = entry._replace(fields={**entry.fields, "eta_s": None})

    def drop(self, run_id: str) -> None:
        """Remove a run's entry, after its row was written or deleted."""
        with self._lock:
            self._entries.pop(run_id, None)
