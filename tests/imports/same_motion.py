"""Compares a `RobotModel` with the file that it was read from, by MuJoCo's own kinematics."""

import mujoco
import numpy as np

from hexapods.domain.robot_model import RobotModel
from hexapods.domain.types import FloatArray
from hexapods.imports.imported import ImportedRobot


def turn(axis: FloatArray, angle: float) -> FloatArray:
    matrix, quaternion = np.empty(9), np.empty(4)
    mujoco.mju_axisAngle2Quat(quaternion, np.array(axis, dtype=float), angle)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def rotation(quaternion: tuple[float, ...]) -> FloatArray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(quaternion))
    return matrix.reshape(3, 3)


def posed(
    model: RobotModel, angles: dict[tuple[int, str], float]
) -> list[tuple[FloatArray, FloatArray]]:
    """Return rotation and origin of each link in the body frame.

    Args:
        model: the robot.
        angles: by leg and name of the joint.
    """
    frames: list[tuple[FloatArray, FloatArray]] = [(np.eye(3), np.zeros(3))]
    for link in model.links[1:]:
        turned, at = frames[link.parent]
        rotation_of_link, origin = turned @ rotation(link.wxyz), at + turned @ link.at_m
        if link.joint is not None:
            by = turn(np.array(link.joint.axis), angles[link.leg, link.joint.name])
            anchor = np.array(link.joint.anchor_m)
            origin = origin + rotation_of_link @ (anchor - by @ anchor)
            rotation_of_link = rotation_of_link @ by
        frames.append((rotation_of_link, origin))
    return frames


def feet_and_center(
    robot: ImportedRobot, angles: dict[tuple[int, str], float]
) -> tuple[FloatArray, FloatArray]:
    """Return the feet, (legs, 3), and the centre of mass, (3,), in the body frame."""
    model = robot.model
    frames = posed(model, angles)
    feet = np.array([frames[f.link][1] + frames[f.link][0] @ f.at_m for f in model.feet])
    masses = np.array([link.mass_kg for link in model.links])
    centers = np.array(
        [
            at + turned @ link.center_m
            for link, (turned, at) in zip(model.links, frames, strict=True)
        ]
    )
    return feet, masses @ centers / masses.sum()


def compare(
    robot: ImportedRobot,
    text: str,
    assets: dict[str, bytes] | None = None,
    *,
    rng: np.random.Generator,
    is_base: str,
    foot_of: dict[str, str],
) -> float:
    """Return the largest deviation of feet and centre of mass in random poses [m].

    Args:
        robot: the robot that was read.
        text: its document, which MuJoCo reads unchanged.
        assets: its meshes.
        rng: generator of the poses.
        is_base: name of the torso's body.
        foot_of: for each foot the name of its geom, by what the import calls it.
    """
    model = mujoco.MjModel.from_xml_string(text, assets or {})
    data = mujoco.MjData(model)
    theta = np.radians(robot.forward_deg)
    axes = np.array(
        [[np.sin(theta), -np.cos(theta), 0], [np.cos(theta), np.sin(theta), 0], [0, 0, 1]]
    )
    worst, offset = 0.0, None
    for _ in range(5):
        angles = {}
        mujoco.mj_resetData(model, data)
        for number, leg in enumerate(robot.legs, start=1):
            for name, joint in zip(leg.joints, robot.model.joints_of(number), strict=True):
                angle = float(rng.uniform(*joint.limits_rad))
                angles[number, joint.name] = angle
                data.joint(name).qpos[0] = angle
        mujoco.mj_forward(model, data)
        root = data.body(is_base)
        feet, center = feet_and_center(robot, angles)
        expected = np.array([data.geom(foot_of[leg.foot]).xpos for leg in robot.legs])
        expected = np.vstack([expected, data.subtree_com[model.body(is_base).id]])
        inside = (expected - root.xpos) @ axes.T
        actual = np.vstack([feet, center])
        # The origins differ by a shift that is always the same.
        offset = (actual - inside).mean(axis=0) if offset is None else offset
        worst = max(worst, float(np.abs(actual - inside - offset).max()))
    return worst
