"""Recordings of ended runs: stored as `.npz` artifacts, with an LRU cache in memory."""

import logging
import math
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from operator import attrgetter
from typing import Generic, TypeVar

from cachetools import TLRUCache

from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.npz_artifacts import decoding, put_arrays, read_arrays
from app.storage.stored_races import StoredRaces
from hexapods.domain.errors import HexapodError
from hexapods.runs.recording import Arrays, LaneRecording, PracticeRecording
from hexapods.runs.stored_practice import evaluation_arrays, practice_arrays, practice_recording
from hexapods.runs.transition_log import (
    BYTES_PER_STEP,
    TransitionLog,
    transition_arrays,
    transitions,
)

PRACTICE = "practice.npz"
EVALUATIONS_PER_FILE, TRANSITIONS_PER_FILE = 20, 50_000
"""Evaluations and logged steps per file: a growing training rewrites only its last file."""
CACHE_RECORDINGS, CACHE_BYTES = 16, 50_000_000
"""Capacity of each cache in recordings and in bytes; the newest entry is kept whatever its size."""
_MISS_TTL_S = 1.0
"""Time for which a cached miss is valid before the store is read again."""
T = TypeVar("T")
_logger = logging.getLogger(__name__)


class StoredRecordings:
    """Reads and writes recordings of ended runs, with an LRU cache per kind. Thread-safe.

    Attributes:
        races: the files of races, also of those that run.
    """

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._trainings = _LruCache[PracticeRecording](
            lambda run_id: _read_training(store, run_id, is_whole=False), attrgetter("size")
        )
        self.races = StoredRaces(store)
        self._races = _LruCache[list[LaneRecording]](
            self.races.read, lambda lanes: sum(one.size for one in lanes)
        )
        self._logs = _LruCache[TransitionLog](
            lambda run_id: _read_transitions(store, run_id), lambda log: BYTES_PER_STEP * len(log)
        )
        self._evaluations: dict[str, int] = {}
        self._logged: dict[str, int] = {}

    def training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of a training; None if there is none, or it is damaged.

        Of its evaluations only the newest motion is there.
        """
        return self._trainings.get(run_id)

    def whole_training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of a training with all its motions, which may take 80 MB."""
        return self._trainings.or_none(run_id, lambda key: _read_training(self._store, key))

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
            put_arrays(self._store, run_id, transitions_file(number), transition_arrays(part))
        self._logged[run_id] = end

    def write_training(self, run_id: str, recording: PracticeRecording) -> None:
        """Store a recording incrementally: files of evaluations that are complete are skipped.

        Their motions are dropped from memory, where they would be up to 80 MB.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        evaluations = recording.evaluations
        first = self._evaluations.get(run_id, 0) // EVALUATIONS_PER_FILE
        for number in range(first, -(-len(evaluations) // EVALUATIONS_PER_FILE)):
            batch = evaluations[number * EVALUATIONS_PER_FILE :][:EVALUATIONS_PER_FILE]
            put_arrays(self._store, run_id, evaluations_file(number), evaluation_arrays(batch))
        # Written last, since it holds the number of evaluations.
        put_arrays(self._store, run_id, PRACTICE, practice_arrays(recording))
        self._evaluations[run_id] = len(evaluations)
        recording.forget_motions(len(evaluations) // EVALUATIONS_PER_FILE * EVALUATIONS_PER_FILE)

    def cache_training(self, run_id: str, recording: PracticeRecording) -> None:
        """Cache a stored recording that is complete; of its evaluations only the newest motion."""
        recording.forget_motions(len(recording.evaluations))
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


class _LruCache(Generic[T]):
    """Least-recently-used cache with negative caching: a miss is valid for `_MISS_TTL_S`."""

    def __init__(self, read: Callable[[str], T | None], size_of: Callable[[T], int]) -> None:
        self._read, self._lock = read, threading.Lock()

        def size(value: T | None) -> int:
            # At least a share, which limits their number; at most all, so that the newest is kept.
            bytes_ = 0 if value is None else size_of(value)
            return min(max(bytes_, CACHE_BYTES // CACHE_RECORDINGS), CACHE_BYTES)

        self._entries: TLRUCache[str, T | None] = TLRUCache(
            CACHE_BYTES,
            lambda _, value, now_s: now_s + _MISS_TTL_S if value is None else math.inf,
            getsizeof=size,
        )

    def get(self, key: str) -> T | None:
        # Locked while it reads: what `drop` invalidates meanwhile must not be kept.
        with self._lock:
            try:
                return self._entries[key]
            except KeyError:
                value = self._entries[key] = self.or_none(key, self._read)
                return value

    def put(self, key: str, value: T) -> None:
        with self._lock:
            self._entries[key] = value

    def drop(self, key: str) -> None:
        with self._lock, suppress(KeyError):
            del self._entries[key]

    @staticmethod
    def or_none(key: str, read: Callable[[str], T | None]) -> T | None:
        """Read a value; None if it cannot be read."""
        try:
            return read(key)
        except NotFound:
            return None
        except HexapodError as error:
            # The stage loop asks thirty times a second: log once, and cache the miss.
            _logger.warning("No recording can be shown: %s", error, extra={"run_id": key})
            return None


def _read_training(store: RunStore, run_id: str, is_whole: bool = True) -> PracticeRecording | None:
    arrays = read_arrays(store, run_id, PRACTICE)
    if arrays is None:
        return None
    with decoding(f"the recording of run {run_id}"):
        return practice_recording(arrays, _evaluations(store, run_id), is_whole=is_whole)


def _evaluations(store: RunStore, run_id: str) -> Iterator[Arrays]:
    number = 0
    while (arrays := read_arrays(store, run_id, evaluations_file(number))) is not None:
        yield arrays
        number += 1


def _read_transitions(store: RunStore, run_id: str) -> TransitionLog | None:
    log, number = TransitionLog(), 0
    while (arrays := read_arrays(store, run_id, transitions_file(number))) is not None:
        with decoding(f"{transitions_file(number)} of run {run_id}"):
            part = transitions(arrays)
        if part.first != len(log):
            break  # written before the training resumed from an earlier step
        log.extend(part)
        number += 1
    return log if len(log) else None


def evaluations_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of evaluations, from 0 on."""
    return f"evaluations-{number:04}.npz"


def transitions_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of logged steps, from 0 on."""
    return f"transitions-{number:04}.npz"
