"""Recordings of trainings: steps in one file, evaluations and logged steps in several of each."""

from collections.abc import Iterator
from dataclasses import replace

from app.storage.database.store import RunStore
from app.storage.npz_artifacts import decoding, put_arrays, read_arrays
from hexapods.runs.recording import Arrays, PracticeRecording
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.stored_practice import evaluation_arrays, practice_arrays, practice_recording
from hexapods.runs.transition_log import (
    TransitionLog,
    Transitions,
    transition_arrays,
    transitions,
)

PRACTICE = "practice.npz"
EVALUATIONS_PER_FILE, TRANSITIONS_PER_FILE = 20, 50_000
"""Evaluations and logged steps per file: a growing training rewrites only its last file."""
MAX_EVALUATION_MOTIONS = 1000
"""Evaluations of one training whose motion is kept, about 80 MB; later ones keep the distance."""


class GrowingTraining:
    """The recording of a training that runs. One thread adds to it.

    Attributes:
        recording: its steps and evaluations; other threads may read them.
        log: log of all its steps; None for a training that resumed without a whole log.
    """

    def __init__(
        self, store: RunStore, run_id: str, recording: PracticeRecording, log: TransitionLog | None
    ) -> None:
        self.recording, self.log = recording, log
        self._store, self._run_id = store, run_id
        self._stored_evaluations = self._stored_steps = 0

    def add(self, record: StepTaken | Evaluated) -> None:
        """Append a record."""
        is_evaluation = isinstance(record, Evaluated)
        if is_evaluation and len(self.recording.evaluations) >= MAX_EVALUATION_MOTIONS:
            record = replace(record, motion=None)
        self.recording.add(record)

    def extend_log(self, steps: Transitions) -> None:
        """Append steps to the log, if there is one from the first step."""
        if self.log is not None:
            self.log.extend(steps)

    def checkpoint(self) -> None:
        """Store new steps and evaluations: files that are complete are skipped.

        The motions of stored evaluations are dropped from memory, where they would be up to 80 MB.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        self._write_log()
        evaluations = self.recording.evaluations
        first = self._stored_evaluations // EVALUATIONS_PER_FILE
        for number in range(first, -(-len(evaluations) // EVALUATIONS_PER_FILE)):
            batch = evaluations[number * EVALUATIONS_PER_FILE :][:EVALUATIONS_PER_FILE]
            self._put(evaluations_file(number), evaluation_arrays(batch))
        # Written last, since it holds the number of evaluations.
        self._put(PRACTICE, practice_arrays(self.recording))
        self._stored_evaluations = len(evaluations)
        complete = len(evaluations) // EVALUATIONS_PER_FILE * EVALUATIONS_PER_FILE
        self.recording.forget_motions(complete)

    def finish(self) -> None:
        """Store the recording; of its evaluations only the newest motion stays in memory.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored; it stays in memory then.
        """
        self.checkpoint()
        self.recording.forget_motions(len(self.recording.evaluations))

    def _write_log(self) -> None:
        done, end = self._stored_steps, 0 if self.log is None else len(self.log)
        if self.log is None or done == end:
            return
        for number in range(done // TRANSITIONS_PER_FILE, -(-end // TRANSITIONS_PER_FILE)):
            first = number * TRANSITIONS_PER_FILE
            transitions_ = self.log.part(first, min(end, first + TRANSITIONS_PER_FILE))
            self._put(transitions_file(number), transition_arrays(transitions_))
        self._stored_steps = end

    def _put(self, name: str, arrays: Arrays) -> None:
        put_arrays(self._store, self._run_id, name, arrays)


def read_training(store: RunStore, run_id: str, is_whole: bool = True) -> PracticeRecording | None:
    """Return the stored recording of a training; None if there is none.

    Args:
        store: store of the runs.
        run_id: id of the training.
        is_whole: whether all motions of its evaluations are to be there, which may take 80 MB, not
            only the newest.

    Raises:
        NotFound: if there is no such run.
        DamagedFile, StorageFailed: if a file cannot be read.
    """
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


def read_log(store: RunStore, run_id: str) -> TransitionLog | None:
    """Return the stored log of a training's steps; None if there is none; raises likewise."""
    log, number = TransitionLog(), 0
    while (arrays := read_arrays(store, run_id, transitions_file(number))) is not None:
        with decoding(f"{transitions_file(number)} of run {run_id}"):
            logged = transitions(arrays)
        if logged.first != len(log):
            break  # written before the training resumed from an earlier step
        log.extend(logged)
        number += 1
    return log if len(log) else None


def evaluations_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of evaluations, from 0 on."""
    return f"evaluations-{number:04}.npz"


def transitions_file(number: int) -> str:
    """Return the artifact name of a training's `number`-th file of logged steps, from 0 on."""
    return f"transitions-{number:04}.npz"
