"""Figures of a lane's steps: what fits in 77 bytes a step, as rows of one growing array.

All that is asked of a whole race follows from them: times under each clock, distances, crossings,
falls, ranges of values and what was observed and done. Only motion, action values and the findings
of a search are left to be read step by step.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.posture import TILT
from hexapods.domain.simulator import Motion
from hexapods.domain.types import FloatArray
from hexapods.runs.records import LaneStep

_FIRST_CAPACITY = 16
Rows = NDArray[Any]
"""A structured array; see `figures_type`."""


def figures_type(groups: int) -> np.dtype[Any]:
    """Return the type of a row.

    Its fields are those of `LaneStep`, and `lowest` and `highest`, of all action values up to the
    step and 0; `motion_s`, the duration of the motion [s]; `furthest_m`, the highest position along
    the track in it; `tilt` of the pose at its end (`hexapods.domain.posture`); and `frames`, their
    number.

    Args:
        groups: number of groups of legs, which are observed.
    """
    return np.dtype(
        [
            ("reward_m", "f8"),
            ("distance_m", "f8"),
            ("decision_s", "f8"),
            ("transitions", "i8"),
            ("lowest", "f8"),
            ("highest", "f8"),
            ("motion_s", "f4"),
            ("furthest_m", "f4"),
            ("tilt", "f4", (len(TILT),)),
            ("frames", "i4"),
            ("observation", "u1", (groups,)),
            ("action", "u1", (2,)),
        ]
    )


class GrowingArray:
    """Array that grows at its end: one thread appends, others read. Its capacity doubles."""

    def __init__(self, rows: Rows) -> None:
        """Begin with rows of the type of all; they are not copied until it grows."""
        self._rows, self._count = rows, len(rows)

    def __len__(self) -> int:
        """Number of rows."""
        return self._count

    @property
    def rows(self) -> Rows:
        """The rows so far; a view that later ones do not change."""
        count = self._count  # read first: the rows, which may be replaced, are at least so many
        return self._rows[:count]

    def extend(self, rows: Rows) -> None:
        """Append rows."""
        count = self._count + len(rows)
        if count > len(self._rows):
            grown = np.empty(max(_FIRST_CAPACITY, 2 * self._count, count), self._rows.dtype)
            grown[: self._count] = self._rows[: self._count]
            self._rows = grown
        self._rows[self._count : count] = rows
        self._count = count


def no_figures(groups: int = 0) -> Rows:
    """Return the figures of no steps; see `figures_type`."""
    return np.empty(0, figures_type(groups))


class StepColumns(NamedTuple):
    """Consecutive steps of a lane as they are in a file; n steps with k frames in all."""

    scalars: FloatArray
    """Reward, distance, transitions and duration of the decision, (n, 4)."""
    observation: NDArray[Any]
    action: NDArray[Any]
    frames: NDArray[np.int64]
    """Number of frames of each step, (n,)."""
    motion: Motion
    """The frames of all steps."""
    values: NDArray[np.floating[Any]] | None
    """Action values before each step, (n, groups, cells)."""


def columns_of(step: LaneStep) -> StepColumns:
    """Return a step as columns with one row; its action values keep their precision."""
    values = None if step.action_values is None else step.action_values.values[None]
    return StepColumns(
        np.array([(step.reward_m, step.distance_m, step.transitions, step.decision_s)]),
        np.array([step.observation]),
        np.array([step.action]),
        np.array([len(step.motion.time_s)]),
        step.motion,
        values,
    )


def rows_of(columns: StepColumns, before: Rows) -> Rows:
    """Return the rows of consecutive steps, at least one, after those of the steps before."""
    rows = np.empty(len(columns.frames), figures_type(columns.observation.shape[1]))
    for place, name in enumerate(("reward_m", "distance_m", "transitions", "decision_s")):
        rows[name] = columns.scalars[:, place]
    low, high = (before[-1]["lowest"], before[-1]["highest"]) if len(before) else (0.0, 0.0)
    if columns.values is None:
        rows["lowest"], rows["highest"] = low, high
    else:
        values = columns.values.reshape(len(rows), -1).astype(float)
        lowest, highest = np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)
        rows["lowest"] = np.fmin(low, np.fmin.accumulate(lowest))
        rows["highest"] = np.fmax(high, np.fmax.accumulate(highest))
    ends = np.cumsum(columns.frames)
    rows["motion_s"] = columns.motion.time_s[ends - 1]
    rows["furthest_m"] = np.maximum.reduceat(
        columns.motion.qpos[:, 1], (ends - columns.frames).astype(np.intp)
    )
    rows["tilt"] = columns.motion.qpos[ends - 1][:, TILT]
    rows["frames"] = columns.frames
    rows["observation"], rows["action"] = columns.observation, columns.action
    return rows
