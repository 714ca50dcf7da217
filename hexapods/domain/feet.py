"""Foot offsets without slip, and the kinematic law of a step.

All feet of a group have the same offset (x, y) from home, some of them mirrored, at (−x, y). A step
puts one group on its new cell; then the body moves by the mean of all forward offsets, and every
offset shrinks by it. Lateral offsets cancel by symmetry.
"""

from typing import NamedTuple

import numpy as np

from hexapods.domain.types import Cells, FloatArray


class Feet(NamedTuple):
    """Offsets of all groups of legs from home, in the robot frame.

    Plain floats, which are faster than arrays for so few numbers.
    """

    commanded: Cells
    """The cell that each group was last sent to."""
    lateral_m: tuple[float, ...]
    """Of each group, to the right of home [m]."""
    forward_m: tuple[float, ...]
    """Of each group, forward of home [m]."""

    @property
    def offsets_m(self) -> tuple[tuple[float, float], ...]:
        """Offset (x, y) of each group [m]."""
        return tuple(zip(self.lateral_m, self.forward_m, strict=True))

    @classmethod
    def at_home(cls, groups: int) -> "Feet":
        """Return the offsets with every foot at home."""
        nothing = (0.0,) * groups
        return cls((0,) * groups, nothing, nothing)

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

    def centred(self) -> tuple["Feet", float]:
        """Return the offsets after the shift phase, and the body's forward displacement [m].

        The shift centres the body over the mean of the feet.
        """
        mean = sum(self.forward_m) / len(self.forward_m)
        forward = tuple(y - mean for y in self.forward_m)
        return Feet(self.commanded, self.lateral_m, forward), mean

    def as_array(self) -> FloatArray:
        """Return the offsets as an array (3, groups), for storage."""
        return np.array((self.commanded, self.lateral_m, self.forward_m), float)

    @classmethod
    def from_array(cls, array: FloatArray) -> "Feet":
        """Build the offsets from an array written by `as_array`, (3, groups)."""
        commanded, lateral, forward = array.tolist()
        return cls(tuple(int(cell) for cell in commanded), tuple(lateral), tuple(forward))
