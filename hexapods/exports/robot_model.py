"""Export of a robot as MJCF, the format of MuJoCo's models, in one file."""

import numpy as np

from hexapods.domain.gait import resolve
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_geometry import home_angles
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray
from hexapods.exports.exported_settings import exported_settings
from hexapods.exports.mjcf_text import mjcf_text
from hexapods.imports.exported_pose import HOME_KEY
from hexapods.imports.exported_settings import PREFIX
from hexapods.physics.mjcf import robot_spec

_SAME_RAD = 1e-3


def robot_mjcf(robot: Robot) -> str:
    """Return a robot on flat ground as MJCF without other files.

    The keyframe `home` has it standing with every foot at home, and its servos told to stay so.
    Bodies, joints and actuators have the labels of the joints, such as `leg1_coxa`.
    """
    standing = home_angles_rad(robot)
    height_m = robot.body_height_m + robot.foot_radius_m
    qpos = np.concatenate(([0, 0, height_m, 1, 0, 0, 0], standing))
    settings = {f"{PREFIX}{name}": value for name, value in exported_settings(robot).items()}
    return mjcf_text(robot_spec(robot), robot.name, {HOME_KEY: (qpos, standing)}, settings)


def home_angles_rad(robot: Robot) -> FloatArray:
    """Return the angles of the joints with every foot at home, (joints,) [rad]."""
    # They are the same under any gait, and this one suits any legs.
    gait = resolve("one-by-one", robot.azimuths_deg)
    legs = legs_of(robot)
    angles: FloatArray = legs.under(gait).joint_angles(np.zeros((len(legs), 3)))
    if isinstance(robot, ModelRobot):
        of_model = np.array([angle for leg in home_angles(robot.model).values() for angle in leg])
        # Solved, they differ by what the solver leaves; the model's are the same when read back.
        if np.abs(of_model - angles).max() < _SAME_RAD:
            return of_model
    return angles
