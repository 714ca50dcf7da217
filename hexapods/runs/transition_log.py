"""Log of the transitions of a practice: what its learner observed, did and earned, step by step.

With the log a learner of any step can be rebuilt without physics (`hexapods.runs.rebuilding`).
It takes 16 bytes a step with three groups of legs: rewards are float64, so that the rebuilt values
are equal to the bit.
"""

from array import array
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.recording import Arrays

MAX_LOGGED_STEPS = 1_000_000
"""Steps of a training that are logged, from its start; about 16 MB."""
BYTES_PER_STEP = 24
"""Approximate size of a step in memory, with five groups of legs or fewer."""


class Logged(NamedTuple):
    """One step of the log."""

    observation: Cells
    measured: Cells
    """The measured cells before the step, whatever the run's observation is."""
    action: Action
    reward_m: float
    next_observation: Cells
    next_measured: Cells


class Transitions(NamedTuple):
    """Consecutive steps of a practice."""

    first: int
    """Number of steps before the first of them."""
    observed: NDArray[np.uint8]
    """Observation before each of n steps and after the last, (n + 1, groups)."""
    measured: NDArray[np.uint8]
    """The measured cells at these times, (n + 1, groups)."""
    actions: NDArray[np.uint8]
    """Group and cell of each action, (n, 2)."""
    rewards_m: FloatArray
    """(n,)"""

    def step(self, number: int) -> Logged:
        """Return the step of an index, from 0 on."""
        observed = [tuple(row) for row in self.observed[number : number + 2].tolist()]
        measured = [tuple(row) for row in self.measured[number : number + 2].tolist()]
        action = Action(*self.actions[number].tolist())
        reward_m = float(self.rewards_m[number])
        return Logged(observed[0], measured[0], action, reward_m, observed[1], measured[1])

    def check(self, groups: int, cells: int) -> None:
        """Check that the steps are possible on a foot grid, as those of an untrusted file.

        Raises:
            ValueError: if they are not.
        """
        count = len(self.rewards_m)
        shapes = [(count + 1, groups), (count + 1, groups), (count, 2), (count,)]
        arrays = (self.observed, self.measured, self.actions, self.rewards_m)
        if [array.shape for array in arrays] != shapes:
            raise ValueError("its steps do not fit together")
        if (
            any(array.dtype != np.uint8 for array in arrays[:3])
            or self.rewards_m.dtype != np.float64
        ):
            raise ValueError("its steps are no numbers of cells and rewards")
        if self.observed.max() >= cells or self.measured.max() >= cells:
            raise ValueError("what it observed is on no foot grid")
        if (self.actions >= [groups, cells]).any() or not np.isfinite(self.rewards_m).all():
            raise ValueError("what it did cannot be done")
        moved = self.observed[np.arange(count), self.actions[:, 0]]
        if (moved == self.actions[:, 1]).any():
            raise ValueError("what it did was not allowed")


class TransitionLog:
    """Append-only log of a practice from its first step: one thread appends, others read.

    It stops to grow after `MAX_LOGGED_STEPS`.
    """

    def __init__(self) -> None:
        self._groups = 0
        self._observed, self._measured = bytearray(), bytearray()
        self._actions, self._rewards = bytearray(), array("d")

    def __len__(self) -> int:
        """Number of steps."""
        return len(self._rewards)

    def extend(self, steps: Transitions) -> None:
        """Append steps, but not those that it has already.

        Raises:
            ValueError: if a step between is missing.
        """
        if len(self) >= MAX_LOGGED_STEPS:
            return
        begin, end = len(self) - steps.first, MAX_LOGGED_STEPS - steps.first
        if begin < 0:
            raise ValueError(f"these steps follow step {steps.first}, not step {len(self)}")
        self._groups = steps.observed.shape[1]
        # The observation after the last step is there; before the first step nothing is.
        rows = slice(begin + bool(self._observed), end + 1)
        self._observed += steps.observed[rows].tobytes()
        self._measured += steps.measured[rows].tobytes()
        self._actions += steps.actions[begin:end].tobytes()
        self._rewards.frombytes(steps.rewards_m[begin:end].tobytes())

    def part(self, first: int, end: int) -> Transitions:
        """Return the steps from one to before another, as far as there are; a copy."""
        end = min(end, len(self))
        cells = slice(first * self._groups, (end + 1) * self._groups)
        observed, measured = (
            np.frombuffer(bytes(column[cells]), np.uint8).reshape(-1, self._groups)
            for column in (self._observed, self._measured)
        )
        actions = np.frombuffer(bytes(self._actions[2 * first : 2 * end]), np.uint8)
        rewards = np.array(self._rewards[first:end], float)
        return Transitions(first, observed, measured, actions.reshape(-1, 2), rewards)

    def truncated(self, steps: int) -> "TransitionLog | None":
        """Return a log of the first `steps` steps; None if it has fewer and cannot go on there."""
        if len(self) < min(steps, MAX_LOGGED_STEPS):
            return None
        log = TransitionLog()
        if steps:
            log.extend(self.part(0, steps))
        return log


def transitions_of(first: int, steps: Sequence[Logged]) -> Transitions:
    """Return consecutive steps, at least one, as arrays; `first` steps were taken before."""
    last = steps[-1]
    return Transitions(
        first,
        np.array([*(step.observation for step in steps), last.next_observation], np.uint8),
        np.array([*(step.measured for step in steps), last.next_measured], np.uint8),
        np.array([step.action for step in steps], np.uint8),
        np.array([step.reward_m for step in steps], np.float64),
    )


def transition_arrays(steps: Transitions) -> Arrays:
    """Encode steps as arrays for a file."""
    return {**steps._asdict(), "first": np.array(steps.first)}


def transitions(arrays: Arrays) -> Transitions:
    """Decode the output of `transition_arrays`."""
    return Transitions(**{**arrays, "first": int(arrays["first"])})  # type: ignore[arg-type]
