"""Models of robots for tests: a built-in one as if it had been read from a file, and chains."""

import math
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, get_args

import mujoco
import numpy as np

from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.robot_model import (
    GeomKind,
    ModelFoot,
    ModelGeom,
    ModelJoint,
    ModelLink,
    ModelMesh,
    RobotModel,
)
from hexapods.exports.robot_model import home_angles_rad
from hexapods.physics.mjcf import compile_model

_UNTURNED = (1.0, 0.0, 0.0, 0.0)
_OTHER_NAMES = {"coxa": "hip", "femur": "thigh", "tibia": "knee"}


def model_of(robot: Robot) -> RobotModel:
    """Return a built-in robot as if it had been read from a file; its joints have other names."""
    compiled, legs = compile_model(robot), legs_of(robot)
    home = home_angles_rad(robot)
    links, feet = list[ModelLink](), list[ModelFoot]()
    for body in range(1, compiled.nbody):
        name = compiled.body(body).name
        leg = int(name.partition("_")[0].removeprefix("leg")) if name.startswith("leg") else 0
        joint = None
        if compiled.body_jntnum[body] and leg:
            number = int(compiled.body_jntadr[body])
            index = number - 1
            joint_of_robot, servo = legs.joints[index], robot.servo_of(leg, legs.joints[index].name)
            joint = ModelJoint(
                name=_OTHER_NAMES[joint_of_robot.name],
                axis=_floats(compiled.jnt_axis[number]),
                anchor_m=_floats(compiled.jnt_pos[number]),
                limits_rad=joint_of_robot.limits_rad,
                home_rad=float(home[index]),
                servo_kp=servo.kp,
                servo_kv=servo.kv,
                servo_torque_nm=servo.torque_nm,
                armature=robot.joint_armature,
                damping=robot.joint_damping,
            )
        geoms = [
            geom
            for geom in range(compiled.ngeom)
            if compiled.geom_bodyid[geom] == body and not compiled.geom(geom).name.endswith("_foot")
        ]
        links.append(
            ModelLink(
                name=name,
                parent=int(compiled.body_parentid[body]) - 1,
                leg=leg,
                at_m=_floats(compiled.body_pos[body]) if body > 1 else (0.0, 0.0, 0.0),
                wxyz=_floats(compiled.body_quat[body]) if body > 1 else _UNTURNED,
                mass_kg=float(compiled.body_mass[body]),
                center_m=_floats(compiled.body_ipos[body]),
                inertia=_inertia(compiled, body),
                joint=joint,
                geoms=tuple(_geom(compiled, geom) for geom in geoms),
            )
        )
        if name.endswith("_foot"):
            feet.append(ModelFoot(len(links) - 1, (0.0, 0.0, 0.0), robot.foot_radius_m))
    return RobotModel(tuple(links), tuple(feet))


def _floats(numbers: Any) -> Any:
    return tuple(float(number) for number in numbers)


def _inertia(compiled: mujoco.MjModel, body: int) -> Any:
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, compiled.body_iquat[body])
    turn = flat.reshape(3, 3)
    full = turn @ np.diag(compiled.body_inertia[body]) @ turn.T
    return _floats(full[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])


def _geom(compiled: mujoco.MjModel, geom: int) -> ModelGeom:
    kinds = {getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}"): kind for kind in get_args(GeomKind)}
    return ModelGeom(
        kinds[mujoco.mjtGeom(int(compiled.geom_type[geom]))],
        _floats(compiled.geom_size[geom]),
        _floats(compiled.geom_pos[geom]),
        _floats(compiled.geom_quat[geom]),
    )


class Hinge(NamedTuple):
    """A joint of a leg of the right side, and the link to the next one, in the body frame.

    Attributes:
        name: of the joint.
        axis: unit vector while the robot stands.
        link_m: from this joint to the next one, or to the foot, while the robot stands.
    """

    name: str
    axis: tuple[float, float, float]
    link_m: tuple[float, float, float]


class LegPlan(NamedTuple):
    """A leg: where its first joint is in the body frame [m], and its hinges outward."""

    at_m: tuple[float, float, float]
    hinges: Sequence[Hinge]


def leg_on_the_left(leg: LegPlan) -> LegPlan:
    """Return the mirror image of a leg."""
    x, y, z = leg.at_m
    return LegPlan(
        (-x, y, z),
        [
            Hinge(name, (axis[0], -axis[1], -axis[2]), (-link[0], link[1], link[2]))
            for name, axis, link in leg.hinges
        ],
    )


def model_of_legs(
    legs: Sequence[LegPlan],
    *,
    torso_kg: float = 6.0,
    half_torso_m: tuple[float, float, float] = (0.1, 0.2, 0.05),
    link_kg: float = 0.3,
    torque_nm: float = 25.0,
    foot_radius_m: float = 0.02,
) -> RobotModel:
    """Return a model whose frames are all like the body's while all joints are at 0.

    Legs must be numbered anticlockwise from the front right one.
    """
    box = ModelGeom("box", half_torso_m, (0.0, 0.0, 0.0), _UNTURNED)
    torso = ModelLink(
        "torso", -1, 0, (0.0, 0.0, 0.0), _UNTURNED, torso_kg, (0.0, 0.0, 0.0),
        _inertia_of_box(torso_kg, half_torso_m), geoms=(box,),
    )  # fmt: skip
    links, feet = [torso], []
    for number, leg in enumerate(legs, start=1):
        at_m, parent = leg.at_m, 0
        for hinge in leg.hinges:
            radius = foot_radius_m * 0.8
            joint = ModelJoint(
                hinge.name, hinge.axis, (0.0, 0.0, 0.0), (-2.5, 2.5), 0.0,
                20 * torque_nm, 0.5 * torque_nm, torque_nm, 0.001 * torque_nm, 0.02 * torque_nm,
            )  # fmt: skip
            middle = _floats(coordinate / 2 for coordinate in hinge.link_m)
            half = [max(abs(coordinate) / 2, radius) for coordinate in hinge.link_m]
            links.append(
                ModelLink(
                    f"leg {number} {hinge.name}",
                    parent,
                    number,
                    at_m,
                    _UNTURNED,
                    link_kg,
                    middle,
                    _inertia_of_box(link_kg, half),
                    joint,
                    (_capsule(hinge.link_m, radius),),
                )
            )
            at_m, parent = hinge.link_m, len(links) - 1
        feet.append(ModelFoot(parent, at_m, foot_radius_m))
    return RobotModel(tuple(links), tuple(feet))


def _inertia_of_box(
    kg: float, half_m: Sequence[float]
) -> tuple[float, float, float, float, float, float]:
    x, y, z = (half * half for half in half_m)
    return kg / 3 * (y + z), kg / 3 * (x + z), kg / 3 * (x + y), 0.0, 0.0, 0.0


def _capsule(along_m: Sequence[float], radius_m: float) -> ModelGeom:
    length = math.hypot(*along_m)
    x, y, z = (coordinate / length for coordinate in along_m)
    turned = np.array([1 + z, -y, x, 0.0]) if z > -1 + 1e-9 else np.array([0.0, 1.0, 0.0, 0.0])
    return ModelGeom(
        "capsule",
        (radius_m, length / 2, 0.0),
        _floats(coordinate / 2 for coordinate in along_m),
        _floats(turned / np.linalg.norm(turned)),
    )


_DOG = [
    Hinge("hip", (0.0, 1.0, 0.0), (0.08, 0.0, 0.0)),
    Hinge("thigh", (1.0, 0.0, 0.0), (0.0, -0.12, -0.18)),
    Hinge("knee", (1.0, 0.0, 0.0), (0.0, 0.12, -0.18)),
]
_FOUR = [
    Hinge("coxa", (0.0, 0.0, 1.0), (0.05, 0.0, 0.0)),
    Hinge("femur", (0.0, -1.0, 0.0), (0.08, 0.0, 0.05)),
    Hinge("tibia", (0.0, -1.0, 0.0), (0.05, 0.0, -0.08)),
    Hinge("tarsus", (0.0, -1.0, 0.0), (0.02, 0.0, -0.09)),
]
_TWO = [
    Hinge("hip", (0.0, 0.0, 1.0), (0.1, 0.0, 0.02)),
    Hinge("ankle", (0.0, -1.0, 0.0), (0.1, 0.0, -0.17)),
]
_SIX = [
    Hinge("yaw", (0.0, 0.0, 1.0), (0.04, 0.0, 0.0)),
    Hinge("roll", (0.0, 1.0, 0.0), (0.03, 0.0, 0.0)),
    Hinge("pitch", (0.0, -1.0, 0.0), (0.08, 0.0, 0.06)),
    Hinge("twist", (0.8, 0.0, 0.6), (0.03, 0.0, -0.04)),
    Hinge("knee", (0.0, -1.0, 0.0), (0.03, 0.0, -0.08)),
    Hinge("ankle", (0.6, -0.8, 0.0), (0.01, 0.0, -0.06)),
]


def _around(right: Sequence[LegPlan]) -> list[LegPlan]:
    """Return the legs of both sides, from those on the right from front to back."""
    return [right[0], *map(leg_on_the_left, right), *right[:0:-1]]


def quadruped_model() -> RobotModel:
    """Return a dog of 14 kg whose feet are under its hips: three joints a leg."""
    return model_of_legs(_around([LegPlan((0.05, y, 0.0), _DOG) for y in (0.19, -0.19)]))


def four_joint_model() -> RobotModel:
    """Return a hexapod with four joints a leg."""
    right = [LegPlan((0.1, y, 0.0), _FOUR) for y in (0.12, 0.0, -0.12)]
    return model_of_legs(
        _around(right), torso_kg=1.5, link_kg=0.04, torque_nm=2.5, foot_radius_m=0.012,
        half_torso_m=(0.08, 0.16, 0.02),
    )  # fmt: skip


def two_joint_model() -> RobotModel:
    """Return a quadruped with two joints a leg, like an ant of gymnasia."""
    legs = [_turned(LegPlan((0.1, 0.0, 0.0), _TWO), degrees) for degrees in (45, 135, 225, 315)]
    return model_of_legs(
        legs, torso_kg=2.0, link_kg=0.1, torque_nm=8.0, half_torso_m=(0.1, 0.1, 0.03)
    )


def mixed_model() -> RobotModel:
    """Return a hexapod whose legs have two to six joints."""
    plans = (_FOUR, _SIX, _DOG_OUT, _FOUR, _SIX, _DOG_OUT)
    legs = [
        _turned(LegPlan((0.12, 0.0, 0.0), plan), degrees)
        for plan, degrees in zip(plans, (30, 90, 150, 210, 270, 330), strict=True)
    ]
    return model_of_legs(
        legs, torso_kg=1.5, link_kg=0.04, torque_nm=2.5, foot_radius_m=0.012,
        half_torso_m=(0.1, 0.1, 0.02),
    )  # fmt: skip


_DOG_OUT = [
    Hinge("coxa", (0.0, 0.0, 1.0), (0.05, 0.0, 0.0)),
    Hinge("femur", (0.0, -1.0, 0.0), (0.08, 0.0, 0.04)),
    Hinge("tibia", (0.0, -1.0, 0.0), (0.06, 0.0, -0.16)),
]


def _turned(leg: LegPlan, degrees: float) -> LegPlan:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def turn(vector: Sequence[float]) -> Any:
        x, y, z = vector
        return x * cos - y * sin, x * sin + y * cos, z

    return LegPlan(
        turn(leg.at_m),
        [Hinge(name, turn(axis), turn(link)) for name, axis, link in leg.hinges],
    )


def with_limits(model: RobotModel, leg: int, limits_rad: tuple[float, float]) -> RobotModel:
    """Return a model whose joints of a leg have other limits."""
    links = tuple(
        replace(link, joint=replace(link.joint, limits_rad=limits_rad))
        if link.leg == leg and link.joint is not None
        else link
        for link in model.links
    )
    return replace(model, links=links)


def mesh_of(vertices: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]) -> ModelMesh:
    """Return a mesh of vertices [m] and triangles."""
    points, triangles = np.array(vertices, "<f4"), np.array(faces, "<u4")
    return ModelMesh(
        b64encode(points.tobytes()).decode(), b64encode(triangles.tobytes()).decode(), len(faces)
    )


def wedge(x_m: float, y_m: float, z_m: float) -> ModelMesh:
    """Return a tetrahedron with three right angles."""
    corners = [(0.0, 0.0, 0.0), (x_m, 0.0, 0.0), (0.0, y_m, 0.0), (0.0, 0.0, z_m)]
    return mesh_of(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def with_meshes(model: RobotModel) -> RobotModel:
    """Return a model whose torso and second link of every leg have a mesh of their own."""
    links, seen = list(model.links), dict[int, int]()
    for number, link in enumerate(links):
        seen[link.leg] = seen.get(link.leg, 0) + 1
        if number == 0:
            links[number] = replace(link, mesh=wedge(0.1, 0.3, 0.05))
        elif link.leg and seen[link.leg] == 2:
            links[number] = replace(link, mesh=wedge(0.02, 0.03, -0.2))
    return replace(model, links=tuple(links))


def gait_of(robot: Robot) -> str:
    """Return a gait of two groups for a robot with four or six legs."""
    return {4: "trot", 6: "tripod"}[len(robot.legs)]
