"""The recordings of this server's runs: they grow while jobs run, and everyone may look."""

import threading
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.runs.recording import LaneRecording, PracticeRecording
from app.runs.records import Evaluated, LaneFailed, LaneStep, StepTaken
from app.runs.stored_practice import rewound
from app.storage.store import RunStore
from app.storage.stored_recordings import StoredRecordings

MAX_EVALUATION_MOTIONS = 1000
"""Of one training; later evaluations keep their distance only. About 80 MB."""


class Recordings:
    """By run. Each run has one thread that adds; any may read, since what is there stays."""

    def __init__(self, store: RunStore | None = None) -> None:
        """Begin with what a store has.

        Args:
            store: keeps recordings for longer than this process; None keeps them in memory.
        """
        self._trainings: dict[str, PracticeRecording] = {}
        self._races: dict[str, list[LaneRecording]] = {}
        self._evaluated: dict[str, int] = {}
        self._stored = None if store is None else StoredRecordings(store)
        self._lock = threading.Lock()

    def training(self, run_id: str) -> PracticeRecording | None:
        """The recording of a training; None before it began."""
        growing = self._trainings.get(run_id)
        return self._stored.training(run_id) if growing is None and self._stored else growing

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """The recordings of a race's lanes; None before it began."""
        growing = self._races.get(run_id)
        return self._stored.race(run_id) if growing is None and self._stored else growing

    def begin_training(
        self, run_id: str, rest_qpos: NDArray[np.float32], after_step: int = 0
    ) -> None:
        """A training stands at rest in this pose, or goes on after so many steps."""
        former = self.training(run_id) if after_step else None
        began = PracticeRecording(rest_qpos) if former is None else rewound(former, after_step)
        with self._lock:
            self._trainings[run_id] = began
            self._evaluated[run_id] = len(began.evaluations)

    def begin_race(self, run_id: str, lanes: list[LaneRecording]) -> None:
        """The lanes of a race stand at rest."""
        with self._lock:
            self._races[run_id] = lanes

    def add(self, run_id: str, record: Any) -> None:
        """Take in a record of a run that has begun; those that show no motion are ignored."""
        if isinstance(record, LaneStep):
            self._races[run_id][record.lane].steps.append(record)
        elif isinstance(record, LaneFailed):
            self._races[run_id][record.lane].failure = record.reason
        elif isinstance(record, StepTaken):
            self._trainings[run_id].add(record)
        elif isinstance(record, Evaluated):
            self._evaluated[run_id] += 1
            if self._evaluated[run_id] > MAX_EVALUATION_MOTIONS:
                record = replace(record, motion=None)
            self._trainings[run_id].add(record)

    def save(self, run_id: str) -> None:
        """Keep what a run has recorded so far; to be called by the thread that adds.

        Raises:
            StorageFull, StorageFailed: if it cannot be kept.
        """
        training, race = self._trainings.get(run_id), self._races.get(run_id)
        if self._stored is not None and training is not None:
            self._stored.write_training(run_id, training)
        if self._stored is not None and race is not None:
            self._stored.write_race(run_id, race)

    def finish(self, run_id: str) -> None:
        """Keep what a run has recorded; it grows no more, and memory may let go of it.

        Raises:
            StorageFull, StorageFailed: if it cannot be kept; it stays in memory then.
        """
        self.save(run_id)
        if self._stored is None:
            return
        training, race = self._trainings.get(run_id), self._races.get(run_id)
        if training is not None:
            self._stored.remember_training(run_id, training)
        if race is not None:
            self._stored.remember_race(run_id, race)
        self._drop(run_id)

    def discard(self, run_id: str) -> None:
        """Forget a run's recording."""
        self._drop(run_id)
        if self._stored is not None:
            self._stored.forget(run_id)

    def _drop(self, run_id: str) -> None:
        with self._lock:
            for kept in (self._trainings, self._races, self._evaluated):
                kept.pop(run_id, None)
