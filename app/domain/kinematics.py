"""Leg kinematics: joint angles for a foot's place, and back.

A leg is coxa (yaw), femur (pitch), tibia (pitch). Its foot lies in the vertical plane that the
coxa turns; in that plane femur and tibia are a two-link arm with the knee above. Positive pitch
lifts. Feet are given as offsets from their home position in the robot frame (x right, y forward,
z up), joint angles in rad.
"""

import math
from collections.abc import Sequence

import numpy as np

from app.domain.errors import Unreachable
from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.robot import Robot
from app.domain.types import FloatArray

JOINT_LIMITS_RAD = {"coxa": (-1.2, 1.2), "femur": (-1.4, 1.9), "tibia": (-2.8, 0.0)}
"""How far each servo turns; the model's joint ranges and the check of reach both use it."""


class Legs:
    """The legs of one robot under one gait.

    Everything is elementwise, so a result does not depend on how many are computed at once.
    """

    def __init__(self, robot: Robot, gait: Gait) -> None:
        self.robot = robot
        azimuth = np.deg2rad(gait.azimuths_deg)
        mounts = np.array([leg.radius_m for leg in robot.legs])
        sin, cos = np.sin(azimuth), np.cos(azimuth)
        home = robot.home_radius_m - mounts
        self.frames: FloatArray = np.array([(home, 0 * home), (-sin, -cos), (cos, -sin)])
        """From the robot frame to the frame of each leg, (3, 2, legs): where home is from the coxa
        joint [m], what x adds to that, what y adds; each along the leg, and across."""
        self._frames = [frame.ravel().tolist() for frame in np.moveaxis(self.frames, -1, 0)]

    def joint_angles(self, offsets: FloatArray) -> FloatArray:
        """Inverse kinematics of all feet.

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
        """Inverse kinematics of any feet, each in the frame of its leg.

        The coordinates come apart and contiguous: NumPy's loops over strided numbers are slower,
        and may differ in the last bit. Few calls, since a step of training makes them anew.

        Args:
            places: offsets from home to the right and forward in the robot frame [m], (2, ...).
            heights: over the ground [m]; broadcasts with them.
            frames: a column of `self.frames` for each foot, (3, 2, ...).

        Returns:
            (..., 3) coxa, femur, tibia [rad]; NaN where a foot is out of reach, with NumPy's
            warning: `check_reach` has made sure that none is.
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
        """Forward kinematics, the inverse of `joint_angles`, for one pose.

        In plain floats: asked once a step, that is quicker than arrays of six.

        Args:
            angles: coxa, femur, tibia of leg 1, of leg 2, and so on [rad].

        Returns:
            For each leg (x, y, z), its foot's offset from home in the robot frame [m].
        """
        robot, offsets = self.robot, []
        for leg, (home, _, x_along, x_across, y_along, y_across) in enumerate(self._frames):
            coxa, femur, tibia = angles[3 * leg : 3 * leg + 3]
            knee = femur + tibia
            r = robot.coxa_m + robot.femur_m * math.cos(femur) + robot.tibia_m * math.cos(knee)
            along, across = r * math.cos(coxa) - home, r * math.sin(coxa)
            height = robot.femur_m * math.sin(femur) + robot.tibia_m * math.sin(knee)
            offsets.append(
                (
                    x_along * along + x_across * across,
                    y_along * along + y_across * across,
                    height + robot.body_height_m,
                )
            )
        return offsets


def check_reach(robot: Robot, gait: Gait, grid: FootGrid) -> None:
    """Make sure that no sequence of actions can ask a leg for more than it can do.

    A foot's true forward offset drifts as the body re-centres; with P pairs it stays strictly
    within (P − 1) h of home, since offsets add up to nothing and each was once sent to within h.

    Raises:
        Unreachable: naming the leg and the cell.
    """
    legs, drift = Legs(robot, gait), len(gait.pairs) - 1
    for cell, (x, y) in enumerate(grid.cells):
        ways = (("", y), (" after the body has re-centred", drift * y), (" on the way there", 0.0))
        for why, forward in ways:
            for height in (0.0, robot.step_height_m):
                offset = np.array([x, forward, height])
                angles = legs.joint_angles(np.tile(offset, (len(robot.legs), 1)))
                for leg, joints in enumerate(angles, start=1):
                    trouble = _trouble(joints)
                    if trouble:
                        raise Unreachable(
                            f"leg {leg} cannot reach cell {cell} ({grid.name(cell)}){why}: "
                            f"{trouble}; choose a smaller grid_side_m than {grid.side_m:g}, a "
                            "lower step_height_m, or other link lengths, home radius or body height"
                        )


def _trouble(joints: FloatArray) -> str:
    if np.isnan(joints).any():
        return "it is out of the reach of its links"
    for (name, (low, high)), angle in zip(JOINT_LIMITS_RAD.items(), joints, strict=True):
        if not low <= angle <= high:
            return f"its {name} would turn to {np.rad2deg(angle):.0f}°, beyond its limit"
    return ""
