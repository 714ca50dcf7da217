"""How far runs are, between the moments in which the database is told."""

import threading
import time
from typing import Any, NamedTuple

WRITE_EVERY_S = 1.0
"""A job says thirty times a second how far it is; so much of that a dead server may forget."""


class _Noted(NamedTuple):
    fields: dict[str, Any]
    written_s: float


class Progress:
    """The newest progress of runs that are worked on. Safe to use from any thread."""

    def __init__(self) -> None:
        self._noted: dict[str, _Noted] = {}
        self._lock = threading.Lock()

    def note(self, run_id: str, fields: dict[str, Any]) -> bool:
        """Take in progress. True if it is time to write it."""
        now = time.monotonic()
        with self._lock:
            noted = self._noted.get(run_id)
            is_due = noted is None or now - noted.written_s >= WRITE_EVERY_S
            written_s = now if noted is None or is_due else noted.written_s
            self._noted[run_id] = _Noted(fields, written_s)
            return is_due

    def of(self, run_id: str) -> dict[str, Any]:
        """The fields that are newer than the database, or the same."""
        with self._lock:
            noted = self._noted.get(run_id)
            return {} if noted is None else noted.fields

    def newest(self) -> dict[str, dict[str, Any]]:
        """The fields of every run that has any, by id."""
        with self._lock:
            return {run_id: noted.fields for run_id, noted in self._noted.items()}

    def forget_estimate(self, run_id: str) -> None:
        """Keep how far it is, and drop how long it will take."""
        with self._lock:
            noted = self._noted.get(run_id)
            if noted is not None:
                self._noted[run_id] = noted._replace(fields={**noted.fields, "eta_s": None})

    def forget(self, run_id: str) -> None:
        """Drop all of a run, because the database has it or something else."""
        with self._lock:
            self._noted.pop(run_id, None)
