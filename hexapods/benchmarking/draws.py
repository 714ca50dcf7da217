"""Bodies and damages that a seed draws, for tasks that no agent could be made for."""

from typing import Any

import numpy as np

from hexapods.domain.body import LegMount, Robot
from hexapods.domain.disturbances import Disturbance, Limp, Lost, Stuck, Weak
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import PAPER_GAITS, GaitSpec, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach
from hexapods.domain.support import STANDS_M, Support
from hexapods.domain.world import World

_LEGS, _GROUPS = (6, 8), 3
_OFF_DEG = 8.0
"""Largest angle between a leg of a drawn body and its place in a regular ring [°]."""
_SCALED = ("coxa_m", "femur_m", "tibia_m", "torso_kg", "femur_kg", "tibia_kg", "servo_kp")
_SCALES = (0.8, 1.3)
_FRICTION = (0.5, 1.0)
_STUCK_RAD = (-0.9, 0.3)
_TORQUE_SHARE = (0.2, 0.5)


def drawn_body(rng: np.random.Generator) -> tuple[Robot, GaitSpec]:
    """Draw a body of 6 to 8 legs, and a gait that moves them in three groups.

    Lengths, masses and servos are scaled by 0.8 to 1.3, each leg is turned by up to 8° from its
    place in a regular ring, and the friction is from 0.5 to 1. A body whose legs do not reach the
    usual foot grid, or which would tip over in its gait, is drawn again.

    Args:
        rng: the generator.
    """
    while True:
        count = int(rng.integers(_LEGS[0], _LEGS[1] + 1))
        off_deg = rng.uniform(-_OFF_DEG, _OFF_DEG, count).tolist()
        scales = rng.uniform(*_SCALES, len(_SCALED)).tolist()
        friction = round(float(rng.uniform(*_FRICTION)), 3)
        order = rng.permutation(count) + 1
        usual = Robot()
        dimensions: dict[str, Any] = {
            name: round(getattr(usual, name) * scale, 4)
            for name, scale in zip(_SCALED, scales, strict=True)
        }
        legs = tuple(LegMount(round(360 * leg / count + off, 2)) for leg, off in enumerate(off_deg))
        groups = tuple(tuple(sorted(group.tolist())) for group in np.array_split(order, _GROUPS))
        gait = GaitSpec(1, 2, groups=groups)
        try:
            robot = Robot(name="drawn body", legs=legs, friction=friction, **dimensions)
            resolved = resolve(gait, robot.azimuths_deg)
            check_reach(robot, resolved, FootGrid())
        except InvalidInput:
            continue
        if Support(robot, resolved).least_margin_m(resolved.groups) > STANDS_M:
            return robot, gait


def drawn_damage(rng: np.random.Generator) -> tuple[World, str]:
    """Draw a damage of one leg of the hexapod, limp, lost, weak or stuck, and a gait of the paper.

    Args:
        rng: the generator.
    """
    gait = list(PAPER_GAITS)[int(rng.integers(len(PAPER_GAITS)))]
    leg = int(rng.integers(1, 7))
    angle_rad = round(float(rng.uniform(*_STUCK_RAD)), 2)
    torque_share = round(float(rng.uniform(*_TORQUE_SHARE)), 2)
    damages: tuple[Disturbance, ...] = (
        Limp(legs=(leg,)),
        Lost(legs=(leg,)),
        Weak(legs=(leg, leg % 6 + 1), torque_share=torque_share),
        Stuck(leg=leg, joint="femur", angle_rad=angle_rad),
    )
    return World((damages[int(rng.integers(len(damages)))],)), gait
