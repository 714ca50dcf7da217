"""Fields of the page's editor of bodies: numbers of a robot, with their names and limits."""

from collections.abc import Mapping
from typing import Annotated

from annotated_types import Ge, Le

from hexapods.domain.robot import PLACED_RANGES, RANGES, Robot, legs_written_out, written_out
from hexapods.domain.settings import DeclaredSetting, Setting, declare

_LEG = {
    "x_m": Setting(
        title="To the right",
        help="Where its coxa joint is on the torso, from the middle.",
        unit="m",
    ),
    "y_m": Setting(title="Ahead", help="Likewise, along the robot’s way.", unit="m"),
    "yaw_deg": Setting(
        title="Points to", help="0° is to the right, 90° ahead, ±180° to the left.", unit="°"
    ),
    "foot_out_m": Setting(
        title="Foot from joint", help="From the coxa joint to the foot at home.", unit="m"
    ),
    "coxa_m": Setting(title="Coxa", help="Length of the link at the torso.", unit="m"),
    "femur_m": Setting(title="Femur", help="Length of the link in the middle.", unit="m"),
    "tibia_m": Setting(title="Tibia", help="Length of the link down to the foot.", unit="m"),
}
_TORSO = {
    "torso_radius_m": Setting(title="Radius", help="Of a round torso.", unit="m"),
    "torso_length_m": Setting(title="Length", help="Of the torso, along the body.", unit="m"),
    "torso_width_m": Setting(title="Width", help="Of the torso, across the body.", unit="m"),
    "body_height_m": Setting(
        title="Height", help="Of the torso’s middle above the feet’s centres.", unit="m"
    ),
}


def leg_fields() -> dict[str, DeclaredSetting]:
    """Return the numbers of a leg that the editor offers; by default those of the hexapod."""
    return _declared(_LEG, PLACED_RANGES, legs_written_out(Robot())[0])


def torso_fields() -> dict[str, DeclaredSetting]:
    """Return those of the rest of the robot; the hexapod's torso as a box has its diameter."""
    robot = Robot()
    half_x, half_y = robot.torso_half_sides_m
    box = {"torso_length_m": 2 * half_y, "torso_width_m": 2 * half_x}
    return _declared(_TORSO, RANGES, written_out(robot) | box)


def _declared(
    about: Mapping[str, Setting],
    ranges: Mapping[str, tuple[float, float]],
    defaults: Mapping[str, float | None],
) -> dict[str, DeclaredSetting]:
    return {
        name: declare(
            name,
            Annotated[float, Ge(ranges[name][0]), Le(ranges[name][1]), setting],
            defaults[name],
        )
        for name, setting in about.items()
    }
