"""Recordings of ended runs: stored as `.npz` artifacts, with an LRU cache in memory."""

import io
import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from app.domain.errors import HexapodError
from app.runs.recording import (
    Arrays,
    LaneRecording,
    PracticeRecording,
    race_arrays,
    race_recording,
)
from app.runs.stored_practice import evaluation_arrays, practice_arrays, practice_recording
from app.runs.transition_log import (
    BYTES_PER_STEP,
    TransitionLog,
    transition_arrays,
    transitions,
)
from app.storage.artifact_file import ReadableArtifact
from app.storage.database.store import RunStore
from app.storage.errors import NotFound

RACE, PRACTICE = "race.npz", "practice.npz"
EVALUATIONS_PER_FILE, TRANSITIONS_PER_FILE = 20, 50_000
"""Evaluations and logged steps per file: a growing training rewrites only its last file."""
CACHE_RECORDINGS, CACHE_BYTES = 16, 50_000_000
"""Capacity of each cache in recordings and in bytes; the newest entry is kept whatever its size."""
_MISS_TTL_S = 1.0
"""Time for which a cached miss is valid before the store is read again."""
T = TypeVar("T")
_logger = logging.getLogger(__name__)


class StoredRecordings:
    """Reads and writes recordings of ended runs, with an LRU cache per kind. Thread-safe."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._trainings = _LruCache[PracticeRecording](
            lambda run_id: _read_training(store, run_id), attrgetter("size")
        )
        self._races = _LruCache[list[LaneRecording]](
            lambda run_id: _read_race(store, run_id), lambda lanes: sum(one.size for one in lanes)
        )
        self._logs = _LruCache[TransitionLog](
            lambda run_id: _read_transitions(store, run_id), lambda log: BYTES_PER_STEP * len(log)
        )
        self._evaluations: dict[str, int] = {}
        self._logged: dict[str, int] = {}

    def training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of a training; None if there is none, or it is damaged."""
        return self._trainings.get(run_id)

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """Return the recordings of a race's lanes; None if there are none, or they are damaged."""
        return self._races.get(run_id)

    def transitions(self, run_id: str) -> TransitionLog | None:
        """Return the log of a training's transitions; None if there is none, or it is damaged."""
        return self._logs.get(run_id)

    def write_transitions(self, run_id: str, log: TransitionLog | None) -> None:
        """Store a log incrementally: files that are complete, or have nothing new, are skipped.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        done, end = self._logged.get(run_id, 0), 0 if log is None else len(log)
        if log is None or done == end:
            return
        for number in range(done // TRANSITIONS_PER_FILE, -(-end // TRANSITIONS_PER_FILE)):
            first = number * TRANSITIONS_PER_FILE
            part = log.part(first, min(end, first + TRANSITIONS_PER_FILE))
            self._write(run_id, transitions_file(number), transition_arrays(part))
        self._logged[run_id] = end

    def write_training(self, run_id: str, recording: PracticeRecording) -> None:
        """Store a recording incrementally: files of evaluations that are complete are skipped.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        evaluations = recording.evaluations
        first = self._evaluations.get(run_id, 0) // EVALUATIONS_PER_FILE
        for number in range(first, -(-len(evaluations) // EVALUATIONS_PER_FILE)):
            batch = evaluations[number * EVALUATIONS_PER_FILE :][:EVALUATIONS_PER_FILE]
            self._write(run_id, evaluations_file(number), evaluation_arrays(batch))
        # Written last, since it holds the number of evaluations.
        self._write(run_id, PRACTICE, practice_arrays(recording))
        self._evaluations[run_id] = len(evaluations)

    def write_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """Store the recordings of a race's lanes.

        Raises:
            StorageFull, StorageFailed: if they cannot be stored.
        """
        self._write(run_id, RACE, race_arrays(lanes))

    def cache_training(self, run_id: str, recording: PracticeRecording) -> None:
        """Cache a stored recording that is complete."""
        self._evaluations.pop(run_id, None)
        self._logged.pop(run_id, None)
        self._logs.drop(run_id)
        self._trainings.put(run_id, recording)

    def cache_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """Cache the stored recordings of a race that are complete."""
        self._races.put(run_id, lanes)

    def invalidate(self, run_id: str) -> None:
        """Invalidate the cache entries of a run."""
        self._evaluations.pop(run_id, None)
        self._logged.pop(run_id, None)
        self._logs.drop(run_id)
        self._trainings.drop(run_id)
        self._races.drop(run_id)

    def _write(self, run_id: str, name: str, arrays: Arrays) -> None:
        # Uncompressed: compression saves a tenth of the size and takes a hundred times as long.
        buffer = io.BytesIO()
        np.savez(buffer, **arrays)  # type: ignore[arg-type]
        self._store.put_artifact(run_id, name, buffer.getvalue())


class _Entry(NamedTuple, Generic[T]):
    """A cached value, or a cached miss (None)."""

    value: T | None
    read_s: float
    size: int


class _LruCache(Generic[T]):
    """Least-recently-used cache with negative caching: a miss is valid for `_MISS_TTL_S`."""

    def __init__(self, read: Callable[[str], T | None], size_of: Callable[[T], int]) -> None:
        self._read, self._size_of, self._lock = read, size_of, threading.Lock()
        self._entries: OrderedDict[str, _Entry[T]] = OrderedDict()

    def get(self, key: str) -> T | None:
        with self._lock:
            entry, now = self._entries.get(key), time.monotonic()
            if entry is None or (entry.value is None and now - entry.read_s > _MISS_TTL_S):
                entry = self._entry(self._read_or_none(key), now)
            self._put(key, entry)
            return entry.value

    def put(self, key: str, value: T) -> None:
        with self._lock:
            self._put(key, self._entry(value, time.monotonic()))

    def drop(self, key: str) -> None:
        with self._lock:
            self._entries.pop(key, None)

    def _put(self, key: str, entry: _Entry[T]) -> None:
        self._entries[key] = entry
        self._entries.move_to_end(key)
        while len(self._entries) > 1 and self._is_over_capacity():
            self._entries.popitem(last=False)

    def _is_over_capacity(self) -> bool:
        size = sum(entry.size for entry in self._entries.values())
        return len(self._entries) > CACHE_RECORDINGS or size > CACHE_BYTES

    def _entry(self, value: T | None, now: float) -> _Entry[T]:
        return _Entry(value, now, 0 if value is None else self._size_of(value))

    def _read_or_none(self, key: str) -> T | None:
        try:
            return self._read(key)
        except NotFound:
            return None
        except HexapodError as error:
            # The stage loop asks thirty times a second: log once, and cache the miss.
            _logger.warning("No recording can be shown: %s", error, extra={"run_id": key})
            return None


def _read_training(store: RunStore, run_id: str) -> PracticeRecording | None:
    arrays = _arrays(store, run_id, PRACTICE)
    return None if arrays is None else practice_recording(arrays, _evaluations(store, run_id))


def _evaluations(store: RunStore, run_id: str) -> Iterator[Arrays]:
    number = 0
    while (arrays := _arrays(store, run_id, evaluations_file(number))) is not None:
        yield arrays
        number += 1


def _read_transitions(store: RunStore, run_id: str) -> TransitionLog | None:
    log, number = TransitionLog(), 0
    while (arrays := _arrays(store, run_id, transitions_file(number))) is not None:
        part = transitions(arrays)
        if part.first != len(log):
            break  # written before the training resumed from an earlier step
        log.extend(part)
        number += 1
    return log if len(log) else None


def _read_race(store: RunStore, run_id: str) -> list[LaneRecording] | None:
    arrays = _arrays(store, run_id, RACE)
    return None if arrays is None else race_recording(arrays)


def evaluations_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of evaluations, from 0 on."""
    return f"evaluations-{number:04}.npz"


def transitions_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of logged steps, from 0 on."""
    return f"transitions-{number:04}.npz"


def _arrays(store: RunStore, run_id: str, name: str) -> Arrays | None:
    file = store.open_artifact(run_id, name)
    if file is None:
        return None
    try:
        # Read from the file, so that its bytes are not in memory in addition to the arrays.
        with np.load(io.BufferedReader(ReadableArtifact(file)), allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    finally:
        file.close()
