"""Build tolerance: a robot as it was built, which differs a little from the robot as designed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.model_geometry import turned_mounts
from hexapods.domain.model_robot import ModelRobot
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
VARIED_OF_MODELS = ("torso_kg", "legs_kg", "servo_kp", "servo_kv", "friction")
"""Quantities that vary of a robot from a file: masses of torso and links, gains, friction."""
_FULL_TURN_DEG = 360.0


def build_tolerance(robot: Robot, share: float, rng: np.random.Generator) -> Robot:
    """Draw a robot as it could be built: each value uniformly within a share of its design.

    Each leg is mounted at its own angle, which is off by up to that share of the angle between two
    neighbouring legs. Values stay within `RANGES`. Controller and sensors use the kinematics of the
    robot as designed, as those of a real robot do, so that the built one reaches the same foot
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
    names = VARIED_OF_MODELS if isinstance(robot, ModelRobot) else VARIED
    drawn = rng.uniform(-1, 1, len(names) + len(robot.legs)).tolist()
    if share == 0:
        return robot
    if isinstance(robot, ModelRobot):
        model_factors = [1 + share * deviation for deviation in drawn[: len(names)]]
        turn_deg = share * _FULL_TURN_DEG / len(robot.legs)
        turns_deg = [turn_deg * deviation for deviation in drawn[len(names) :]]
        return _model_as_built(robot, model_factors, turns_deg)
    varied: dict[str, Any] = {
        name: _within(getattr(robot, name) * (1 + share * deviation), RANGES[name])
        for name, deviation in zip(VARIED, drawn, strict=False)
    }
    apart_deg = _FULL_TURN_DEG / len(robot.legs)
    factors = {name: 1 + share * deviation for name, deviation in zip(VARIED, drawn, strict=False)}
    legs = tuple(
        _as_built(leg, factors, share * apart_deg * deviation)
        for leg, deviation in zip(robot.legs, drawn[len(VARIED) :], strict=True)
    )
    return replace(robot, legs=legs, **varied)


def _model_as_built(
    robot: ModelRobot, factors: Sequence[float], turns_deg: Sequence[float]
) -> ModelRobot:
    """Return a robot from a file that deviates.

    Args:
        robot: the robot as designed.
        factors: factor of each quantity of `VARIED_OF_MODELS`.
        turns_deg: angle by which each leg is turned about the vertical through its first joint.
    """
    torso, legs, kp, kv, friction = factors
    links = []
    for link in turned_mounts(robot.model, turns_deg).links:
        factor = legs if link.leg else torso
        xx, yy, zz, xy, xz, yz = (factor * moment for moment in link.inertia)
        varied_link = replace(link, mass_kg=factor * link.mass_kg, inertia=(xx, yy, zz, xy, xz, yz))
        links.append(varied_link)
    return replace(
        robot,
        model=replace(robot.model, links=tuple(links)),
        torso_kg=torso * robot.torso_kg,
        servo_kp=kp * robot.servo_kp,
        servo_kv=kv * robot.servo_kv,
        friction=_within(friction * robot.friction, RANGES["friction"]),
    )


def _as_built(leg: LegMount, factors: Mapping[str, float], turn_deg: float) -> LegMount:
    """Return a leg whose own numbers deviate as the robot's do, mounted at another angle."""
    angles = {"azimuth_deg": leg.azimuth_deg, "yaw_deg": leg.yaw_deg}
    turned = {
        name: _within(angle + turn_deg, AZIMUTH)
        for name, angle in angles.items()
        if angle is not None
    }
    overrides = {name: getattr(leg, name, None) for name in factors}
    varied = {
        name: _within(value * factors[name], RANGES[name])
        for name, value in overrides.items()
        if value is not None
    }
    return replace(leg, **turned, **varied)


def _within(value: float, limits: tuple[float, float]) -> float:
    return min(max(value, limits[0]), limits[1])
