"""Colours: agents', and the perceptual scale for values that 3D, table and legend share."""

import numpy as np
from numpy.typing import NDArray

from app.domain.types import FloatArray

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
"""From worth less to worth more, evenly spaced; between them colours are mixed linearly."""


def rgb(color: str) -> Rgb:
    """(red, green, blue), 0–255, of `#RRGGBB`."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


_STOPS = np.array([rgb(color) for color in VIRIDIS], float)


def value_colors(values: FloatArray, low: float, high: float) -> NDArray[np.uint8]:
    """The colour of each value on a scale from low to high, (..., 3); of NaN the lowest."""
    share = (np.nan_to_num(values, nan=low) - low) / (high - low) if high > low else 0 * values
    place = np.clip(np.nan_to_num(share), 0, 1) * (len(_STOPS) - 1)
    channels = [np.interp(place, np.arange(len(_STOPS)), _STOPS[:, c]) for c in range(3)]
    return np.stack(channels, axis=-1).round().astype(np.uint8)


def mixed(color: Rgb, other: Rgb, share: float) -> Rgb:
    """A colour with a share of another in it."""
    r, g, b = (round((1 - share) * a + share * c) for a, c in zip(color, other, strict=True))
    return r, g, b


def batched(colors: NDArray[np.uint8], dimmed: float = 1.0) -> NDArray[np.uint8]:
    """Colours as viser 1.1.1 wants them for batched meshes, which it reads as linear.

    Args:
        colors: (n, 3), 0–255.
        dimmed: for what lies flat under the stage's light and should look no paler than it is.
    """
    return (255 * dimmed * (colors / 255.0) ** 2.2).round().astype(np.uint8)
