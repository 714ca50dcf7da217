"""Robots that are built in: the paper's hexapod, creatures with other legs, and real kits.

Legs are numbered anticlockwise from the front right one; body y points forward. Fields that a
creature leaves out are those of the paper's hexapod. Kits have the dimensions, masses and servos
that their makers state, and swing in the time that their servos take at 70 % of their speed. The
description names the values that were guessed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from hexapods.domain.body import LegMount, Robot, ring
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec, read_gait, resolve


@dataclass(frozen=True)
class Creature:
    """A robot that is built in.

    Attributes:
        robot: the robot.
        gait: one that suits it.
        title: its name on the page.
        description: one sentence, and another that names guessed values.
    """

    robot: Robot
    gait: str | GaitSpec
    title: str
    description: str


def at(x_m: float, y_m: float, yaw_deg: float, foot_out_m: float, **dimensions: float) -> LegMount:
    """Return a leg by the place of its coxa joint in the body frame."""
    azimuth_deg, radius_m = math.degrees(math.atan2(y_m, x_m)), math.hypot(x_m, y_m)
    return LegMount(azimuth_deg, radius_m, yaw_deg=yaw_deg, foot_out_m=foot_out_m, **dimensions)


def both_sides(right: Sequence[LegMount]) -> tuple[LegMount, ...]:
    """Return the legs of a symmetric body, from those on its right from front to back."""
    left = [
        replace(leg, azimuth_deg=180 - leg.azimuth_deg, yaw_deg=180 - leg.direction_deg)
        for leg in right
    ]
    return right[0], *left, *right[:0:-1]


def _kit(name: str, mass_kg: float, legs: tuple[LegMount, ...], **dimensions: Any) -> Robot:
    """Return a kit of this total mass: the torso has what remains beside the legs."""
    robot = Robot(name=name, legs=legs, **dimensions)
    per_leg_kg = robot.coxa_kg + robot.femur_kg + robot.tibia_kg + robot.foot_kg
    return replace(robot, torso_kg=mass_kg - len(legs) * per_leg_kg)


def _servo(stall_nm: float, speed_deg_s: float) -> dict[str, float]:
    """Return gains and damping of a hobby servo by its stall torque and no-load speed.

    It has its stall torque at an error of 0.05 rad; its damping is what limits its speed.
    """
    kp = stall_nm / 0.05
    return {
        "servo_torque_nm": stall_nm,
        "servo_kp": kp,
        "servo_kv": 0.025 * kp,
        "joint_damping": stall_nm / math.radians(speed_deg_s),
    }


CREATURES: dict[str, Creature] = {
    "stiff": Creature(
        Robot(),
        "left-right-origin",
        "Stiff",
        "Strong servos on a floor with grip: they hold the body level.",
    ),
    "compliant": Creature(
        Robot(name="compliant", servo_kp=10.0, servo_kv=0.5),
        "left-right-origin",
        "Compliant",
        "Weak servos: the body sags and pitches under its own weight.",
    ),
    "slippery": Creature(
        Robot(name="slippery", friction=0.1),
        "left-right-origin",
        "Slippery",
        "Feet that slide on the floor.",
    ),
    "ant": Creature(
        Robot(
            name="ant",
            legs=both_sides(
                [
                    at(0.045, 0.06, 50, 0.14),
                    at(0.05, 0.0, 0, 0.15),
                    at(0.045, -0.06, -50, 0.17, femur_m=0.09, tibia_m=0.15),
                ]
            ),
            torso_length_m=0.18,
            torso_width_m=0.08,
            torso_kg=0.9,
        ),
        "tripod",
        "Ant",
        "Six legs on a slender body; the hind ones are longer.",
    ),
    "crab": Creature(
        Robot(
            name="crab",
            legs=(
                at(0.04, 0.07, 85, 0.15),
                at(-0.04, 0.07, 95, 0.15),
                at(-0.12, 0.06, 110, 0.15),
                at(-0.12, -0.06, 250, 0.15),
                at(-0.04, -0.07, 265, 0.15),
                at(0.04, -0.07, 275, 0.15),
                at(0.12, -0.06, 290, 0.15),
                at(0.12, 0.06, 70, 0.15),
            ),
            torso_length_m=0.12,
            torso_width_m=0.28,
            torso_kg=1.6,
        ),
        "tetrapod",
        "Crab",
        "Eight legs; it walks sideways, four legs ahead and four behind.",
    ),
    "spider": Creature(
        Robot(
            name="spider",
            legs=both_sides(
                [
                    at(0.05, 0.07, 60, 0.19),
                    at(0.07, 0.025, 20, 0.19),
                    at(0.07, -0.025, -20, 0.19),
                    at(0.05, -0.07, -60, 0.19),
                ]
            ),
            torso_length_m=0.18,
            torso_width_m=0.12,
            femur_m=0.11,
            tibia_m=0.16,
            body_height_m=0.10,
        ),
        "tetrapod",
        "Spider",
        "Eight long legs, four of which stand.",
    ),
    "starfish": Creature(
        Robot(name="starfish", legs=ring(5)),
        GaitSpec(1, 2, groups=((1, 3), (2, 5), (4,))),
        "Starfish",
        "Five legs in a ring: no two halves of them are alike.",
    ),
    "dog": Creature(
        Robot(
            name="dog",
            legs=both_sides([at(0.06, 0.11, 20, 0.12), at(0.06, -0.11, -20, 0.12)]),
            torso_length_m=0.26,
            torso_width_m=0.11,
            torso_half_height_m=0.03,
            body_height_m=0.12,
        ),
        "trot",
        "Dog",
        "Four legs on a long body: it trots, two legs in the air.",
    ),
    "centipede": Creature(
        Robot(
            name="centipede",
            legs=both_sides([at(0.05, 0.25 - 0.1 * n, 0, 0.15) for n in range(6)]),
            torso_length_m=0.58,
            torso_width_m=0.08,
            torso_half_height_m=0.015,
        ),
        "trot",
        "Centipede",
        "Twelve legs on a long body, every other one in the air.",
    ),
    "freenove": Creature(
        _kit(
            "freenove",
            2.0,
            both_sides(
                [at(0.055, 0.076, 54, 0.14), at(0.085, 0.0, 0, 0.14), at(0.055, -0.076, -54, 0.14)]
            ),
            coxa_m=0.033,
            femur_m=0.09,
            tibia_m=0.11,
            home_radius_m=0.24,
            body_height_m=0.039,
            torso_radius_m=0.095,
            swing_s=0.308,
            **_servo(0.92, 353),
        ),
        "tripod",
        "Freenove big hexapod",
        "A kit with MG996R servos. Guessed: its mass, and torque and speed of the servos.",
    ),
    "phantomx": Creature(
        _kit(
            "phantomx",
            3.22,
            both_sides(
                [at(0.065, 0.125, 45, 0.14), at(0.1, 0.0, 0, 0.14), at(0.065, -0.125, -45, 0.14)]
            ),
            coxa_m=0.0529,
            femur_m=0.0618,
            tibia_m=0.131,
            home_radius_m=0.24,
            body_height_m=0.105,
            torso_length_m=0.26,
            torso_width_m=0.16,
            # The servos' compliance as they are shipped.
            servo_kp=9.0,
            servo_kv=0.45,
            swing_s=0.396,
        ),
        "tripod",
        "PhantomX Mk4",
        "A kit with AX-12A servos. Guessed: how high it stands.",
    ),
    "chica": Creature(
        _kit(
            "chica",
            2.25,
            both_sides(
                [
                    at(0.063, 0.0835, 45, 0.1385),
                    at(0.0815, 0.0, 0, 0.1385),
                    at(0.063, -0.0835, -45, 0.1385),
                ]
            ),
            coxa_m=0.043,
            femur_m=0.08,
            tibia_m=0.134,
            home_radius_m=0.22,
            body_height_m=0.07,
            torso_length_m=0.18,
            torso_width_m=0.14,
            swing_s=0.34,
            **_servo(1.96, 400),
        ),
        "tripod",
        "Chica",
        "MakeYourPet's kit with DS3218 servos. Guessed: torque and speed of the servos.",
    ),
}
"""Robots that are built in, by name."""
PRESETS: dict[str, Robot] = {name: creature.robot for name, creature in CREATURES.items()}


def own_gait(robot: Robot) -> str | GaitSpec:
    """Return the gait that suits a robot; `one-by-one` if none is known for its number of legs."""
    if robot.document is not None:
        gait = None if robot.document.gait is None else read_gait(robot.document.gait)
        return "one-by-one" if gait is None or not _divides(gait, robot) else gait
    preset = CREATURES.get(robot.name.removesuffix(" (modified)"))
    if preset is None or len(preset.robot.legs) != len(robot.legs):
        return "one-by-one"
    return preset.gait


def _divides(gait: str | GaitSpec, robot: Robot) -> bool:
    try:
        resolve(gait, robot.azimuths_deg)
    except InvalidInput:
        return False
    return True
