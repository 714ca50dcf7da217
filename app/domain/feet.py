"""Where the feet are if nothing slips: the kinematic law of a step.

The feet of a pair mirror each other, so a pair stands for both: its leader is at (x, y) from
home, its partner at (−x, y). A step puts one pair on its new cell; then the body moves by the
mean of all forward offsets, and every offset shrinks by it. Lateral offsets cancel by symmetry.
"""

from typing import NamedTuple

import numpy as np

from app.domain.types import Cells, FloatArray


class Feet(NamedTuple):
    """The offsets of all pairs from home in the robot frame. Plain floats: they are few."""

    commanded: Cells
    """The cell that each pair was last sent to."""
    lateral_m: tuple[float, ...]
    """Of each pair's leader to the right."""
    forward_m: tuple[float, ...]

    @classmethod
    def at_home(cls, pairs: int) -> "Feet":
        """Every foot at home."""
        nothing = (0.0,) * pairs
        return cls((0,) * pairs, nothing, nothing)

    def landed(self, pair: int, cell: int, place_m: tuple[float, float]) -> "Feet":
        """After the swing: a pair is on its new cell, which is at `place_m` from home."""
        x, y = place_m
        return Feet(
            (*self.commanded[:pair], cell, *self.commanded[pair + 1 :]),
            (*self.lateral_m[:pair], x, *self.lateral_m[pair + 1 :]),
            (*self.forward_m[:pair], y, *self.forward_m[pair + 1 :]),
        )

    def centred(self) -> tuple["Feet", float]:
        """After the shift: the body is over the mean of the feet; and how far it moved [m]."""
        mean = sum(self.forward_m) / len(self.forward_m)
        forward = tuple(y - mean for y in self.forward_m)
        return Feet(self.commanded, self.lateral_m, forward), mean

    def as_array(self) -> FloatArray:
        """(3, pairs), for a file."""
        return np.array((self.commanded, self.lateral_m, self.forward_m), float)

    @classmethod
    def from_array(cls, array: FloatArray) -> "Feet":
        """What `as_array` wrote."""
        commanded, lateral, forward = array.tolist()
        return cls(tuple(int(cell) for cell in commanded), tuple(lateral), tuple(forward))
