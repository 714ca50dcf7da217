"""The foot grid: the discrete positions around home to which a foot may step (paper §4)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray

MIN_DIVISIONS, MAX_DIVISIONS = 2, 8
MIN_SIDE_M, MAX_SIDE_M = 0.005, 10.0


@dataclass(frozen=True)
class FootGrid:
    """Cells on a square centred on a foot's home position, in the robot frame (y forward).

    The cells are `divisions` × `divisions` evenly spaced points, and home if it is not one of
    them. Cell 0 is home; the others are ordered row by row from front to back, each from left to
    right. The grid is closed under x → −x.

    Raises:
        InvalidInput: if the side or the divisions are out of range.
    """

    side_m: float = 0.04
    """Length of the square's side [m]."""
    divisions: int = 2
    """Points along a side."""

    def __post_init__(self) -> None:
        whole = isinstance(self.divisions, int)
        if not (whole and MIN_DIVISIONS <= self.divisions <= MAX_DIVISIONS):
            raise InvalidInput(
                f"divisions must be a whole number from {MIN_DIVISIONS} to {MAX_DIVISIONS}, "
                f"not {self.divisions}"
            )
        if not MIN_SIDE_M <= self.side_m <= MAX_SIDE_M:
            raise InvalidInput(
                f"grid_side_m must be from {MIN_SIDE_M} to {MAX_SIDE_M:g} m, not {self.side_m}"
            )

    @property
    def half_side_m(self) -> float:
        """Half the side length [m], the unit h in which distances are compared across grids."""
        return self.side_m / 2

    @cached_property
    def cells(self) -> FloatArray:
        """Displacement of each cell from home [m], (cells, 2): x right, y forward."""
        last = self.divisions - 1  # scaled from integers, so that the middle is exactly 0
        ticks = self.half_side_m * (2 * np.arange(self.divisions) - last) / last
        points = [(x, y) for y in ticks[::-1] for x in ticks if (x, y) != (0.0, 0.0)]
        cells = np.array([(0.0, 0.0), *points])
        cells.flags.writeable = False
        return cells

    def __len__(self) -> int:
        return self.divisions**2 + (self.divisions % 2 == 0)

    @cached_property
    def places_m(self) -> tuple[tuple[float, float], ...]:
        """`cells` as plain floats."""
        return tuple((float(x), float(y)) for x, y in self.cells)

    @cached_property
    def mirror(self) -> tuple[int, ...]:
        """For each cell, the cell at (−x, y)."""
        return tuple(self.nearest(-x, y) for x, y in self.places_m)

    def nearest(self, x_m: float, y_m: float) -> int:
        """Return the cell nearest to an offset from home; ties go to home, then the lower index.

        In plain floats, which are faster than arrays for the few groups of a step.
        """
        # Exact ties differ in their last bits by rounding.
        tie = 1e-9 * self.side_m * self.side_m
        nearest, least = 0, float("inf")
        for cell, (x, y) in enumerate(self.places_m):
            squared = (x_m - x) * (x_m - x) + (y_m - y) * (y_m - y)
            if squared < least - tie:
                nearest, least = cell, squared
        return nearest

    def name(self, cell: int) -> str:
        """Return a cell's name: "home", "front left", or its displacement in millimetres."""
        if cell == 0:
            return "home"
        x, y = self.cells[cell]
        if self.divisions == 2:
            return f"{'front' if y > 0 else 'back'} {'left' if x < 0 else 'right'}"
        return f"{1000 * x:+.0f} mm right, {1000 * y:+.0f} mm forward"
