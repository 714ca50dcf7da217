"""Recordings of this server's runs: growing in memory while a job runs, stored when it ends."""

import logging
import math
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from operator import attrgetter
from typing import Any, Generic, TypeVar

import numpy as np
from cachetools import TLRUCache
from numpy.typing import NDArray

from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.stored_races import GrowingRace, read_race, stored_chunks
from app.storage.stored_trainings import GrowingTraining, read_log, read_training
from hexapods.domain.errors import HexapodError
from hexapods.runs.recording import LaneRecording, PracticeRecording
from hexapods.runs.records import Evaluated, LaneFailed, LaneStep, StepTaken
from hexapods.runs.stored_practice import rewound
from hexapods.runs.transition_log import BYTES_PER_STEP, TransitionLog, Transitions

CACHE_RECORDINGS, CACHE_BYTES = 16, 50_000_000
"""Capacity of each cache in recordings and in bytes; the newest entry is kept whatever its size."""
_MISS_TTL_S = 1.0
"""Time for which a cached miss is valid before the store is read again."""
T = TypeVar("T")
_logger = logging.getLogger(__name__)


class Recordings:
    """Append-only store of recordings by run: one writer thread per run, any number of readers.

    Readers need no lock, since recorded steps and evaluations never change. Those of ended runs are
    kept in a cache for each kind.
    """

    def __init__(self, store: RunStore) -> None:
        """Use the recordings of a store."""
        self._store = store
        self._growing: dict[str, GrowingTraining | GrowingRace] = {}
        self._trainings = _LruCache[PracticeRecording](
            lambda run_id: read_training(store, run_id, is_whole=False), attrgetter("size")
        )
        self._races = _LruCache[list[LaneRecording]](
            lambda run_id: read_race(store, run_id), lambda lanes: sum(lane.size for lane in lanes)
        )
        self._logs = _LruCache[TransitionLog](
            lambda run_id: read_log(store, run_id), lambda log: BYTES_PER_STEP * len(log)
        )

    def training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of a training; None if it has not started or was not recorded.

        Of the evaluations of an ended training only the newest has its motion.
        """
        growing = self._growing.get(run_id)
        if isinstance(growing, GrowingTraining):
            return growing.recording
        return self._trainings.get(run_id)

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """Return the recordings of a race's lanes; None if it has not started or has none."""
        growing = self._growing.get(run_id)
        return growing.lanes if isinstance(growing, GrowingRace) else self._races.get(run_id)

    def race_file(self, run_id: str) -> Iterator[bytes] | None:
        """Return the stored recording of a race as one `.npz` file, in chunks; None without one.

        Raises:
            NotFound: if there is no such run.
            DamagedFile: if the file is damaged.
        """
        return stored_chunks(self._store, run_id)

    def transitions(self, run_id: str) -> TransitionLog | None:
        """Return the log of a training's transitions; None if there is none, or it is damaged."""
        growing = self._growing.get(run_id)
        return growing.log if isinstance(growing, GrowingTraining) else self._logs.get(run_id)

    def begin_training(
        self, run_id: str, rest_qpos: NDArray[np.float32], after_step: int = 0
    ) -> None:
        """Start the recording of a training, or resume it, truncated to its checkpoint.

        Args:
            run_id: id of the training.
            rest_qpos: initial pose, (7 + joints,).
            after_step: step of the checkpoint from which the training resumes; 0 for a new one.
        """
        recording = PracticeRecording(rest_qpos)
        log: TransitionLog | None = TransitionLog()
        if after_step:
            former = _or_none(run_id, lambda key: read_training(self._store, key))
            recording = recording if former is None else rewound(former, after_step)
            log = self.transitions(run_id)
            log = None if log is None else log.truncated(after_step)
        self._growing[run_id] = GrowingTraining(self._store, run_id, recording, log)

    def begin_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """Start the recordings of a race's lanes.

        The file of an earlier attempt stays until that of this attempt is stored.
        """
        self._growing[run_id] = GrowingRace(self._store, run_id, lanes)
        self._races.drop(run_id)

    def add(self, run_id: str, record: Any) -> None:
        """Append a record to a run's recording; records without motion are ignored."""
        if isinstance(record, LaneStep | LaneFailed | StepTaken | Evaluated):
            self._growing[run_id].add(record)  # type: ignore[arg-type]  # a run's own kind

    def log(self, run_id: str, steps: Transitions) -> None:
        """Append steps to the log of a training, if it has one from its first step."""
        growing = self._growing.get(run_id)
        if isinstance(growing, GrowingTraining):
            growing.extend_log(steps)

    def save(self, run_id: str) -> None:
        """Store the recording of a run so far; call from the run's writer thread.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        if (growing := self._growing.get(run_id)) is not None:
            growing.checkpoint()

    def finish(self, run_id: str) -> None:
        """Store a complete recording, and move it from memory to the evicting cache.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored; it stays in memory then.
        """
        growing = self._growing.get(run_id)
        if growing is None:
            return
        growing.finish()
        if isinstance(growing, GrowingRace):
            self._races.put(run_id, growing.lanes)
        else:
            self._logs.drop(run_id)
            self._trainings.put(run_id, growing.recording)
        self._growing.pop(run_id, None)

    def discard(self, run_id: str) -> None:
        """Drop a run's recording from memory, and from the cache of stored recordings."""
        self._growing.pop(run_id, None)
        for cache in (self._trainings, self._races, self._logs):
            cache.drop(run_id)


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
                value = self._entries[key] = _or_none(key, self._read)
                return value

    def put(self, key: str, value: T) -> None:
        with self._lock:
            self._entries[key] = value

    def drop(self, key: str) -> None:
        with self._lock, suppress(KeyError):
            del self._entries[key]


def _or_none(key: str, read: Callable[[str], T | None]) -> T | None:
    """Read a recording; None if it cannot be read."""
    try:
        return read(key)
    except NotFound:
        return None
    except HexapodError as error:
        # The stage loop asks thirty times a second: log once, and cache the miss.
        _logger.warning("No recording can be shown: %s", error, extra={"run_id": key})
        return None
