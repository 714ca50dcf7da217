"""Colour conversion, and the perceptual colour map (viridis) that 3D, table and legend share."""

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray

Rgb = tuple[int, int, int]

VIRIDIS = (
    "#440154",
    "#482475",
    "#414487",
    "#355f8d",
    "#2a788e",
    "#21918c",
    "#22a884",
    "#44bf70",
    "#7ad151",
    "#bddf26",
    "#fde725",
)
"""Evenly spaced stops from low to high values, interpolated linearly in sRGB."""


def rgb(color: str) -> Rgb:
    """Parse `#RRGGBB` into (red, green, blue), 0–255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


_STOPS = np.array([rgb(color) for color in VIRIDIS], float)


def value_colors(values: FloatArray, low: float, high: float) -> NDArray[np.uint8]:
    """Map values to colours by linear interpolation between the stops of viridis.

    Args:
        values: (...); NaN gets the lowest colour.
        low: value of the first stop; lower values are clipped.
        high: value of the last stop; higher values are clipped.

    Returns:
        (..., 3), 0–255.
    """
    fraction = (np.nan_to_num(values, nan=low) - low) / (high - low) if high > low else 0 * values
    index = np.clip(np.nan_to_num(fraction), 0, 1) * (len(_STOPS) - 1)
    channels = [np.interp(index, np.arange(len(_STOPS)), _STOPS[:, c]) for c in range(3)]
    return np.stack(channels, axis=-1).round().astype(np.uint8)


def mix(color: Rgb, other: Rgb, fraction: float) -> Rgb:
    """Interpolate linearly between two colours; `fraction` 0 is the first, 1 the other."""
    r, g, b = (round((1 - fraction) * a + fraction * c) for a, c in zip(color, other, strict=True))
    return r, g, b
