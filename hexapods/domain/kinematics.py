"""The one kind of leg that there is, of three joints: coxa (yaw), femur and tibia (pitch).

The foot lies in the vertical plane that the coxa turns; in that plane femur and tibia are a
two-link arm with the knee above. Positive pitch lifts.
"""

import math
from collections.abc import Sequence
from functools import lru_cache, singledispatch
from typing import Any

import numpy as np

from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.legs import FootKinematics, Joint, Legs
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray

JOINT_LIMITS_RAD = {"coxa": (-1.2, 1.2), "femur": (-1.4, 1.9), "tibia": (-2.8, 0.0)}
"""Joint limits (low, high), used by the model's joint ranges and by `check_reach`."""


class _CoxaFemurTibia(Legs):
    def __init__(self, robot: Robot) -> None:
        mass_kg = robot.coxa_kg + robot.femur_kg + robot.tibia_kg + robot.foot_kg
        super().__init__(
            [
                Joint(leg, name, limits)
                for leg in range(1, len(robot.legs) + 1)
                for name, limits in JOINT_LIMITS_RAD.items()
            ],
            [mass_kg] * len(robot.legs),
        )
        self._robot = robot

    def feet_in_body(self, angles: FloatArray) -> FloatArray:
        robot = self._robot
        coxa, femur, tibia = np.moveaxis(angles.reshape(len(angles), -1, 3), -1, 0)
        along, across, height = _foot(robot, coxa, femur, tibia, np)
        azimuth = np.deg2rad(robot.azimuths_deg)
        along = along + np.array([leg.radius_m for leg in robot.legs])
        cos, sin = np.cos(azimuth), np.sin(azimuth)
        return np.stack([along * cos - across * sin, along * sin + across * cos, height], axis=-1)

    def under(self, gait: Gait) -> FootKinematics:
        return _CoxaFemurTibiaKinematics(self, self._robot, gait)


class _CoxaFemurTibiaKinematics(FootKinematics):
    def __init__(self, legs: Legs, robot: Robot, gait: Gait) -> None:
        self.legs, self._robot = legs, robot
        azimuth = np.deg2rad(gait.azimuths_deg)
        mounts = np.array([leg.radius_m for leg in robot.legs])
        sin, cos = np.sin(azimuth), np.cos(azimuth)
        self.homes_m = robot.home_radius_m * np.stack([-sin, cos], axis=1)
        home = robot.home_radius_m - mounts
        self.frames = np.array([(home, 0 * home), (-sin, -cos), (cos, -sin)])
        """Affine map from the robot frame to each leg's frame, (3, 2, legs): home's position from
        the coxa joint [m], the coefficients of x, the coefficients of y; each along the leg, and
        across."""
        self._numbers = [frame.ravel().tolist() for frame in np.moveaxis(self.frames, -1, 0)]

    def mirrored(self, signs: FloatArray) -> FloatArray:
        frames = self.frames.copy()
        frames[1] *= signs
        return frames

    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        # Coordinates are separate contiguous arrays: NumPy's loops over strided arrays are slower,
        # and may differ in the last bit.
        home, of_x, of_y = frames
        feet = home + (of_x * places[0] + of_y * places[1])  # (2, ...): along the leg, across
        squares = feet * feet
        r = np.sqrt(squares[0] + squares[1]) - self._robot.coxa_m
        fall = heights - self._robot.body_height_m
        femur, tibia = self._robot.femur_m, self._robot.tibia_m
        bend = (r * r + fall * fall - (femur * femur + tibia * tibia)) / (2 * femur * tibia)
        drop = np.sqrt(1 - bend * bend)
        angles = np.empty((*r.shape, 3))
        angles[..., 0] = np.arctan2(feet[1], feet[0])
        angles[..., 1] = np.arctan2(fall, r) + np.arctan2(tibia * drop, femur + tibia * bend)
        angles[..., 2] = -np.arctan2(drop, bend)
        return angles

    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        robot, offsets = self._robot, []
        for leg, (home, _, x_along, x_across, y_along, y_across) in enumerate(self._numbers):
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


_coxa_femur_tibia = lru_cache(maxsize=64)(_CoxaFemurTibia)


@singledispatch
def legs_of(robot: Robot) -> Legs:
    """Return the legs of a robot. A kind of robot with other legs registers its own function."""
    return _coxa_femur_tibia(robot)


@lru_cache(maxsize=64)
def check_reach(robot: Robot, gait: Gait, grid: FootGrid) -> None:
    """Check that every foot offset that can occur is within each leg's reach and joint limits.

    A foot's actual forward offset drifts as the body re-centres. With G groups it stays strictly
    within (G − 1) h of home, since the offsets sum to zero and each was last commanded to within
    h (half the grid's side). Cached, since every run of an experiment asks it again.

    Raises:
        Unreachable: naming the leg and the cell.
    """
    legs, drift = legs_of(robot), len(gait.groups) - 1
    kinematics = legs.under(gait)
    for cell, (x, y) in enumerate(grid.cells):
        passages = (
            ("", y),
            (" after the body has re-centred", drift * y),
            (" on the way there", 0.0),
        )
        for why, forward in passages:
            for height in (0.0, robot.step_height_m):
                offset = np.array([x, forward, height])
                problem = _reach_problem(
                    legs, kinematics.joint_angles(np.tile(offset, (len(legs), 1)))
                )
                if problem:
                    leg, reason = problem
                    raise Unreachable(
                        f"leg {leg} cannot reach cell {cell} ({grid.name(cell)}){why}: "
                        f"{reason}; choose a smaller grid_side_m than {grid.side_m:g}, a "
                        "lower step_height_m, or other link lengths, home radius or body height"
                    )


def _reach_problem(legs: Legs, angles: FloatArray) -> tuple[int, str] | None:
    """Return the first leg that cannot have these joint angles, (joints,), and why."""
    low, high = legs.limits_rad
    is_possible = (low <= angles) & (angles <= high)
    if is_possible.all():
        return None
    first = int(is_possible.argmin())
    joint = legs.joints[first]
    if np.isnan(angles[legs.leg_of_joint == joint.leg - 1]).any():
        return joint.leg, "it is out of the reach of its links"
    turned = np.rad2deg(angles[first])
    return joint.leg, f"its {joint.name} would turn to {turned:.0f}°, beyond its limit"
