"""Detect, list and count damaged runs: runs that cannot be decoded, or whose JSON is unusable."""

import threading
import time
from collections.abc import Mapping
from typing import Any

import msgspec

from app.storage.database.store import RunStore
from app.storage.json_text import is_finite
from app.storage.run import AnyRun, DamagedRun, Kind, Run
from hexapods.runs.clocks import CLOCKS

_PAGE_SIZE = 200
_CACHE_S = 300.0


class _TrainingResult(msgspec.Struct):
    """Fields of a training's result that clients rely on; further fields are ignored."""

    distance_m: float | None
    greedy_distance_m: float | None = None


class _Figures(msgspec.Struct):
    finished_distance_m: float | None
    elapsed_s: float
    crossed_s: float | None
    rank: int | None


class _LaneResult(msgspec.Struct):
    agent: str
    clocks: dict[str, _Figures]
    steps: int
    decision_s: float
    simulated_transitions: int
    total_distance_m: float | None
    failure: str | None


class _RaceResult(msgspec.Struct):
    lanes: list[_LaneResult]


class _Claim(msgspec.Struct):
    verdict: str


class _ExperimentResult(msgspec.Struct):
    claims: list[_Claim]
    files: list[str]


_RESULTS: Mapping[Kind, Any] = {
    "training": _TrainingResult,
    "race": _RaceResult,
    "experiment": _ExperimentResult,
}


def as_shown(run: AnyRun) -> AnyRun:
    """Return the run, or a `DamagedRun` if clients could not use its JSON.

    The store detects rows that it cannot decode; this detects non-finite numbers and results that
    lack fields.
    """
    damage = None if isinstance(run, DamagedRun) else _damage(run)
    if damage is None:
        return run
    fields = {name: getattr(run, name) for name in ("id", "kind", "name", "state", "created_at")}
    return DamagedRun(**fields, damaged=damage)


def _damage(run: Run) -> str | None:
    """Return why clients could not use a run's JSON; None if they can."""
    try:
        return _non_finite_field(run) or _invalid_result(run)
    except RecursionError:
        return "its result is nested too deeply"


def _non_finite_field(run: Run) -> str | None:
    for name in ("eta_s", "greedy_distance_m", "changes", "result"):
        if not is_finite(getattr(run, name)):
            return f"its {name} has NaN or an infinity"
    return None


def _invalid_result(run: Run) -> str | None:
    if run.result is None:
        return None
    try:
        result = msgspec.convert(run.result, _RESULTS[run.kind])
    except msgspec.ValidationError as error:
        return f"its result cannot be read ({error})"
    if isinstance(result, _RaceResult) and any(
        set(CLOCKS) - {*lane.clocks} for lane in result.lanes
    ):
        return "its result lacks a clock"
    return None


def damaged_runs(store: RunStore) -> list[DamagedRun]:
    """Return all damaged runs of a store, newest first; reads every run.

    Raises:
        StorageFailed: if the store cannot be read.
    """
    damaged: list[DamagedRun] = []
    cursor = None
    while True:
        page = store.list(limit=_PAGE_SIZE, cursor=cursor)
        damaged += [run for run in map(as_shown, page.items) if isinstance(run, DamagedRun)]
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
