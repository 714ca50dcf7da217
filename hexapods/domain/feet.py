"""Foot offsets without slip, and the kinematic law of a step.

All feet of a group have the same offset (x, y) from home, some of them mirrored, at (−x, y). A step
puts one group on its new cell; then the body moves by the mean of the forward offsets of all feet,
and every offset shrinks by it. The body does not move sideways.
"""

from collections.abc import Sequence
from operator import mul, sub
from typing import NamedTuple

import numpy as np

from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import Action, Cells, FloatArray


class Feet(NamedTuple):
    """Offsets of all groups of legs from home, in the robot frame.

    Plain floats, which are faster than arrays for so few numbers.
    """

    commanded: Cells
    """The cell that each group was last sent to."""
    lateral_m: tuple[float, ...]
    """Offset of each group to the right of home [m]."""
    forward_m: tuple[float, ...]
    """Offset of each group forward of home [m]."""

    @property
    def offsets_m(self) -> tuple[tuple[float, float], ...]:
        """Offset (x, y) of each group [m]."""
        return tuple(zip(self.lateral_m, self.forward_m, strict=True))

    @classmethod
    def at_home(cls, groups: int) -> "Feet":
        """Return the offsets with every foot at home."""
        zeros = (0.0,) * groups
        return cls((0,) * groups, zeros, zeros)

    def landed(self, group: int, cell: int, place_m: tuple[float, float]) -> "Feet":
        """Return the offsets after the swing phase.

        Args:
            group: the group that swings.
            cell: its new cell.
            place_m: the cell's displacement (x, y) from home.
        """
        x, y = place_m
        return Feet(
            (*self.commanded[:group], cell, *self.commanded[group + 1 :]),
            (*self.lateral_m[:group], x, *self.lateral_m[group + 1 :]),
            (*self.forward_m[:group], y, *self.forward_m[group + 1 :]),
        )

    def moved(self, by_m: FloatArray) -> "Feet":
        """Return the offsets with the groups moved, by (groups, 2) [m]."""
        lateral, forward = (np.array((self.lateral_m, self.forward_m)) + by_m.T).tolist()
        return Feet(self.commanded, tuple(lateral), tuple(forward))

    def mean_m(self, sizes: Sequence[int]) -> float:
        """Return the mean forward offset of all feet, from the number of those of each group [m].

        For pairs and single legs it is the mean over groups to the last bit.
        """
        total = ordered_sum(map(mul, self.forward_m, sizes))
        return total / sum(sizes)  # whole numbers

    def shifted(self, advance_m: float) -> "Feet":
        """Return the offsets after the body has moved forward."""
        forward = tuple(y - advance_m for y in self.forward_m)
        return Feet(self.commanded, self.lateral_m, forward)

    def as_array(self) -> FloatArray:
        """Return the offsets as an array (3, groups), for storage."""
        return np.array((self.commanded, self.lateral_m, self.forward_m), float)

    @classmethod
    def from_array(cls, array: FloatArray) -> "Feet":
        """Build the offsets from an array written by `as_array`, (3, groups)."""
        commanded, lateral, forward = array.tolist()
        return cls(tuple(int(cell) for cell in commanded), tuple(lateral), tuple(forward))


class Reach(NamedTuple):
    """Limits of each group's forward offset, where not every one that can occur is in reach."""

    back_m: tuple[float, ...]
    """Lowest forward offset of each group, below 0 [m]."""
    ahead_m: tuple[float, ...]
    """Highest forward offset of each group [m]."""


class StepLaw:
    """The kinematic law of a step, for one gait and foot grid.

    Where a long series of odd steps would lead feet out of reach, an action that ends there is not
    legal. If there is no other, the body moves only as far as all feet reach.
    """

    def __init__(self, gait: Gait, grid: FootGrid, reach: Reach | None) -> None:
        """Create the law; `reach` None if the feet reach every offset that can occur."""
        self.reach, self.sizes, self._places = reach, gait.sizes, grid.places_m

    def at_home(self) -> Feet:
        """Return the offsets with every foot at home."""
        return Feet.at_home(len(self.sizes))

    def step(self, start: Feet, action: Action) -> tuple[Feet, Feet, float]:
        """Return the offsets after swing and shift, and the body's forward displacement [m]."""
        group, cell = action
        landed = start.landed(group, cell, self._places[cell])
        advance = landed.mean_m(self.sizes)
        if self.reach is not None:
            forward = landed.forward_m
            least = max(map(sub, forward, self.reach.ahead_m))
            most = min(map(sub, forward, self.reach.back_m))
            advance = min(max(advance, least), most)
        return landed, landed.shifted(advance), advance

    def possible(self, start: Feet, actions: Sequence[Action]) -> Sequence[Action]:
        """Return the actions after which all feet are within reach; all if there is none."""
        if self.reach is None:
            return actions
        return [action for action in actions if self._stays_within(start, action)] or actions

    def _stays_within(self, start: Feet, action: Action) -> bool:
        landed, _, advance = self.step(start, action)
        return advance == landed.mean_m(self.sizes)
