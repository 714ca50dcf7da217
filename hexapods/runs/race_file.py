"""Files of a race's recording: encode the steps of its lanes as arrays, and read them in parts.

A long race is stored in several such files, each with the steps that follow those of the one
before. About 2 kB a step.
"""

import io
import json
import math
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.explanation import Future
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.files import DrainedBuffer
from hexapods.runs.npz_slices import ArraySlices, NpzSlices, Slices
from hexapods.runs.recording import Arrays, LaneRecording, LaneSteps
from hexapods.runs.records import ActionValues, LaneStep
from hexapods.runs.step_figures import GrowingArray, Rows, StepColumns, no_figures, rows_of

META = "meta"
BLOCK_STEPS = 64
"""Steps of a lane that are read at once, about 150 kB."""
_SCANNED_STEPS = 512
_COLUMNS = ("scalars", "observation", "action", "frames", "values", "visits")
"""Arrays with a row for each step."""
_FUTURES = ("future_actions", "future_values", "future_counts")
_CHUNK_BYTES = 1 << 16
_FIXED_TIME = (1980, 1, 1, 0, 0, 0)


def race_arrays(lanes: Sequence[LaneRecording], firsts: Sequence[int] | None = None) -> Arrays:
    """Encode a race's recording as arrays for a file.

    Args:
        lanes: the recording.
        firsts: of each lane the number of steps that are in other files; None for none.
    """
    arrays: Arrays = {}
    meta: list[dict[str, Any]] = []
    for number, lane in enumerate(lanes):
        first = 0 if firsts is None else firsts[number]
        meta.append({"agent": lane.agent, "failure": lane.failure})
        if first:
            meta[-1]["first"] = first
        key = f"lane{number}."
        arrays[key + "rest_qpos"] = lane.rest_qpos
        steps = lane.steps[first:]
        if not steps:
            continue
        for name in Motion._fields:
            columns = [getattr(s.motion, name) for s in steps]
            if all(column is not None for column in columns):
                arrays[key + name] = np.concatenate(columns)
        arrays[key + "frames"] = np.array([len(s.motion.time_s) for s in steps])
        arrays[key + "observation"] = np.array([s.observation for s in steps])
        arrays[key + "action"] = np.array([s.action for s in steps])
        scalars = ("reward_m", "distance_m", "transitions", "decision_s")
        table = [[getattr(s, name) for name in scalars] for s in steps]
        arrays[key + "scalars"] = np.array(table, float)
        action_values = [s.action_values for s in steps if s.action_values]
        if action_values:
            arrays[key + "values"] = np.array([k.values for k in action_values], np.float32)
            arrays[key + "visits"] = np.array([k.visits for k in action_values], np.float32)
        arrays |= {key + name: array for name, array in _future_arrays(steps).items()}
    arrays[META] = np.array(json.dumps(meta))
    return arrays


def _future_arrays(steps: Sequence[LaneStep]) -> Arrays:
    """Encode what a search found: the number of actions of each step, and one row an action."""
    found = [future for step in steps for future in step.futures]
    if not found:
        return {}
    return {
        "futures": np.array([len(step.futures) for step in steps]),
        "future_actions": np.array([one.action for one in found], np.uint8),
        "future_values": np.array([(one.reward_m, one.return_m) for one in found], float),
        "future_counts": np.array([(one.sequences, one.steps) for one in found], np.uint32),
    }


def race_recording(arrays: Mapping[str, NDArray[Any]]) -> list[LaneRecording]:
    """Decode the output of `race_arrays`."""
    file = RaceFile(ArraySlices(arrays))
    lanes = []
    for number, head in enumerate(file.heads):
        steps = LaneSteps()
        if head.steps:
            stored = file.part(number, 0, head.steps)
            steps = LaneSteps.read(rows_of(stored.columns, no_figures()), [stored])
        lanes.append(LaneRecording(head.agent, head.rest_qpos, steps, head.failure))
    return lanes


class LaneHead(NamedTuple):
    """Data of a lane in a file, besides its steps.

    Attributes:
        agent, rest_qpos, failure: see `LaneRecording`.
        first: number of the lane's steps that are in earlier files.
        steps: number of those in this one.
    """

    agent: str
    rest_qpos: NDArray[np.float32]
    failure: str | None
    first: int
    steps: int


class RaceFile:
    """A file of a race's recording, of which parts are read.

    Attributes:
        heads: of each lane.
    """

    def __init__(self, slices: Slices, heads: Sequence[LaneHead] = ()) -> None:
        """Take an open file, with its heads if they are known."""
        self._slices = slices
        meta: list[dict[str, Any]] = [] if heads else json.loads(str(slices.rows(META)))
        self.heads = heads or [self._head(number, own) for number, own in enumerate(meta)]

    def _head(self, lane: int, meta: Mapping[str, Any]) -> LaneHead:
        key = f"lane{lane}."
        steps = self._slices.length(key + "frames") if key + "frames" in self._slices else 0
        rest = self._slices.rows(key + "rest_qpos")
        return LaneHead(meta["agent"], rest, meta["failure"], meta.get("first", 0), steps)

    def part(self, lane: int, first: int, end: int) -> "StepArrays":
        """Return the steps of a lane from one of this file to before another, at least one.

        Raises:
            ValueError: if its arrays do not fit together.
        """
        slices, key = self._slices, f"lane{lane}."

        def rows(name: str, begin: int, stop: int) -> NDArray[Any]:
            return slices.rows(key + name, begin, stop)

        arrays = {name: rows(name, first, end) for name in _COLUMNS if key + name in slices}
        frames = slices.rows(key + "frames", 0, end)
        if frames.min() < 1:
            raise ValueError("a step has no frames")
        begin, stop = int(frames[:first].sum()), int(frames.sum())
        for name in Motion._fields:
            if key + name in slices:
                arrays[name] = rows(name, begin, stop)
        if key + "futures" in slices:
            counts = slices.rows(key + "futures", 0, end)
            if counts.min() < 0:
                raise ValueError("what its search found is of other steps")
            arrays["futures"] = counts[first:]
            begin, stop = int(counts[:first].sum()), int(counts.sum())
            arrays |= {name: rows(name, begin, stop) for name in _FUTURES}
        return StepArrays(lane, self.heads[lane].first + first, arrays)

    def figures(self, lane: int, before: Rows) -> Rows:
        """Return the figures of a lane's steps after those of the steps before them.

        Reads all of the lane, a part at a time.

        Raises:
            ValueError: if its arrays do not fit together.
        """
        found, steps = GrowingArray(before), self.heads[lane].steps
        for first in range(0, steps, _SCANNED_STEPS):
            columns = self.part(lane, first, min(first + _SCANNED_STEPS, steps)).columns
            if not len(found):
                found = GrowingArray(no_figures(columns.observation.shape[1]))
            found.extend(rows_of(columns, found.rows))
        return found.rows


class StepArrays:
    """Consecutive steps of a lane as arrays, from which each step is made when it is asked for."""

    def __init__(self, lane: int, first: int, arrays: Arrays) -> None:
        """Take the arrays of at least one step.

        Args:
            lane: number of the lane.
            first: number of the lane's steps before them.
            arrays: by their names in a file, without the lane's.

        Raises:
            ValueError: if they do not fit together.
        """
        self.first, self._lane, self._arrays = first, lane, arrays
        self._starts = [0, *accumulate(arrays["frames"].tolist())]
        self._futures = [0, *accumulate(arrays["futures"].tolist())] if "futures" in arrays else []
        count = len(arrays["frames"])
        lengths = dict.fromkeys(_COLUMNS, count) | dict.fromkeys(Motion._fields, self._starts[-1])
        if self._futures:
            lengths |= {"futures": count} | dict.fromkeys(_FUTURES, self._futures[-1])
        for name, array in arrays.items():
            if len(array) != lengths[name]:
                raise ValueError(f"its {name} are of other steps")

    @property
    def nbytes(self) -> int:
        """Size of the arrays."""
        return sum(array.nbytes for array in self._arrays.values())

    @property
    def columns(self) -> StepColumns:
        """The columns from which figures follow."""
        arrays = self._arrays
        return StepColumns(
            arrays["scalars"],
            arrays["observation"],
            arrays["action"],
            arrays["frames"],
            Motion(*(arrays.get(name) for name in Motion._fields)),  # type: ignore[arg-type]
            arrays.get("values"),
        )

    def all(self) -> Iterator[LaneStep]:
        """Yield the steps."""
        return (self.step(self.first + place) for place in range(len(self._arrays["frames"])))

    def step(self, index: int) -> LaneStep:
        """Return the step of an index of the lane, from 0 on."""
        arrays, place = self._arrays, index - self.first
        reward, distance, transitions, decision = arrays["scalars"][place].tolist()
        action_values = None
        if "values" in arrays:
            both = (arrays[name][place].astype(float) for name in ("values", "visits"))
            action_values = ActionValues(*both)
        frames = slice(self._starts[place], self._starts[place + 1])
        motion = (arrays[name][frames] if name in arrays else None for name in Motion._fields)
        return LaneStep(
            self._lane,
            index + 1,
            tuple(arrays["observation"][place].tolist()),
            Action(*arrays["action"][place].tolist()),
            reward,
            distance,
            int(transitions),
            decision,
            Motion(*motion),  # type: ignore[arg-type]
            action_values,
            self._found(place),
        )

    def _found(self, place: int) -> tuple[Future, ...]:
        if not self._futures:
            return ()
        part = slice(self._futures[place], self._futures[place + 1])
        rows = zip(*(self._arrays[name][part].tolist() for name in _FUTURES), strict=True)
        return tuple(Future(Action(*action), *values, *counts) for action, values, counts in rows)


def joined(
    files: Sequence[NpzSlices], reopen: Callable[[int], AbstractContextManager[NpzSlices]]
) -> Iterator[bytes]:
    """Yield the files of a race as one, in chunks, as if it had been stored in one.

    Args:
        files: the files, which need not be open any more.
        reopen: opens one of them again.
    """
    buffer = DrainedBuffer()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in dict.fromkeys(name for file in files for name in file.arrays):
            info = zipfile.ZipInfo(f"{name}.npy", _FIXED_TIME)
            with archive.open(info, "w", force_zip64=True) as member:
                for data in _npy_chunks(name, files, reopen):
                    member.write(data)
                    yield buffer.drain()
    yield buffer.drain()


def _npy_chunks(
    name: str,
    files: Sequence[NpzSlices],
    reopen: Callable[[int], AbstractContextManager[NpzSlices]],
) -> Iterator[bytes]:
    """Yield an array of all files as an `.npy` file."""
    lane, _, column = name.rpartition(".")
    if name == META or column == "rest_qpos":
        # Each of them says it; only the last one knows which lanes failed.
        with reopen(len(files) - 1) as newest:
            whole = newest.rows(name)
        if name == META:
            told = json.loads(str(whole))
            for one in told:
                one.pop("first", None)
            whole = np.array(json.dumps(told))
        yield _npy(whole)
        return
    _, shape, kind = next(file.arrays[name] for file in files if name in file)
    # A file in whose steps a search found nothing does not say so of each of them.
    lengths = [
        file.length(name) if name in file else _steps(file, lane) * (column == "futures")
        for file in files
    ]
    buffer = io.BytesIO()
    header = {"fortran_order": False, "shape": (sum(lengths), *shape[1:])}  # whole numbers
    descr = np.lib.format.dtype_to_descr(kind)
    np.lib.format.write_array_header_1_0(buffer, {**header, "descr": descr})
    yield buffer.getvalue()
    rows = max(1, _CHUNK_BYTES // (kind.itemsize * math.prod(shape[1:])))
    for number, (file, length) in enumerate(zip(files, lengths, strict=True)):
        if name not in file:
            yield bytes(length * kind.itemsize)
            continue
        with reopen(number) as opened:
            for first in range(0, length, rows):
                yield opened.rows(name, first, min(first + rows, length)).tobytes()


def _npy(array: NDArray[Any]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def _steps(file: NpzSlices, lane: str) -> int:
    return file.length(f"{lane}.frames") if f"{lane}.frames" in file else 0
