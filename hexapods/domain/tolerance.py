"""Build tolerance: a robot as it was built, which differs a little from the robot as designed."""

from dataclasses import replace
from typing import Any

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import AZIMUTH, RANGES, Robot

MAX_TOLERANCE = 0.2
VARIED = (
    "coxa_m",
    "femur_m",
    "tibia_m",
    "torso_kg",
    "coxa_kg",
    "femur_kg",
    "tibia_kg",
    "foot_kg",
    "servo_kp",
    "servo_kv",
    "friction",
)
"""Fields of a robot that vary: lengths of links, masses, servo gains, friction."""
_FULL_TURN_DEG = 360.0


def build_tolerance(robot: Robot, share: float, rng: np.random.Generator) -> Robot:
    """Draw a robot as it could be built: each value uniformly within a share of its design.

    Each leg is mounted at its own angle, which is off by up to that share of the angle between two
    neighbouring legs. Values stay within `RANGES`. The robot's controller and its sensors count on
    the robot as designed (as every real one's do), so that the built one reaches the same foot
    grid: it is commanded the same joint angles, within the same limits.

    Args:
        robot: the robot as designed.
        share: largest relative deviation, 0 to `MAX_TOLERANCE`; 0 returns the robot itself.
        rng: the generator; as many numbers are drawn whatever the share.

    Raises:
        InvalidInput: if the share is out of its limits.
    """
    if not 0 <= share <= MAX_TOLERANCE:
        raise InvalidInput(f"tolerance must be from 0 to {MAX_TOLERANCE:g}, not {share}")
    drawn = rng.uniform(-1, 1, len(VARIED) + len(robot.legs)).tolist()
    if share == 0:
        return robot
    own: dict[str, Any] = {
        name: _within(getattr(robot, name) * (1 + share * deviation), RANGES[name])
        for name, deviation in zip(VARIED, drawn, strict=False)
    }
    apart_deg = _FULL_TURN_DEG / len(robot.legs)
    legs = tuple(
        replace(leg, azimuth_deg=_within(leg.azimuth_deg + share * apart_deg * off, AZIMUTH))
        for leg, off in zip(robot.legs, drawn[len(VARIED) :], strict=True)
    )
    return replace(robot, legs=legs, **own)


def _within(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])
