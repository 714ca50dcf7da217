"""Turns about the vertical."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.domain.types import FloatArray


def yaw_rad(wxyz: NDArray[np.floating[Any]]) -> float:
    """How far an attitude is turned about the vertical, anticlockwise from above."""
    w, x, y, z = wxyz.tolist()
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def turned(pose: FloatArray, about: FloatArray, turn_rad: float) -> FloatArray:
    """A pose, (7 + joints,), with `about` (x, y) put on the origin and the world turned about it.

    Height, tilt and joints stay as they are.
    """
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    half_cos, half_sin = math.cos(turn_rad / 2), math.sin(turn_rad / 2)
    x, y = pose[:2] - about
    w, i, j, k = pose[3:7]
    seen = pose.copy()
    seen[:2] = cos * x - sin * y, sin * x + cos * y
    seen[3:7] = (
        half_cos * w - half_sin * k,
        half_cos * i - half_sin * j,
        half_cos * j + half_sin * i,
        half_cos * k + half_sin * w,
    )
    return seen
