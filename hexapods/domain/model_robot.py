"""Robots from files: a `Robot` whose fields are derived from a `RobotModel`."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from statistics import fmean
from typing import Any, ClassVar

import numpy as np

from hexapods.domain.body import LegMount, Robot, ServoStrength
from hexapods.domain.model_geometry import (
    Chain,
    LinkFrame,
    home_angles,
    leg_chains,
    link_frames,
    quaternion_matrix,
)
from hexapods.domain.robot_model import ModelGeom, ModelJoint, RobotModel
from hexapods.domain.short_repr import short_repr
from hexapods.domain.sums import ordered_sum

_SERVO = ("servo_kp", "servo_kv", "servo_torque_nm")
_USUAL_LEG_M = math.hypot(0.15, 0.09)
"""Distance from the coxa joint to the foot of the paper's hexapod; times and heights are scaled by
the length of a leg relative to it."""
_STEP_HEIGHT_SHARE = 0.15
"""Step height, as a share of the length of a leg."""
_LONGEST_SWING_S = 0.17
"""Longest swing of a robot that stands on two legs meanwhile: with a longer one many fell."""
_MOST_OF_HEIGHT = 0.8
"""Half the torso's height at most, as a share of the height of its centre over the ground."""
_STIFF = 1.0
"""Largest product of time step and frequency of a servo with its rotor alone."""


@dataclass(frozen=True)
class ModelRobot(Robot):
    """A robot from a file.

    Its lengths and masses are those of its model, from which `model_robot` derives all fields;
    an input may change the fields in `changeable`. Fields of links that only the closed form of
    legs has, such as `coxa_m`, mean nothing here. Servo fields are the largest of all joints: a
    change scales every joint. Feet at home stand on one plane, at the mean of their heights in
    the file.
    """

    __repr__ = short_repr

    changeable: ClassVar[tuple[str, ...]] = (
        *_SERVO,
        "friction",
        "step_height_m",
        "swing_s",
        "shift_s",
        "dt_s",
    )
    """Names of the fields that an input may change."""

    model: RobotModel = field(kw_only=True)

    def servo_of(self, leg: int, joint: str) -> ServoStrength:
        joints = {model_joint.name: model_joint for model_joint in self.model.joints_of(leg)}
        return ServoStrength(
            *(
                getattr(joints[joint], name) * (getattr(self, name) / largest)
                for name, largest in zip(_SERVO, self._largest, strict=True)
            )
        )

    @cached_property
    def _largest(self) -> tuple[float, ...]:
        return _largest_of(_joints(self.model))

    @property
    def foot_radii_m(self) -> tuple[float, ...]:
        return tuple(foot.radius_m for foot in self.model.feet)

    @property
    def feet_out_m(self) -> tuple[float, ...]:
        return tuple(leg.foot_out_m or 0.0 for leg in self.legs)

    @cached_property
    def _homes_m(self) -> list[tuple[float, float]]:
        chains = leg_chains(self.model, home_angles(self.model))
        return [(float(chain.foot_m[0]), float(chain.foot_m[1])) for chain in chains]

    @property
    def homes_m(self) -> list[tuple[float, float]]:
        return list(self._homes_m)

    @property
    def span_m(self) -> float:
        return max(math.hypot(x, y) for x, y in self._homes_m)

    def _check_legs(self) -> None:
        """Skip the checks of legs that are made from numbers: here feet may be under hips."""


def model_robot(model: RobotModel, name: str, **changes: float) -> ModelRobot:
    """Return a robot from its model.

    Step height and times are those of the paper's hexapod, scaled by the size of the legs.

    Args:
        model: the model.
        name: name of the robot.
        changes: values of fields in `ModelRobot.changeable`.

    Raises:
        InvalidInput: if a number is out of range.
    """
    angles = home_angles(model)
    chains, frames = leg_chains(model, angles), link_frames(model, angles)
    joints, leg_m = _joints(model), leg_length_m(chains)
    foot_radius_m = fmean(foot.radius_m for foot in model.feet)
    ground_m = fmean(
        chain.foot_m[2] - foot.radius_m for chain, foot in zip(chains, model.feet, strict=True)
    )
    half_x, half_y, half_z = torso_half_size_m(model, frames, -ground_m)
    slowness = math.sqrt(leg_m / _USUAL_LEG_M)
    swing_s = min(max(0.2 * slowness, 0.1), 0.5)
    if len(model.feet) <= 4:
        swing_s = min(swing_s, _LONGEST_SWING_S)
    adjustable: dict[str, Any] = {
        "step_height_m": _STEP_HEIGHT_SHARE * leg_m,
        "swing_s": swing_s,
        "shift_s": min(max(0.12 * slowness, 0.06), 0.3),
        "dt_s": _time_step_s(joints),
        **dict(zip(_SERVO, _largest_of(joints), strict=True)),
        **changes,
    }
    return ModelRobot(
        name=name,
        model=model,
        legs=tuple(map(_mount, chains)),
        torso_radius_m=max(half_x, half_y),
        torso_half_height_m=half_z,
        torso_length_m=2 * half_y,
        torso_width_m=2 * half_x,
        torso_kg=ordered_sum(link.mass_kg for link in model.links_of(0)),
        home_radius_m=max(fmean(math.hypot(*chain.foot_m[:2]) for chain in chains), 0.01),
        body_height_m=max(-ground_m - foot_radius_m, 0.001),
        foot_radius_m=foot_radius_m,
        joint_armature=max(joint.armature for joint in joints),
        joint_damping=max(*(joint.damping for joint in joints), 1e-4),
        **adjustable,
    )


def torso_half_size_m(
    model: RobotModel, frames: Sequence[LinkFrame], standing_m: float
) -> tuple[float, float, float]:
    """Return half the size of the box about the torso's centre that holds its geoms [m].

    Links that are fixed to it, such as an arm, are left out. A torso without geoms has the box that
    holds the mounts of its legs. Its bottom is over the ground while the robot stands.

    Args:
        model: the model.
        frames: frames of its links.
        standing_m: height of the torso's centre over the ground while it stands.
    """
    torso, frame = model.links[0], frames[0]
    corners = [
        np.abs(frame.point(geom.at_m)) + geom_half_size_m(geom, frame) for geom in torso.geoms
    ]
    if not corners:
        chains = leg_chains(model, home_angles(model))
        corners = [np.abs(chain.anchors_m[0]) for chain in chains]
    x, y, z = np.max(corners, axis=0).tolist()
    return max(x, 0.01), max(y, 0.01), max(min(z, _MOST_OF_HEIGHT * standing_m), 0.002)


def geom_half_size_m(geom: ModelGeom, frame: LinkFrame) -> Any:
    """Return half the size of the box along the body's axes that holds a geom, (3,) [m]."""
    first, second, third = geom.size_m
    sizes = {
        "sphere": (first, first, first),
        "capsule": (first, first, first + second),
        "cylinder": (first, first, second),
        "ellipsoid": (first, second, third),
        "box": (first, second, third),
    }
    return np.abs(frame.rotation @ quaternion_matrix(geom.wxyz)) @ np.array(sizes[geom.kind])


def _joints(model: RobotModel) -> list[ModelJoint]:
    return [link.joint for link in model.links if link.joint is not None]


def _largest_of(joints: Sequence[ModelJoint]) -> tuple[float, ...]:
    return tuple(max(getattr(joint, name) for joint in joints) for name in _SERVO)


def leg_length_m(chains: Sequence[Chain]) -> float:
    """Return the mean distance of the feet at home from the first joints of their legs [m]."""
    return fmean(float(np.linalg.norm(chain.foot_m - chain.anchors_m[0])) for chain in chains)


def _time_step_s(joints: Sequence[ModelJoint]) -> float:
    """Return the largest usual time step at which the stiffest servo is followed [s]."""
    fastest = max(math.sqrt(joint.servo_kp / joint.armature) for joint in joints)
    return next((dt_s for dt_s in (0.004, 0.002) if fastest * dt_s <= _STIFF), 0.001)


def _mount(chain: Chain) -> LegMount:
    """Return the mount of a leg; angles are rounded, so that mirrored legs have mirrored angles."""
    x, y, z = chain.anchors_m[0].tolist()
    out_x, out_y = (chain.foot_m - chain.anchors_m[0])[:2].tolist()
    azimuth_deg = round(math.degrees(math.atan2(y, x)), 6)
    out_m = math.hypot(out_x, out_y)
    yaw_deg = round(math.degrees(math.atan2(out_y, out_x)), 6) if out_m > 1e-6 else azimuth_deg
    return LegMount(azimuth_deg, math.hypot(x, y), z_m=z, yaw_deg=yaw_deg, foot_out_m=out_m)
