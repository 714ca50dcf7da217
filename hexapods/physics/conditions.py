"""Effects of a world on a MuJoCo model: servos, legs, ground, gravity and payload.

No joint is added or removed, so that a state of one model continues in another. Sensor noise, delay
and dead band do not change a model.
"""

from collections.abc import Sequence
from functools import singledispatch
from typing import NamedTuple

import mujoco
import numpy as np

from hexapods.domain.body import ServoStrength
from hexapods.domain.disturbances import (
    Disturbance,
    Friction,
    Limp,
    Lost,
    Patch,
    Payload,
    Rough,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.terrain import ROUGH_CELL_M, ROUGH_PERIOD_M, rough_heights
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World

_NO_KG = 1e-6
"""Mass of each geom of a lost leg; MuJoCo refuses 0."""
_NO_INERTIA = 1e-9
"""Moments of inertia of a lost leg's bodies that have their own [kg·m²]."""
_NO_TORQUE_NM = 1e-9
_GROUND_HALF_WIDTH_M = 50.0
_GROUND_END_M = 2000.0
"""Ground with patches is made of boxes, from here behind the start to here before it."""
_ROUGH_BASE_M = 0.1
_ROUGH_MARGIN_M = 0.64
"""Ground beyond the square, for legs of a robot near its edge; more for larger robots."""


def apply_conditions(
    spec: mujoco.MjSpec, robot: Robot, conditions: World, forward_deg: float
) -> None:
    """Apply the disturbances of a step to a robot's specification.

    Args:
        spec: the specification that `mjcf.robot_spec` returned.
        robot: its robot.
        conditions: a result of `World.as_of`.
        forward_deg: azimuth of the gait's forward direction in the body frame.
    """
    # All geoms are there before their friction is set, and a jammed servo has its power back last.
    later = (Friction, Stuck)
    for disturbance in sorted(conditions.disturbances, key=lambda entry: isinstance(entry, later)):
        _apply(disturbance, _Target(spec, robot, forward_deg))
    patches = sorted(conditions.all_of(Patch), key=lambda patch: patch.from_m)
    if patches:
        _lay_patches(spec, patches)


class _Target(NamedTuple):
    """The specification that is changed, its robot, and its gait's forward direction."""

    spec: mujoco.MjSpec
    robot: Robot
    forward_deg: float


@singledispatch
def _apply(disturbance: Disturbance, target: _Target) -> None:
    """Change the specification; sensor noise, delay and dead band change nothing."""


@_apply.register
def _limp(limp: Limp, target: _Target) -> None:
    for leg in limp.legs:
        _cut_power(target, leg)


@_apply.register
def _lost(lost: Lost, target: _Target) -> None:
    """Make legs weightless and let nothing touch them; their joints stay in the state."""
    for leg in lost.legs:
        _cut_power(target, leg)
        for body in target.spec.bodies:
            if body.name.startswith(f"leg{leg}_"):
                _make_weightless(body)


def _make_weightless(body: mujoco.MjsBody) -> None:
    """Set the masses of a body and its geoms, and its own inertia if it has one, to nearly zero."""
    if body.explicitinertial:
        body.mass, body.inertia, body.iquat = _NO_KG, [_NO_INERTIA] * 3, [1, 0, 0, 0]
        body.fullinertia = [np.nan] * 6
    for geom in body.geoms:
        if geom.contype:
            geom.contype = 0
            if not body.explicitinertial:
                geom.mass = _NO_KG


@_apply.register
def _weak(weak: Weak, target: _Target) -> None:
    for leg in weak.legs:
        for servo in _servos(target, leg):
            servo.forcerange = np.array(servo.forcerange) * weak.torque_share


@_apply.register
def _stuck(stuck: Stuck, target: _Target) -> None:
    """Let the servo hold the joint with all its torque, even without power: it is jammed."""
    legs = legs_of(target.robot)
    servo = target.spec.actuator(legs.joints[legs.index(stuck.leg, stuck.joint)].label)
    set_servo(servo, target.robot.servo_of(stuck.leg, stuck.joint))


def set_servo(servo: mujoco.MjsActuator, gains: ServoStrength) -> None:
    """Give an actuator the gains and the torque of a position servo."""
    servo.gainprm[0] = gains.kp
    servo.biasprm[1:3] = -gains.kp, -gains.kv
    servo.forcerange = [-gains.torque_nm, gains.torque_nm]


@_apply.register
def _friction(friction: Friction, target: _Target) -> None:
    for geom in target.spec.geoms:
        if geom.contype:
            geom.friction = [friction.value, *geom.friction[1:]]


@_apply.register
def _slope(slope: Slope, target: _Target) -> None:
    """Tilt gravity: the world's frame is that of the ground."""
    option = target.spec.option
    angle, strength = np.deg2rad(slope.degrees), np.linalg.norm(option.gravity)
    x, y = -np.sin(angle) * direction(slope.direction_deg)
    option.gravity = np.array([x, y, -np.cos(angle)]) * strength


@_apply.register
def _rough(rough: Rough, target: _Target) -> None:
    """Replace the plane by a height field over one period and a margin around it."""
    if rough.amplitude_m == 0:
        return
    heights = rough_heights(rough)
    margin_m = max(_ROUGH_MARGIN_M, 2 * target.robot.span_m)
    margin = round(margin_m / ROUGH_CELL_M)
    half = heights.shape[0] // 2
    # Row and column 0 of a period lie at the origin.
    index = np.arange(-half - margin, half + margin + 1) % heights.shape[0]
    field = heights[np.ix_(index, index)]
    radius = ROUGH_PERIOD_M / 2 + margin * ROUGH_CELL_M
    target.spec.add_hfield(
        name="rough",
        size=[radius, radius, rough.amplitude_m, _ROUGH_BASE_M],
        nrow=len(index),
        ncol=len(index),
        userdata=(field / rough.amplitude_m).ravel().tolist(),
    )
    ground = target.spec.geom("ground")
    ground.type, ground.hfieldname = mujoco.mjtGeom.mjGEOM_HFIELD, "rough"


@_apply.register
def _payload(payload: Payload, target: _Target) -> None:
    if payload.kg == 0:
        return
    half, carrier = payload_half_side_m(payload.kg), target.spec.body("torso")
    if carrier.explicitinertial:  # such a body does not get heavier by a geom
        carrier = carrier.add_body(name="payload")
    carrier.add_geom(
        name="payload",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[half] * 3,
        pos=payload_center_m(payload, target.robot, target.forward_deg),
        mass=payload.kg,
        priority=1,
        friction=[target.robot.friction, 0.005, 0.0001],
        contype=1,
        conaffinity=0,
    )


def direction(degrees: float) -> FloatArray:
    """Return the horizontal unit vector (x, y) of a direction, anticlockwise from the track."""
    angle = np.deg2rad(degrees)
    return np.array([-np.sin(angle), np.cos(angle)])


def _lay_patches(spec: mujoco.MjSpec, patches: Sequence[Patch]) -> None:
    """Replace the plane by boxes of one height: the patches, and the ground between them.

    Patches on top of the plane would be steps of as much as feet sink into the ground.
    """
    plane, behind_m = spec.geom("ground"), -_GROUND_END_M
    plane.conaffinity = 0
    for number, patch in enumerate(patches):
        if patch.from_m > behind_m:
            _add_strip(spec, f"ground{number}", behind_m, patch.from_m)
        strip = _add_strip(spec, f"patch{number}", patch.from_m, patch.to_m)
        strip.friction = [patch.friction, *strip.friction[1:]]
        strip.priority = 2  # its friction counts, not that of the feet
        behind_m = patch.to_m
    _add_strip(spec, "ground", behind_m, _GROUND_END_M)


def _add_strip(spec: mujoco.MjSpec, name: str, from_m: float, to_m: float) -> mujoco.MjsGeom:
    half, depth = (to_m - from_m) / 2, 0.5
    return spec.worldbody.add_geom(
        name=f"strip_{name}",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[_GROUND_HALF_WIDTH_M, half, depth],
        pos=[0, from_m + half, -depth],
        contype=0,
        conaffinity=1,
    )


def _servos(target: _Target, leg: int) -> list[mujoco.MjsActuator]:
    return [target.spec.actuator(joint.label) for joint in legs_of(target.robot).of_leg(leg)]


def _cut_power(target: _Target, leg: int) -> None:
    for servo in _servos(target, leg):
        servo.gainprm[0] = 0
        servo.biasprm[1:3] = 0, 0
        servo.forcerange = [-_NO_TORQUE_NM, _NO_TORQUE_NM]


def payload_half_side_m(kg: float) -> float:
    """Return half the side of a cube of this mass with the density of steel [m]."""
    return float((kg / 7800) ** (1 / 3) / 2)


def payload_center_m(payload: Payload, robot: Robot, forward_deg: float) -> FloatArray:
    """Return the centre of a payload's cube, which lies on the torso, in its frame, (3,) [m].

    Args:
        payload: the payload.
        robot: its robot.
        forward_deg: azimuth of the gait's forward direction in the body frame.
    """
    forward = np.deg2rad(forward_deg)
    ahead = np.array([np.cos(forward), np.sin(forward)])
    right = np.array([ahead[1], -ahead[0]])
    x, y = payload.x_m * right + payload.y_m * ahead
    return np.array([x, y, robot.torso_half_height_m + payload_half_side_m(payload.kg)])
