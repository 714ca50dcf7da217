"""Inverse and forward kinematics of the legs.

A leg is coxa (yaw), femur (pitch), tibia (pitch). Its foot lies in the vertical plane that the
coxa turns; in that plane femur and tibia are a two-link arm with the knee above. Positive pitch
lifts. Feet are given as offsets from their home position in the robot frame (x right, y forward,
z up), joint angles in rad.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray

JOINT_LIMITS_RAD = {"coxa": (-1.2, 1.2), "femur": (-1.4, 1.9), "tibia": (-2.8, 0.0)}
"""Joint limits (low, high), used by the model's joint ranges and by `check_reach`."""


class Legs:
    """Kinematics of the legs of one robot under one gait.

    All operations are elementwise, so that results do not depend on the batch size.
    """

    def __init__(self, robot: Robot, gait: Gait) -> None:
        self.robot = robot
        azimuth = np.deg2rad(gait.azimuths_deg)
        mounts = np.array([leg.radius_m for leg in robot.legs])
        sin, cos = np.sin(azimuth), np.cos(azimuth)
        home = robot.home_radius_m - mounts
        self.frames: FloatArray = np.array([(home, 0 * home), (-sin, -cos), (cos, -sin)])
        """Affine map from the robot frame to each leg's frame, (3, 2, legs): home's position from
        the coxa joint [m], the coefficients of x, the coefficients of y; each along the leg, and
        across."""
        self._frames = [frame.ravel().tolist() for frame in np.moveaxis(self.frames, -1, 0)]

    def joint_angles(self, offsets: FloatArray) -> FloatArray:
        """Compute the inverse kinematics of all feet.

        Args:
            offsets: of the feet from home, (..., legs, 3) in the robot frame [m].

        Returns:
            (..., legs, 3) coxa, femur, tibia [rad]; NaN where a foot is out of reach.
        """
        x, y, z = np.ascontiguousarray(np.moveaxis(offsets, -1, 0))
        frames = self.frames.reshape(3, 2, *(1 for _ in offsets.shape[:-2]), -1)
        with np.errstate(invalid="ignore"):
            return self.solve(np.array((x, y)), z, frames)

    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        """Compute the inverse kinematics of any feet, each in the frame of its leg.

        Coordinates are separate contiguous arrays: NumPy's loops over strided arrays are slower,
        and may differ in the last bit. As few NumPy calls as possible, since every training step
        pays their overhead.

        Args:
            places: offsets from home to the right and forward in the robot frame [m], (2, ...).
            heights: heights above the ground [m]; broadcasts with `places`.
            frames: a column of `self.frames` for each foot, (3, 2, ...).

        Returns:
            (..., 3) coxa, femur, tibia [rad]; NaN with a NumPy warning where a foot is out of
            reach, which `check_reach` rules out beforehand.
        """
        home, of_x, of_y = frames
        feet = home + (of_x * places[0] + of_y * places[1])  # (2, ...): along the leg, across
        squares = feet * feet
        r = np.sqrt(squares[0] + squares[1]) - self.robot.coxa_m
        fall = heights - self.robot.body_height_m
        femur, tibia = self.robot.femur_m, self.robot.tibia_m
        bend = (r * r + fall * fall - (femur * femur + tibia * tibia)) / (2 * femur * tibia)
        drop = np.sqrt(1 - bend * bend)
        angles = np.empty((*r.shape, 3))
        angles[..., 0] = np.arctan2(feet[1], feet[0])
        angles[..., 1] = np.arctan2(fall, r) + np.arctan2(tibia * drop, femur + tibia * bend)
        angles[..., 2] = -np.arctan2(drop, bend)
        return angles

    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        """Compute the forward kinematics of one pose, the inverse of `joint_angles`.

        In plain floats, which are faster than arrays for the six legs of one pose.

        Args:
            angles: coxa, femur, tibia of leg 1, of leg 2, and so on [rad].

        Returns:
            For each leg (x, y, z), its foot's offset from home in the robot frame [m].
        """
        robot, offsets = self.robot, []
        for leg, (home, _, x_along, x_across, y_along, y_across) in enumerate(self._frames):
            coxa, femur, tibia = angles[3 * leg : 3 * leg + 3]
            reach, across, height = _foot(robot, coxa, femur, tibia, math)
            along = reach - home
            offsets.append(
                (
                    x_along * along + x_across * across,
                    y_along * along + y_across * across,
                    height + robot.body_height_m,
                )
            )
        return offsets


def _foot(robot: Robot, coxa: Any, femur: Any, tibia: Any, of: Any) -> tuple[Any, Any, Any]:
    """Return a foot's place from its coxa joint: along the leg, across, and upward [m].

    Angles [rad] are floats with the functions of `math`, or arrays with those of `numpy`.
    """
    knee = femur + tibia
    r = robot.coxa_m + robot.femur_m * of.cos(femur) + robot.tibia_m * of.cos(knee)
    height = robot.femur_m * of.sin(femur) + robot.tibia_m * of.sin(knee)
    return r * of.cos(coxa), r * of.sin(coxa), height


def foot_positions(robot: Robot, poses: FloatArray) -> FloatArray:
    """Compute the forward kinematics of many poses, in the world.

    Args:
        robot: the robot.
        poses: torso position [m], rotation (wxyz) and joint angles [rad], (k, 7 + 3 · legs).

    Returns:
        (k, legs, 3), the centres of the feet [m].
    """
    angles = poses[:, 7:].reshape(len(poses), -1, 3)
    coxa, femur, tibia = np.moveaxis(angles, -1, 0)
    along, across, height = _foot(robot, coxa, femur, tibia, np)
    azimuth = np.deg2rad(robot.azimuths_deg)
    along = along + np.array([leg.radius_m for leg in robot.legs])
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    feet = np.stack([along * cos - across * sin, along * sin + across * cos, height], axis=-1)
    turned: FloatArray = np.einsum("kij,klj->kli", rotation_matrices(poses), feet)
    return poses[:, None, :3] + turned


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


@lru_cache(maxsize=64)
def check_reach(robot: Robot, gait: Gait, grid: FootGrid) -> None:
    """Check that every foot offset that can occur is within each leg's reach and joint limits.

    A foot's actual forward offset drifts as the body re-centres. With P pairs it stays strictly
    within (P − 1) h of home, since the offsets sum to zero and each was last commanded to within
    h (half the grid's side). Cached, since every run of an experiment asks it again.

    Raises:
        Unreachable: naming the leg and the cell.
    """
    legs, drift = Legs(robot, gait), len(gait.pairs) - 1
    for cell, (x, y) in enumerate(grid.cells):
        passages = (
            ("", y),
            (" after the body has re-centred", drift * y),
            (" on the way there", 0.0),
        )
        for why, forward in passages:
            for height in (0.0, robot.step_height_m):
                offset = np.array([x, forward, height])
                angles = legs.joint_angles(np.tile(offset, (len(robot.legs), 1)))
                for leg, joints in enumerate(angles, start=1):
                    problem = _reach_problem(joints)
                    if problem:
                        raise Unreachable(
                            f"leg {leg} cannot reach cell {cell} ({grid.name(cell)}){why}: "
                            f"{problem}; choose a smaller grid_side_m than {grid.side_m:g}, a "
                            "lower step_height_m, or other link lengths, home radius or body height"
                        )


def _reach_problem(joints: FloatArray) -> str:
    if np.isnan(joints).any():
        return "it is out of the reach of its links"
    for (name, (low, high)), angle in zip(JOINT_LIMITS_RAD.items(), joints, strict=True):
        if not low <= angle <= high:
            return f"its {name} would turn to {np.rad2deg(angle):.0f}°, beyond its limit"
    return ""
