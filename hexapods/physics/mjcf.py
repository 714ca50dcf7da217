"""Build a MuJoCo model from a `Robot`: a torso with a copy of one leg at each mount."""

from functools import lru_cache, singledispatch

import mujoco
import numpy as np

from hexapods.assets import models_dir
from hexapods.domain.disturbances import Payload
from hexapods.domain.kinematics import JOINT_LIMITS_RAD
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import Robot
from hexapods.domain.world import UNDISTURBED, World
from hexapods.physics.conditions import apply_conditions, set_servo
from hexapods.physics.model_spec import model_spec

VISIBLE_GROUP = 1
"""The group of the visual geoms."""
_UNPAINTED = ("servo", "hip", "knee", "belly", "deck", "foot", "bracket")
"""Substrings of the names of geoms that are not painted in the agent's colour."""


@lru_cache(maxsize=32)
def compile_visual_model(robot: Robot) -> mujoco.MjModel:
    """Compile the model of a robot as it is drawn, upright over the origin; cached, read-only.

    Naming scheme: body, joint and actuator `leg1_femur`, geom `leg1_foot`.
    """
    return robot_spec(robot).compile()


def compile_model(
    robot: Robot, conditions: World = UNDISTURBED, forward_deg: float = 90.0
) -> mujoco.MjModel:
    """Compile the model that is simulated, without geoms that are only drawn; cached, read-only.

    All models of a robot have states of the same layout, whatever the conditions.

    Args:
        robot: the robot.
        conditions: the disturbances of a step, a result of `World.as_of`.
        forward_deg: azimuth of the gait's forward direction in the body frame, for a payload.
    """
    is_loaded = conditions.one_of(Payload) is not None
    return _compile_model(robot, conditions, forward_deg if is_loaded else 90.0)


@lru_cache(maxsize=64)
def _compile_model(robot: Robot, conditions: World, forward_deg: float) -> mujoco.MjModel:
    spec = robot_spec(robot)
    for geom in spec.geoms:
        if geom.contype == 0 and geom.conaffinity == 0:  # those that are only drawn
            spec.delete(geom)
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    apply_conditions(spec, robot, conditions, forward_deg)
    return spec.compile()


@singledispatch
def robot_spec(robot: Robot) -> mujoco.MjSpec:
    """Build the robot as an editable model specification.

    A kind of robot with other legs registers its own function. Bodies, joints and actuators have
    the labels of the joints (`hexapods.domain.legs`), the geom of a foot is `leg1_foot`.
    """
    spec = mujoco.MjSpec.from_file(str(models_dir() / "torso.xml"))
    spec.option.timestep = robot.dt_s
    torso = spec.body("torso")
    torso.pos = [0, 0, robot.body_height_m + robot.foot_radius_m]
    _shape_torso(spec, robot)
    for number, mount in enumerate(robot.legs, start=1):
        azimuth, yaw = np.deg2rad(mount.azimuth_deg), np.deg2rad(mount.direction_deg)
        frame = torso.add_frame(
            pos=[mount.radius_m * np.cos(azimuth), mount.radius_m * np.sin(azimuth), mount.z_m],
            quat=[np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)],
        )
        spec.attach(_leg_spec(robot, number), prefix=f"leg{number}_", frame=frame)
    return spec


@robot_spec.register
def _(robot: ModelRobot) -> mujoco.MjSpec:
    return model_spec(robot, mujoco.MjSpec.from_file(str(models_dir() / "torso.xml")))


def is_painted(robot: Robot, geom_name: str) -> bool:
    """Return whether a visual geom is painted in the agent's colour; of files' robots the torso."""
    if isinstance(robot, ModelRobot):
        return geom_name.startswith("torso")
    return not any(unpainted in geom_name for unpainted in _UNPAINTED)


def _shape_torso(spec: mujoco.MjSpec, robot: Robot) -> None:
    """Scale every geom of the torso file to the robot's size; cylinders may become boxes."""
    drawn = spec.geom("torso")
    radius, half_height = drawn.size[:2]
    wide, long = (half / radius for half in robot.torso_half_sides_m)
    high = robot.torso_half_height_m / half_height
    for geom in spec.body("torso").geoms:
        if geom.type == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            geom.size = geom.size * [wide, long, high]
        elif robot.torso_length_m is None:
            geom.size = geom.size * [wide, high, 1]
        else:
            geom.type = mujoco.mjtGeom.mjGEOM_BOX
            geom.size = geom.size[[0, 0, 1]] * [wide, long, high]
        geom.pos = geom.pos * [wide, long, high]
    spec.geom("torso").mass = robot.torso_kg
    _set_friction(spec.geom("torso"), robot)


def _leg_spec(robot: Robot, number: int) -> mujoco.MjSpec:
    """Build a leg, counted from 1, with its lengths, masses, servos and friction."""

    def dimension(name: str) -> float:
        return robot.of_legs(name)[number - 1]

    spec = mujoco.MjSpec.from_file(str(models_dir() / "leg.xml"))
    ends = {"coxa": "femur", "femur": "tibia", "tibia": "foot"}
    for link, end_name in ends.items():
        length = dimension(f"{link}_m")
        end = spec.body(end_name)
        _stretch(spec.body(link), length / end.pos[0])
        end.pos = [length, 0, 0]
        spec.geom(link).mass = dimension(f"{link}_kg")
        _set_friction(spec.geom(link), robot)
        joint, servo = spec.joint(link), spec.actuator(link)
        joint.armature, joint.range = robot.joint_armature, JOINT_LIMITS_RAD[link]
        joint.damping = np.array([robot.joint_damping, 0, 0])[: np.size(joint.damping)]
        set_servo(servo, robot.servo_of(number, link))
    foot = spec.geom("foot")
    foot.mass, foot.size = dimension("foot_kg"), [robot.foot_radius_m, 0, 0]
    _set_friction(foot, robot)
    return spec


def _set_friction(geom: mujoco.MjsGeom, robot: Robot) -> None:
    geom.friction = [robot.friction, *geom.friction[1:]]


def _stretch(body: mujoco.MjsBody, factor: float) -> None:
    """Scale a link's geoms along its x axis; their thickness does not change."""
    for geom in body.geoms:
        geom.pos = geom.pos * [factor, 1, 1]
        if np.isfinite(geom.fromto[0]):
            geom.fromto = geom.fromto * [factor, 1, 1, factor, 1, 1]
