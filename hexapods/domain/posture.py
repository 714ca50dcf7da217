"""Posture of a robot: its rotation, its heading, and whether it has fallen."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray

_TOUCHING_M = 0.002
"""Height of the torso over the ground below which it lies there."""


def has_fallen(robot: Robot, pose: Sequence[float], ground_m: float = 0.0) -> bool:
    """Whether the torso lies on the ground, by the lowest point of its cylinder or box.

    Args:
        robot: the robot.
        pose: torso position [m] and rotation (wxyz), which may be followed by joint angles [rad].
        ground_m: height of the highest bumps of the ground [m].
    """
    _, _, z, *rotation = pose[:7]
    return bool(_lowest(robot, z, rotation, math.sqrt, max) <= ground_m + _TOUCHING_M)


TILT = (2, 3, 4, 5, 6)
"""Indices in a pose of the height and the rotation, by which a robot has fallen or not."""


def have_fallen(robot: Robot, tilts: FloatArray, ground_m: float = 0.0) -> NDArray[np.bool_]:
    """Return whether each of n poses `has_fallen`, by their `TILT`, (n, 5), to the same bit."""
    z, *rotation = tilts.T
    return np.asarray(_lowest(robot, z, rotation, np.sqrt, np.maximum) <= ground_m + _TOUCHING_M)


def _lowest(robot: Robot, z: Any, wxyz: Sequence[Any], root: Any, larger: Any) -> Any:
    """Return the height of the torso's lowest point [m].

    Numbers are floats with the functions `math.sqrt` and `max`, or arrays with those of NumPy.
    """
    w, x, y, around = wxyz
    upright = 1 - 2 * (x * x + y * y)  # cosine of the torso's tilt
    low = z - abs(upright) * robot.torso_half_height_m
    if robot.torso_length_m is None:
        return low - root(larger(0.0, 1 - upright * upright)) * robot.torso_radius_m
    half_x, half_y = robot.torso_half_sides_m
    sideways, lengthways = 2 * (x * around - w * y), 2 * (y * around + w * x)
    return low - abs(sideways) * half_x - abs(lengthways) * half_y


def heading_deg(pose: Sequence[float], start: Sequence[float]) -> float:
    """Return by how much the torso has turned since the start, anticlockwise from above [°].

    Args:
        pose: torso position and rotation (wxyz), which may be followed by joint angles.
        start: the pose at the start.
    """
    turned = math.degrees(yaw_rad(pose[3:7]) - yaw_rad(start[3:7]))
    return (turned + 180) % 360 - 180


def yaw_rad(wxyz: Sequence[float]) -> float:
    """Return the yaw of a rotation, a quaternion: anticlockwise from above [rad]."""
    w, x, y, z = wxyz
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def rotation_matrices(poses: FloatArray) -> FloatArray:
    """Return the rotation of each pose's torso as a matrix, (k, 3, 3).

    Args:
        poses: torso position and rotation (wxyz), which may be followed by joint angles, (k, ...).
    """
    w, x, y, z = poses[:, 3:7].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
