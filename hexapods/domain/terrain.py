"""Heights of the ground: bumps of rough ground, and how high it is below a point."""

import numpy as np

from hexapods.domain.disturbances import Rough
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World

ROUGH_PERIOD_M = 2.56
"""Side of the square of rough ground that repeats in both directions."""
ROUGH_CELL_M = 0.02
"""Distance between two heights of rough ground."""
_BUMP_M = 0.08
"""Distance between independent heights; those between are interpolated."""


def rough_heights(rough: Rough) -> FloatArray:
    """Return heights of one period of rough ground [m], (rows along the track, columns across).

    Heights on a coarse square lattice are drawn from the seed, from 0 to the amplitude, and
    interpolated by half a cosine in both directions; edges meet.
    """
    coarse_count = round(ROUGH_PERIOD_M / _BUMP_M)
    coarse = np.random.default_rng(rough.seed).random((coarse_count, coarse_count))
    fine = round(_BUMP_M / ROUGH_CELL_M)
    weights = (1 - np.cos(np.pi * np.arange(fine) / fine)) / 2
    for axis in (0, 1):
        after = np.roll(coarse, -1, axis)
        stacked = [coarse + weight * (after - coarse) for weight in weights]
        coarse = np.stack(stacked, axis + 1)
        shape = (-1, coarse.shape[-1]) if axis == 0 else (coarse.shape[0], -1)
        coarse = coarse.reshape(shape)
    return np.asarray(rough.amplitude_m * coarse, float)


def rough_heights_at(rough: Rough, places_m: FloatArray) -> FloatArray:
    """Interpolate heights of rough ground bilinearly at places (x, y), (..., 2) to (...) [m]."""
    heights = rough_heights(rough)
    cells = places_m / ROUGH_CELL_M
    first = np.floor(cells).astype(int)
    (across, along), count = np.moveaxis(cells - first, -1, 0), len(heights)
    column, row = np.moveaxis(first, -1, 0)
    total = np.zeros(across.shape)
    # Row and column 0 of a period lie at the origin; rows are along the track, which is y.
    for up, share_up in ((0, 1 - along), (1, along)):
        for right, share_right in ((0, 1 - across), (1, across)):
            corner = heights[(row + up) % count, (column + right) % count]
            total += share_up * share_right * corner
    return total


def ground_heights(conditions: World, places_m: FloatArray) -> FloatArray:
    """Return the height of the ground at some places [m], (...).

    Args:
        conditions: a result of `World.as_of`. Flat ground is at 0, also where it slopes, since the
            frame of the world is that of the ground.
        places_m: (x, y) in the world, (..., 2) [m].
    """
    rough = conditions.one_of(Rough)
    if rough is None or rough.amplitude_m == 0:
        return np.zeros(places_m.shape[:-1])
    return rough_heights_at(rough, places_m)
