"""The recordings of this server's runs: they grow while jobs run, and everyone may look."""

import threading
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.runs.recording import LaneRecording, PracticeRecording
from app.runs.records import Evaluated, LaneFailed, LaneStep, StepTaken

MAX_EVALUATION_MOTIONS = 1000
"""Of one training; later evaluations keep their distance only. About 80 MB."""


class Recordings:
    """By run. Each run has one thread that adds; any may read, since what is there stays."""

    def __init__(self) -> None:
        self._trainings: dict[str, PracticeRecording] = {}
        self._races: dict[str, list[LaneRecording]] = {}
        self._evaluated: dict[str, int] = {}
        self._lock = threading.Lock()

    def training(self, run_id: str) -> PracticeRecording | None:
        """The recording of a training; None before it began."""
        return self._trainings.get(run_id)

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """The recordings of a race's lanes; None before it began."""
        return self._races.get(run_id)

    def begin_training(self, run_id: str, rest_qpos: NDArray[np.float32]) -> None:
        """A training stands at rest in this pose."""
        with self._lock:
            self._trainings[run_id] = PracticeRecording(rest_qpos)
            self._evaluated[run_id] = 0

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

    def discard(self, run_id: str) -> None:
        """Forget a run's recording."""
        with self._lock:
            for kept in (self._trainings, self._races, self._evaluated):
                kept.pop(run_id, None)
