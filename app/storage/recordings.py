"""Recordings of this server's runs: growing in memory while a job runs, stored when it ends."""

import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.storage.database.store import RunStore
from app.storage.stored_races import GrowingRace
from app.storage.stored_recordings import StoredRecordings
from hexapods.runs.recording import LaneRecording, PracticeRecording
from hexapods.runs.records import Evaluated, LaneFailed, LaneStep, StepTaken
from hexapods.runs.stored_practice import rewound
from hexapods.runs.transition_log import TransitionLog, Transitions

MAX_EVALUATION_MOTIONS = 1000
"""Evaluations of one training whose motion is kept, about 80 MB; later ones keep the distance."""
_NOT_GROWING = TransitionLog()


class Recordings:
    """Append-only store of recordings by run: one writer thread per run, any number of readers.

    Readers need no lock, since recorded steps and evaluations never change.
    """

    def __init__(self, store: RunStore) -> None:
        """Use the recordings of a store."""
        self._trainings: dict[str, PracticeRecording] = {}
        self._races: dict[str, GrowingRace] = {}
        self._evaluation_counts: dict[str, int] = {}
        self._logs: dict[str, TransitionLog | None] = {}
        """Of a training that resumed without a whole log there is none."""
        self._stored = StoredRecordings(store)
        self._lock = threading.Lock()

    def training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of a training; None if it has not started or was not recorded."""
        growing = self._trainings.get(run_id)
        return self._stored.training(run_id) if growing is None else growing

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """Return the recordings of a race's lanes; None if it has not started or has none."""
        growing = self._races.get(run_id)
        return self._stored.race(run_id) if growing is None else growing.lanes

    def race_file(self, run_id: str) -> Iterator[bytes] | None:
        """Return the stored recording of a race as one `.npz` file, in chunks; None without one.

        Raises:
            NotFound: if there is no such run.
            DamagedFile: if a file is damaged.
        """
        return self._stored.races.chunks(run_id)

    def transitions(self, run_id: str) -> TransitionLog | None:
        """Return the log of a training's transitions; None if there is none, or it is damaged."""
        growing = self._logs.get(run_id, _NOT_GROWING)
        return self._stored.transitions(run_id) if growing is _NOT_GROWING else growing

    def begin_training(
        self, run_id: str, rest_qpos: NDArray[np.float32], after_step: int = 0
    ) -> None:
        """Start the recording of a training, or resume it, truncated to its checkpoint.

        Args:
            run_id: id of the training.
            rest_qpos: initial pose, (7 + joints,).
            after_step: step of the checkpoint from which the training resumes; 0 for a new one.
        """
        former = self._stored.whole_training(run_id) if after_step else None
        log = self.transitions(run_id) if after_step else TransitionLog()
        recording = PracticeRecording(rest_qpos) if former is None else rewound(former, after_step)
        with self._lock:
            self._trainings[run_id] = recording
            self._evaluation_counts[run_id] = len(recording.evaluations)
            self._logs[run_id] = None if log is None else log.truncated(after_step)

    def begin_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """Start the recordings of a race's lanes.

        The files of an earlier attempt stay until the first one of this attempt is stored.
        """
        with self._lock:
            self._races[run_id] = GrowingRace(self._stored.races, run_id, lanes)
        self._stored.invalidate(run_id)

    def add(self, run_id: str, record: Any) -> None:
        """Append a record to a run's recording; records without motion are ignored.

        Raises:
            StorageFull, StorageFailed: if a part of a race that is complete cannot be stored.
        """
        if isinstance(record, LaneStep | LaneFailed):
            self._races[run_id].add(record)
        elif isinstance(record, StepTaken):
            self._trainings[run_id].add(record)
        elif isinstance(record, Evaluated):
            self._evaluation_counts[run_id] += 1
            if self._evaluation_counts[run_id] > MAX_EVALUATION_MOTIONS:
                record = replace(record, motion=None)
            self._trainings[run_id].add(record)

    def log(self, run_id: str, steps: Transitions) -> None:
        """Append to the log of a training, if it has one from its first step."""
        log = self._logs.get(run_id)
        if log is not None:
            log.extend(steps)

    def save(self, run_id: str) -> None:
        """Store what a run has recorded so far; call from the run's writer thread.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        training, race = self._trainings.get(run_id), self._races.get(run_id)
        if training is not None:
            self._stored.write_transitions(run_id, self._logs[run_id])
            self._stored.write_training(run_id, training)
        if race is not None:
            race.checkpoint()

    def finish(self, run_id: str) -> None:
        """Store a complete recording, and move it from memory to the evicting cache.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored; it stays in memory then.
        """
        training, race = self._trainings.get(run_id), self._races.get(run_id)
        if training is not None:
            self.save(run_id)
            self._stored.cache_training(run_id, training)
        if race is not None:
            race.finish()
            self._stored.cache_race(run_id, race.lanes)
        self._drop(run_id)

    def discard(self, run_id: str) -> None:
        """Drop a run's recording from memory, and from the cache of stored recordings."""
        self._drop(run_id)
        self._stored.invalidate(run_id)

    def _drop(self, run_id: str) -> None:
        with self._lock:
            self._trainings.pop(run_id, None)
            self._races.pop(run_id, None)
            self._evaluation_counts.pop(run_id, None)
            self._logs.pop(run_id, None)
