"""Recordings of races: stored in files of a few thousand steps each, and read in parts of them.

The first file is `race.npz`, the next ones `race-0001.npz`, …; a race of `FILE_STEPS` steps or
fewer, or of an earlier version, has only the first. Of a longer one the figures of all steps are in
`race-figures.npz` once it has ended, so that they are read without the rest.
"""

import io
import threading
from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from itertools import accumulate, takewhile
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from cachetools import LRUCache, cachedmethod

from app.storage.artifact_file import ReadableArtifact, chunks
from app.storage.artifacts import StoredFile
from app.storage.database.store import RunStore
from app.storage.npz_artifacts import decoding, put_arrays, read_arrays
from hexapods.domain.errors import DamagedFile
from hexapods.runs.npz_slices import CompressedFile, NpzSlices
from hexapods.runs.race_file import (
    BLOCK_STEPS,
    LaneHead,
    RaceFile,
    StepArrays,
    joined,
    race_arrays,
    race_recording,
)
from hexapods.runs.recording import Arrays, LaneRecording, LaneSteps
from hexapods.runs.records import LaneFailed, LaneStep
from hexapods.runs.step_figures import Rows, figures_type, no_figures

RACE, FIGURES = "race.npz", "race-figures.npz"
FILE_STEPS = 2048
"""Steps of all lanes in a file, about 4 MB; a race that runs has no more of them in memory."""
MAX_RACE_FILES = 150
BLOCKS_BYTES, KNOWN_FILES = 16_000_000, 256
"""Capacity of what is kept of what was read, of all races."""
_COUNTS = "counts"


def race_file(number: int) -> str:
    """Return the artifact name of a race's `number`-th file, from 0 on."""
    return f"race-{number:04}.npz" if number else RACE


class StoredRaces:
    """Reads the recordings of races. Thread-safe.

    What is kept of what was read is of files that never change, by their names in the folder:
    of a race that was resumed it is of no use any more, but it is not wrong.

    Attributes:
        store: where they are.
    """

    def __init__(self, store: RunStore, max_bytes: int = BLOCKS_BYTES) -> None:
        self.store = store
        self._blocks: LRUCache[Hashable, StepArrays] = LRUCache(max_bytes, attrgetter("nbytes"))
        self._known: LRUCache[str, tuple[NpzSlices, Sequence[LaneHead]]] = LRUCache(KNOWN_FILES)
        self._lock = threading.Lock()

    def read(self, run_id: str) -> list[LaneRecording] | None:
        """Return the recordings of a race's lanes; None if there are none.

        Its steps are of the files that it has now: they raise DamagedFile once these are replaced.

        Raises:
            NotFound: if there is no such run.
            DamagedFile: if a file is damaged.
        """
        files = self.store.artifact_files(run_id)
        parts = _parts(run_id, files)
        if FIGURES in files:
            with self._opened(_LabelledFile.of(run_id, FIGURES, files[FIGURES])) as figures:
                found = self._summarised(parts, figures)
                if found is not None:
                    return self._lanes(parts, found)
        try:
            found = self._scanned(parts)
        except CompressedFile:
            if len(parts) > 1:
                raise
            return self._decompressed(run_id)
        return None if found is None else self._lanes(parts, found)

    def _lanes(self, parts: Sequence["_LabelledFile"], found: "_Found") -> list[LaneRecording]:
        lanes = []
        for lane, (head, figures) in enumerate(zip(found.heads, found.figures, strict=True)):
            ends = list(accumulate(counts[lane] for counts in found.counts))
            stored = [
                LaneFile(self, part, lane, end - counts[lane])
                for part, counts, end in zip(parts, found.counts, ends, strict=True)
                if counts[lane]
            ]
            steps = LaneSteps.read(figures, stored)
            lanes.append(LaneRecording(head.agent, head.rest_qpos, steps, head.failure))
        return lanes

    def _summarised(self, parts: Sequence["_LabelledFile"], summary: NpzSlices) -> "_Found | None":
        """Return what is known of a race that has its figures."""
        counts: list[list[int]] = summary.rows(_COUNTS).tolist()
        if len(counts) != len(parts):
            raise ValueError(f"it is of {len(counts)} files, and there are {len(parts)}")
        with self._file(parts[-1]) as newest:
            figures = [summary.rows(f"lane{lane}") for lane in range(len(newest.heads))]
        # Another version may have had others.
        is_known = all(own.dtype == figures_type(_groups(own)) for own in figures)
        return _Found(newest.heads, counts, figures) if is_known else None

    def _scanned(self, parts: Sequence["_LabelledFile"]) -> "_Found | None":
        """Return what is found of a race by reading all of it, a part at a time."""
        found = None
        for part in parts:
            with self._opened(part) as slices:
                file = RaceFile(slices)
                before = found.figures if found else [no_figures() for _ in file.heads]
                if [head.first for head in file.heads] != list(map(len, before)):
                    raise DamagedFile(f"{part.label} follows no other")
                figures = [file.figures(lane, own) for lane, own in enumerate(before)]
                counts = [*(found.counts if found else []), [head.steps for head in file.heads]]
                found = _Found(file.heads, counts, figures)
        return found

    def _decompressed(self, run_id: str) -> list[LaneRecording] | None:
        """Return a race of an early version, whose only file is compressed; all in memory."""
        arrays = read_arrays(self.store, run_id, RACE)
        if arrays is None:
            return None
        with decoding(f"{RACE} of run {run_id}"):
            return race_recording(arrays)

    def chunks(self, run_id: str) -> Iterator[bytes] | None:
        """Return the stored recording as one file, in chunks; None if there is none.

        They end with DamagedFile if the race is resumed meanwhile, or deleted.

        Raises:
            NotFound, DamagedFile: at the call, as `read`.
        """
        parts = _parts(run_id, self.store.artifact_files(run_id))
        files: list[NpzSlices] = []
        try:
            for part in parts:
                with self._opened(part) as file:
                    files.append(file)
        except CompressedFile:
            if len(parts) > 1:
                raise
            return chunks(self.store.open_file(parts[0].stored, parts[0].label))
        return joined(files, lambda n: self._opened(parts[n], files[n])) if files else None

    @cachedmethod(
        attrgetter("_blocks"),
        key=lambda _self, part, lane, number: (part.stored.file, lane, number),
        lock=attrgetter("_lock"),
    )
    def block(self, part: "_LabelledFile", lane: int, number: int) -> StepArrays:
        """Return some steps of a lane: the `number`-th of its blocks in a file.

        Raises:
            HexapodError: if they cannot be read (any more).
        """
        with self._file(part) as file:
            first, count = number * BLOCK_STEPS, file.heads[lane].steps
            return file.part(lane, first, min(first + BLOCK_STEPS, count))

    @contextmanager
    def _file(self, part: "_LabelledFile") -> Iterator[RaceFile]:
        """Open a file, which is verified when it is opened first."""
        name = part.stored.file
        with self._lock:
            known = self._known.get(name)
        slices, heads = known or (None, ())
        with self._opened(part, slices) as opened:
            file = RaceFile(opened, heads)
            with self._lock:
                self._known[name] = opened, file.heads
            yield file

    @contextmanager
    def _opened(self, part: "_LabelledFile", known: NpzSlices | None = None) -> Iterator[NpzSlices]:
        """Open a file, and verify it unless it is known."""
        file = self.store.open_file(part.stored, part.label, is_verified=known is not None)
        with closing(file), decoding(part.label):
            yield NpzSlices(io.BufferedReader(ReadableArtifact(file)), known)


def _groups(figures: Rows) -> int:
    names = figures.dtype.names or ()
    return figures["observation"].shape[1] if "observation" in names else 0


class _LabelledFile(NamedTuple):
    """A file of a race, and its name for error messages."""

    label: str
    stored: StoredFile

    @classmethod
    def of(cls, run_id: str, name: str, stored: StoredFile) -> "_LabelledFile":
        return cls(f"{name} of run {run_id}", stored)


def _parts(run_id: str, files: Mapping[str, StoredFile]) -> list[_LabelledFile]:
    """Return the files of a race that follow each other, from the first one on."""
    names = takewhile(files.__contains__, map(race_file, range(len(files))))
    return [_LabelledFile.of(run_id, name, files[name]) for name in names]


class _Found(NamedTuple):
    """Of the lanes their heads, of each file their steps in it, and their figures."""

    heads: Sequence[LaneHead]
    counts: list[list[int]]
    figures: list[Rows]


class GrowingRace:
    """The recording of a race that runs. One thread adds to it.

    Attributes:
        lanes: the recordings of its lanes, of which many may read.
    """

    def __init__(self, races: StoredRaces, run_id: str, lanes: list[LaneRecording]) -> None:
        self.lanes, self._races, self._run_id = lanes, races, run_id
        self._counts: list[list[int]] = []
        """Of each file the steps of each lane."""
        self._stored_failures: list[str | None] = []
        self._has_files = self._is_finished = False
        self._checkpointed = 0
        """Steps of all lanes at the last checkpoint."""

    def add(self, record: LaneStep | LaneFailed) -> None:
        """Append a record; now and then that stores the newest ones.

        Raises:
            StorageFull, StorageFailed: if they cannot be stored; they stay in memory then.
        """
        lane = self.lanes[record.lane]
        if isinstance(record, LaneFailed):
            lane.failure = record.reason
            return
        lane.steps.append(record)
        if sum(len(one.steps) - one.steps.stored for one in self.lanes) >= FILE_STEPS:
            self._write()

    def checkpoint(self) -> None:
        """Store what is not yet stored, in the file that the next steps complete.

        It stays in memory too: what is read of a race that runs does not change.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored.
        """
        steps = sum(len(lane.steps) for lane in self.lanes)
        if steps > self._checkpointed:
            firsts = [lane.steps.stored for lane in self.lanes]
            name = race_file(len(self._counts))
            self._put(name, race_arrays(self.lanes, firsts))
            self._checkpointed = steps

    def finish(self) -> None:
        """Store what is not yet stored.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored; it stays in memory then.
        """
        is_stored = all(len(lane.steps) == lane.steps.stored for lane in self.lanes)
        failures = [lane.failure for lane in self.lanes]
        if not (self._counts and is_stored and failures == self._stored_failures):
            self._write()
        if len(self._counts) > 1 and not self._is_finished:
            figures = {f"lane{n}": lane.steps.figures for n, lane in enumerate(self.lanes)}
            counts = {_COUNTS: np.array(self._counts)}
            self._put(FIGURES, {**figures, **counts})
        self._is_finished = True

    def _put(self, name: str, arrays: Arrays) -> StoredFile:
        """Store a file; the first one replaces those of an earlier attempt."""
        is_first, store = not self._has_files, self._races.store
        stored = put_arrays(store, self._run_id, name, arrays, replaces_all=is_first)
        self._has_files = True
        return stored

    def _write(self) -> None:
        firsts, failures = [], []
        for lane in self.lanes:
            firsts.append(lane.steps.stored)
            failures.append(lane.failure)
        name = race_file(len(self._counts))
        stored = self._put(name, race_arrays(self.lanes, firsts))
        part = _LabelledFile.of(self._run_id, name, stored)
        counts = [len(lane.steps) - first for lane, first in zip(self.lanes, firsts, strict=True)]
        self._counts.append(counts)
        self._stored_failures = failures
        for place, (lane, first, count) in enumerate(zip(self.lanes, firsts, counts, strict=True)):
            if count:
                lane.steps.store(LaneFile(self._races, part, place, first), count)


class LaneFile:
    """The steps of a lane in a file."""

    def __init__(self, races: StoredRaces, part: _LabelledFile, lane: int, first: int) -> None:
        self.first = first
        self._races, self._part, self._lane = races, part, lane

    def step(self, index: int) -> LaneStep:
        """Return the step of an index of the lane, from 0 on."""
        block = (index - self.first) // BLOCK_STEPS
        return self._races.block(self._part, self._lane, block).step(index)
