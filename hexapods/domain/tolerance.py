"""Build tolerance: a robot as it was built, which differs a little from the robot as designed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import AZIMUTH, RANGES, LegMount, Robot

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
    factors = {name: 1 + share * deviation for name, deviation in zip(VARIED, drawn, strict=False)}
    legs = tuple(
        _as_built(leg, factors, share * apart_deg * off)
        for leg, off in zip(robot.legs, drawn[len(VARIED) :], strict=True)
    )
    return replace(robot, legs=legs, **own)


def _as_built(leg: LegMount, factors: Mapping[str, float], off_deg: float) -> LegMount:
    """Return a leg whose own numbers deviate as the robot's do, mounted at another angle."""
    angles = {"azimuth_deg": leg.azimuth_deg, "yaw_deg": leg.yaw_deg}
    turned = {n: _within(at + off_deg, AZIMUTH) for n, at in angles.items() if at is not None}
    own = {name: getattr(leg, name, None) for name in factors}
    varied = {n: _within(v * factors[n], RANGES[n]) for n, v in own.items() if v is not None}
    return replace(leg, **turned, **varied)


def _within(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])
