"""Recordings of runs whose job is over: kept in the store, and the newest looked at in memory."""

import io
import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
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
from app.storage.artifact_file import ReadableArtifact
from app.storage.errors import NotFound
from app.storage.store import RunStore

RACE, PRACTICE = "race.npz", "practice.npz"
EVALUATIONS_A_FILE = 20
KEPT_IN_MEMORY, KEPT_BYTES = 4, 100_000_000
"""Of either kind, and how large together; the one that was asked for last is kept in any case."""
_ASK_AGAIN_S = 1.0
_BESIDE_MOTION = 1000
"""Bytes of a step beside its motion, about."""
T = TypeVar("T")
_logger = logging.getLogger(__name__)


class StoredRecordings:
    """What `Recordings` reads and writes. Safe to use from any thread."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._trainings = _Newest[PracticeRecording](
            lambda run_id: _read_training(store, run_id), _size_of_training
        )
        self._races = _Newest[list[LaneRecording]](
            lambda run_id: _read_race(store, run_id), _size_of_race
        )
        self._evaluations: dict[str, int] = {}

    def training(self, run_id: str) -> PracticeRecording | None:
        """The recording of a training; None if there is none, or it is damaged."""
        return self._trainings.get(run_id)

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """The recordings of a race's lanes; None if there are none, or they are damaged."""
        return self._races.get(run_id)

    def write_training(self, run_id: str, recording: PracticeRecording) -> None:
        """Keep a recording; of one that has grown since, only what is new is written.

        Raises:
            StorageFull, StorageFailed: if it cannot be kept.
        """
        evaluations = recording.evaluations
        first = self._evaluations.get(run_id, 0) // EVALUATIONS_A_FILE
        for number in range(first, -(-len(evaluations) // EVALUATIONS_A_FILE)):
            some = evaluations[number * EVALUATIONS_A_FILE :][:EVALUATIONS_A_FILE]
            self._write(run_id, evaluations_file(number), evaluation_arrays(some))
        # Last, since it says how many evaluations there are.
        self._write(run_id, PRACTICE, practice_arrays(recording))
        self._evaluations[run_id] = len(evaluations)

    def write_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """Keep the recordings of a race's lanes.

        Raises:
            StorageFull, StorageFailed: if they cannot be kept.
        """
        self._write(run_id, RACE, race_arrays(lanes))

    def remember_training(self, run_id: str, recording: PracticeRecording) -> None:
        """This was kept, and grows no more."""
        self._evaluations.pop(run_id, None)
        self._trainings.put(run_id, recording)

    def remember_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """These were kept, and grow no more."""
        self._races.put(run_id, lanes)

    def forget(self, run_id: str) -> None:
        """What is in memory may not be what is in the store."""
        self._evaluations.pop(run_id, None)
        self._trainings.drop(run_id)
        self._races.drop(run_id)

    def _write(self, run_id: str, name: str, arrays: Arrays) -> None:
        # Not compressed: it would save a tenth, and take a hundred times as long.
        buffer = io.BytesIO()
        np.savez(buffer, **arrays)  # type: ignore[arg-type]
        self._store.put_artifact(run_id, name, buffer.getvalue())


class _Found(NamedTuple, Generic[T]):
    value: T | None
    asked_s: float
    size: int


class _Newest(Generic[T]):
    """The values that were asked for last; that there is none is believed for a second."""

    def __init__(self, read: Callable[[str], T | None], size_of: Callable[[T], int]) -> None:
        self._read, self._size_of, self._lock = read, size_of, threading.Lock()
        self._found: OrderedDict[str, _Found[T]] = OrderedDict()

    def get(self, key: str) -> T | None:
        with self._lock:
            found, now = self._found.get(key), time.monotonic()
            if found is None or (found.value is None and now - found.asked_s > _ASK_AGAIN_S):
                found = self._sized(self._tried(key), now)
            self._put(key, found)
            return found.value

    def put(self, key: str, value: T) -> None:
        with self._lock:
            self._put(key, self._sized(value, time.monotonic()))

    def drop(self, key: str) -> None:
        with self._lock:
            self._found.pop(key, None)

    def _put(self, key: str, found: _Found[T]) -> None:
        self._found[key] = found
        self._found.move_to_end(key)
        while len(self._found) > 1 and self._is_too_much():
            self._found.popitem(last=False)

    def _is_too_much(self) -> bool:
        size = sum(found.size for found in self._found.values())
        return len(self._found) > KEPT_IN_MEMORY or size > KEPT_BYTES

    def _sized(self, value: T | None, now: float) -> _Found[T]:
        return _Found(value, now, 0 if value is None else self._size_of(value))

    def _tried(self, key: str) -> T | None:
        try:
            return self._read(key)
        except NotFound:
            return None
        except HexapodError as error:
            # Whoever draws thirty times a second has no use for an exception.
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


def _read_race(store: RunStore, run_id: str) -> list[LaneRecording] | None:
    arrays = _arrays(store, run_id, RACE)
    return None if arrays is None else race_recording(arrays)


def _size_of_training(recording: PracticeRecording) -> int:
    motions = [step.motion for step in recording.steps]
    motions += [evaluation.motion for evaluation in recording.evaluations]
    return sum(motion.qpos.nbytes + motion.time_s.nbytes for motion in motions if motion)


def _size_of_race(lanes: list[LaneRecording]) -> int:
    return sum(
        step.motion.qpos.nbytes + step.motion.time_s.nbytes + _BESIDE_MOTION
        for lane in lanes
        for step in lane.steps
    )


def evaluations_file(number: int) -> str:
    """What the `number`th file of a training's evaluations is called, from 0 on."""
    return f"evaluations-{number:04}.npz"


def _arrays(store: RunStore, run_id: str, name: str) -> Arrays | None:
    file = store.open_artifact(run_id, name)
    if file is None:
        return None
    try:
        # From the file rather than from its bytes, which would be in memory beside the arrays.
        with np.load(io.BufferedReader(ReadableArtifact(file)), allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    finally:
        file.close()
