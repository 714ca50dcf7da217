"""Recordings: joint positions over time, observations and actions, for live view and replay.

A recording is append-only. The live view shows its tail; a replay shows it from the start.
"""

import hashlib
from bisect import bisect_right
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from operator import itemgetter
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.records import ActionValues, Evaluated, LaneStep, StepTaken
from hexapods.runs.step_arrays import StepArrays
from hexapods.runs.step_figures import GrowingArray, Rows, columns_of, no_figures, rows_of

Arrays = dict[str, NDArray[Any]]
_STEP_OVERHEAD_BYTES = 1000
"""Approximate size of a step in memory besides its motion."""


class LaneSteps(Sequence[LaneStep]):
    """The steps of a lane, and their figures as one array.

    One thread appends, others read without a lock.
    """

    def __init__(self, steps: Iterable[LaneStep] = ()) -> None:
        """Take the first steps."""
        self._figures = GrowingArray(no_figures())
        self._packed: list[tuple[int, StepArrays]] = []
        """Blocks of steps as arrays, each with the number of steps before it."""
        self._newest: tuple[int, list[LaneStep]] = (0, [])
        """The number of packed steps, and those that follow them."""
        for step in steps:
            self.append(step)

    @classmethod
    def read(cls, stored: StepArrays) -> "LaneSteps":
        """Return the steps of a file."""
        steps = cls()
        steps._figures = GrowingArray(rows_of(stored.columns, no_figures()))
        steps._packed, steps._newest = [(0, stored)], (len(stored), [])
        return steps

    def append(self, step: LaneStep) -> None:
        """Append a step."""
        if not len(self._figures):
            self._figures = GrowingArray(no_figures(len(step.observation)))
        self._newest[1].append(step)
        # The figures count, so last.
        self._figures.extend(rows_of(columns_of(step), self._figures.rows))

    def pack(self, lane: int, at_least: int = 1) -> None:
        """Pack the newest steps of a lane as arrays, which takes half of the memory.

        Action values are rounded to single precision, as in a file.

        Args:
            lane: number of the lane.
            at_least: number of steps that are worth it.
        """
        first, newest = self._newest
        if len(newest) >= at_least:
            self._packed.append((first, StepArrays.packed(lane, newest)))
            self._newest = first + len(newest), []

    def blocks(self, lane: int) -> list[StepArrays]:
        """Return all steps so far as arrays."""
        count, blocks = len(self), []
        for first, block in self._packed:
            if first + len(block) <= count:
                blocks.append(block)
        rest = self[sum(map(len, blocks)) : count]
        return [*blocks, StepArrays.packed(lane, rest)] if rest else blocks

    @property
    def figures(self) -> Rows:
        """Figures of all steps so far, a row each; see `hexapods.runs.step_figures`."""
        return self._figures.rows

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        packed = sum(block.nbytes for _, block in list(self._packed))
        newest = sum(_size_of(s.motion, s.action_values) for s in list(self._newest[1]))
        return self.figures.nbytes + packed + newest

    def choices(self, newest: int) -> list[tuple[Cells, Action]]:
        """Return observation and action of each of the `newest` steps at the end, in order."""
        rows = self.figures[-newest:]
        observed, done = rows["observation"].tolist(), rows["action"].tolist()
        return [(tuple(o), Action(*a)) for o, a in zip(observed, done, strict=True)]

    def so_far(self, most: int | None = None) -> "LaneSteps":
        """Return the steps so far, or the first `most` of them, to which none will be added."""
        steps = LaneSteps()
        # The figures first: the others have at least as many steps.
        steps._figures = GrowingArray(self.figures[:most])
        steps._newest, steps._packed = self._newest, self._packed
        return steps

    def __len__(self) -> int:
        """Number of steps so far."""
        return len(self._figures)

    @overload
    def __getitem__(self, index: int) -> LaneStep: ...

    @overload
    def __getitem__(self, index: slice) -> list[LaneStep]: ...

    def __getitem__(self, index: int | slice) -> LaneStep | list[LaneStep]:
        """Return a step, or several."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        number = index + len(self) if index < 0 else index
        if not 0 <= number < len(self):
            raise IndexError(index)
        first, newest = self._newest
        if number >= first:
            return newest[number - first]
        before, block = self._packed[bisect_right(self._packed, number, key=itemgetter(0)) - 1]
        return block.step(number - before, before)


class LaneRecording:
    """Recording of one lane of a race.

    Attributes:
        agent: name of the lane's agent.
        rest_qpos: pose on the start line, (7 + joints,): position [m], quaternion, angles [rad].
        steps: steps taken so far.
        failure: reason if the lane failed.
    """

    def __init__(
        self,
        agent: str,
        rest_qpos: NDArray[np.float32],
        steps: "LaneSteps | Iterable[LaneStep]" = (),
        failure: str | None = None,
    ) -> None:
        self.agent, self.rest_qpos, self.failure = agent, rest_qpos, failure
        self.steps = steps if isinstance(steps, LaneSteps) else LaneSteps(steps)

    def __repr__(self) -> str:
        failed = "" if self.failure is None else ", failed"
        return f"<LaneRecording of {self.agent}: {len(self.steps):,} steps{failed}>"

    def so_far(self) -> "LaneRecording":
        """Return the recording so far, which does not grow."""
        return LaneRecording(self.agent, self.rest_qpos, self.steps.so_far(), self.failure)

    def first(self, steps: int) -> "LaneRecording":
        """Return the recording of the first steps, as if the lane had not come further."""
        return LaneRecording(self.agent, self.rest_qpos, self.steps.so_far(steps))

    def start_qpos(self, step: int) -> NDArray[np.float32]:
        """Return the pose at the start of a step, (7 + joints,); steps are counted from 0 here."""
        if step == 0:
            return self.rest_qpos
        last: NDArray[np.float32] = self.steps[step - 1].motion.qpos[-1]
        return last

    @property
    def distance_m(self) -> float:
        """Distance covered so far [m]."""
        figures = self.steps.figures
        return float(figures[-1]["distance_m"]) if len(figures) else 0.0

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        return self.steps.size


_NOT_HASHED = ("decision_s", "lowest", "highest")


def recording_sha256(lanes: Iterable[LaneRecording]) -> str:
    """Return the SHA-256 of the steps of each lane of a recording, without decision times.

    The hash is of the figures of the steps, which follow from the motion to the last bit and are
    in memory. The reason of a failure does not count: it may name an object by its address.
    """
    digest = hashlib.sha256()
    for lane in lanes:
        rows = lane.steps.figures
        digest.update(f"{lane.agent} {rows.shape} {lane.failure is not None}".encode())
        names = [name for name in rows.dtype.names or () if name not in _NOT_HASHED]
        for column in (lane.rest_qpos, *(rows[name] for name in names)):
            digest.update(column.astype(column.dtype.newbyteorder("<")).tobytes())
        # A file keeps action values in single precision.
        for name in ("lowest", "highest"):
            digest.update(rows[name].astype("<f4").tobytes())
    return digest.hexdigest()


FIRST_STEPS, NEWEST_STEPS = 20, 500


@dataclass
class PracticeRecording:
    """Recording of a training: its first and its newest steps (ring buffer), and all evaluations.

    One thread appends, others read; the properties return copies, so no lock is needed.

    Attributes:
        rest_qpos: pose at the start, (7 + joints,).
    """

    rest_qpos: NDArray[np.float32]
    _first: list[StepTaken] = field(default_factory=list)
    _newest: deque[StepTaken] = field(default_factory=lambda: deque(maxlen=NEWEST_STEPS))
    _evaluations: list[Evaluated] = field(default_factory=list)

    def add(self, record: StepTaken | Evaluated) -> None:
        """Append a step or an evaluation."""
        if isinstance(record, Evaluated):
            self._evaluations.append(record)
        elif len(self._first) < FIRST_STEPS:
            self._first.append(record)
        else:
            self._newest.append(record)

    @property
    def steps(self) -> list[StepTaken]:
        """The stored steps, in order; there may be a gap after the first `FIRST_STEPS`."""
        return [*self._first, *list(self._newest)]

    @property
    def evaluations(self) -> list[Evaluated]:
        """All evaluations so far, in order."""
        return list(self._evaluations)

    def forget_motions(self, before: int) -> None:
        """Drop the motions of the first evaluations, which are stored, but for the newest motion.

        Args:
            before: number of those evaluations.
        """
        newest = max(
            (n for n, evaluation in enumerate(self._evaluations) if evaluation.motion), default=-1
        )
        for number, evaluation in enumerate(self._evaluations[: min(before, newest)]):
            if evaluation.motion is not None:
                self._evaluations[number] = replace(evaluation, motion=None)

    def without_evaluation_motions(self) -> "PracticeRecording":
        """Return a copy whose evaluations have their distances, but no motion.

        It takes a fraction of the memory: an evaluation has the motion of 50 steps.
        """
        evaluations = [replace(evaluation, motion=None) for evaluation in self.evaluations]
        return PracticeRecording(self.rest_qpos, self._first[:], self._newest.copy(), evaluations)

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        steps = sum(_size_of(step.motion, step.action_values) for step in self.steps)
        return steps + sum(_size_of(evaluation.motion) for evaluation in self.evaluations)


def _size_of(motion: Motion | None, action_values: ActionValues | None = None) -> int:
    values = (action_values.values, action_values.visits) if action_values else ()
    arrays: tuple[NDArray[Any] | None, ...] = (*(motion or ()), *values)
    return _STEP_OVERHEAD_BYTES + sum(array.nbytes for array in arrays if array is not None)


def pose_at(start: NDArray[np.float32], motion: Motion, time_s: float) -> FloatArray:
    """Interpolate the pose at a time within a motion.

    Linear in position and angles; the quaternion is interpolated linearly and normalised (nlerp).

    Args:
        start: pose at the start of the motion, (7 + joints,).
        motion: the motion.
        time_s: time since its start [s], clamped to its duration.

    Returns:
        the pose, (7 + joints,).
    """
    times = np.concatenate(([0.0], motion.time_s))
    upper = min(int(np.searchsorted(times, time_s, side="left")), len(times) - 1)
    if upper == 0:
        return start.astype(float)
    lower = upper - 1
    before = start if lower == 0 else motion.qpos[lower - 1]
    share = (time_s - times[lower]) / (times[upper] - times[lower])
    blend = before + min(max(share, 0.0), 1.0) * (motion.qpos[upper - 1] - before)
    blend[3:7] /= np.sqrt((blend[3:7] * blend[3:7]).sum())
    pose: FloatArray = blend.astype(float)
    return pose
