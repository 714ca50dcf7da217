"""Forward kinematics of a model of a robot in one pose: where its links, joints and feet are."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hexapods.domain.robot_model import Quaternion, RobotModel
from hexapods.domain.types import FloatArray


class Chain(NamedTuple):
    """The joints of a leg and its foot, in the body frame."""

    axes: FloatArray
    """Unit vectors, from the torso outward, (joints, 3)."""
    anchors_m: FloatArray
    """A point on each axis, (joints, 3)."""
    foot_m: FloatArray
    """Centre of the foot, (3,)."""


class LinkFrame(NamedTuple):
    """The frame of a link in the body frame: its rotation (3, 3) and its origin (3,) [m]."""

    rotation: FloatArray
    origin_m: FloatArray

    def point(self, at_m: Sequence[float] | FloatArray) -> FloatArray:
        """Return a point of the link in the body frame."""
        turned: FloatArray = self.rotation @ np.asarray(at_m, float) + self.origin_m
        return turned


def home_angles(model: RobotModel) -> dict[int, list[float]]:
    """Return the angles with which the file has the robot stand, by leg from 1 [rad]."""
    legs = range(1, len(model.feet) + 1)
    return {leg: [joint.home_rad for joint in model.joints_of(leg)] for leg in legs}


def link_frames(model: RobotModel, angles: Mapping[int, Sequence[float]]) -> list[LinkFrame]:
    """Return the frame of each link.

    Args:
        model: the model.
        angles: angles of the joints, by leg from 1 [rad].
    """
    remaining = {leg: list(leg_angles) for leg, leg_angles in angles.items()}
    frames: list[LinkFrame] = []
    for link in model.links:
        frame = LinkFrame(quaternion_matrix(link.wxyz), np.array(link.at_m, float))
        if link.parent >= 0:
            parent = frames[link.parent]
            frame = LinkFrame(parent.rotation @ frame.rotation, parent.point(frame.origin_m))
        if link.joint is not None:
            turn = rotation_about(np.array(link.joint.axis, float), remaining[link.leg].pop(0))
            anchor = np.array(link.joint.anchor_m, float)
            frame = LinkFrame(frame.rotation @ turn, frame.point(anchor - turn @ anchor))
        frames.append(frame)
    return frames


def leg_chains(model: RobotModel, angles: Mapping[int, Sequence[float]]) -> list[Chain]:
    """Return the chain of each leg; arguments as those of `link_frames`."""
    frames = link_frames(model, angles)
    chains = []
    for leg, foot in enumerate(model.feet, start=1):
        moved = [
            (link.joint, frame)
            for link, frame in zip(model.links, frames, strict=True)
            if link.leg == leg and link.joint is not None
        ]
        chains.append(
            Chain(
                np.array([frame.rotation @ np.array(joint.axis) for joint, frame in moved]),
                np.array([frame.point(joint.anchor_m) for joint, frame in moved]),
                frames[foot.link].point(foot.at_m),
            )
        )
    return chains


def turned_mounts(model: RobotModel, by_deg: Sequence[float]) -> RobotModel:
    """Return a model whose legs are turned about the verticals through their first joints [°]."""
    angles = home_angles(model)
    frames = link_frames(model, angles)
    mounts = [chain.anchors_m[0] for chain in leg_chains(model, angles)]
    links = list(model.links)
    for number, link in enumerate(links):
        if not link.leg or links[link.parent].leg:
            continue
        half = np.deg2rad(by_deg[link.leg - 1]) / 2
        parent, mount = frames[link.parent], mounts[link.leg - 1]
        turn = np.array([np.cos(half), 0, 0, np.sin(half)])
        # The turn is about the body's z axis; in the parent's frame that axis is its third row.
        about = np.concatenate((turn[:1], turn[3] * parent.rotation[2]))
        off = parent.point(link.at_m) - mount
        at = parent.rotation.T @ (mount + quaternion_matrix(turn) @ off - parent.origin_m)
        x, y, z = at.tolist()
        links[number] = replace(
            link, at_m=(x, y, z), wxyz=_quaternion_product(about.tolist(), link.wxyz)
        )
    return replace(model, links=tuple(links))


def _quaternion_product(left: Sequence[float], right: Quaternion) -> Quaternion:
    w, x, y, z = left
    a, b, c, d = right
    product = np.array(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    )
    a, b, c, d = (product / np.linalg.norm(product)).tolist()
    return a, b, c, d


def rotation_about(axis: FloatArray, angle_rad: float) -> FloatArray:
    """Return the matrix of a rotation about a unit vector (Rodrigues), (3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: FloatArray = (
        np.eye(3) + np.sin(angle_rad) * cross + (1 - np.cos(angle_rad)) * cross @ cross
    )
    return turned


def quaternion_matrix(wxyz: Sequence[float] | FloatArray) -> FloatArray:
    """Return the matrix of a rotation, (3, 3), from a quaternion that is not quite a unit."""
    w, x, y, z = np.array(wxyz, float) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
