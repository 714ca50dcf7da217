"""The interface of a robot's legs: their joints and masses, and the kinematics of their feet.

No other module depends on how many joints a leg has, on their names, or on how they move the foot.
Two kinds implement it: `hexapods.domain.kinematics`, and `hexapods.domain.chains` for any chain.
Which legs move together is a matter of the gait (`hexapods.domain.gait`).
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import Gait
from hexapods.domain.posture import rotation_matrices
from hexapods.domain.types import FloatArray, IntArray


class Joint(NamedTuple):
    """A joint of a leg, which one servo turns."""

    leg: int
    """Number of the leg, from 1."""
    name: str
    """Name of the joint and of the link that it moves; unique in the leg."""
    limits_rad: tuple[float, float]

    @property
    def label(self) -> str:
        """Name of the joint among the joints of all legs, such as `leg1_coxa`."""
        return f"leg{self.leg}_{self.name}"


class Legs(ABC):
    """Legs of one robot: their joints, their masses, and the kinematics of their feet.

    Attributes:
        joints: joints of all legs, in the order of poses, servo commands and torques: leg by leg.
        masses_kg: mass of each leg with its foot.
        limits_rad: lowest and highest angles of all joints, (2, joints).
        leg_of_joint: index of each joint's leg, from 0, (joints,).
        follows_grid: for each leg whether its foot can go to any place near home; the foot of a
            leg of two joints goes to the nearest place that it reaches.
    """

    def __init__(self, joints: Iterable[Joint], masses_kg: Sequence[float]) -> None:
        self.joints, self.masses_kg = tuple(joints), tuple(masses_kg)
        self.limits_rad: FloatArray = np.array([joint.limits_rad for joint in self.joints]).T
        self.leg_of_joint: IntArray = np.array([joint.leg - 1 for joint in self.joints])
        self.follows_grid: tuple[bool, ...] = (True,) * len(self.masses_kg)

    def __len__(self) -> int:
        """Number of legs."""
        return len(self.masses_kg)

    @property
    def pose_size(self) -> int:
        """Length of a pose: torso position, its rotation (wxyz), and the angles of all joints."""
        return 7 + len(self.joints)

    def of_leg(self, leg: int) -> list[Joint]:
        """Return the joints of a leg, counted from 1, from the torso to the foot."""
        return [joint for joint in self.joints if joint.leg == leg]

    def index(self, leg: int, name: str) -> int:
        """Return the index of a joint in `joints`; legs count from 1.

        Raises:
            InvalidInput: if there is no such joint.
        """
        for number, joint in enumerate(self.joints):
            if (joint.leg, joint.name) == (leg, name):
                return number
        names = ", ".join(joint.name for joint in self.of_leg(leg))
        raise InvalidInput(f"leg {leg} has no joint {name}; its joints are: {names or 'none'}")

    def foot_positions(self, poses: FloatArray) -> FloatArray:
        """Compute the forward kinematics of many poses, in the world.

        Args:
            poses: torso position [m], rotation (wxyz) and joint angles [rad], (k, 7 + joints).

        Returns:
            (k, legs, 3), the centres of the feet [m].
        """
        feet = self.feet_in_body(poses[:, 7:])
        turned: FloatArray = np.einsum("kij,klj->kli", rotation_matrices(poses), feet)
        return poses[:, None, :3] + turned

    @abstractmethod
    def feet_in_body(self, angles: FloatArray) -> FloatArray:
        """Return the centres of the feet in the body frame, (k, legs, 3) [m].

        Args:
            angles: angles of all joints, (k, joints) [rad].
        """

    @abstractmethod
    def links_in_body(self, angles: Sequence[float]) -> list[FloatArray]:
        """Return the positions of each leg's joints and foot in the body frame, proximal to distal.

        Args:
            angles: angles of all joints in one pose [rad].

        Returns:
            For each leg (its joints + 1, 3) [m].
        """

    @abstractmethod
    def under(self, gait: Gait) -> "FootKinematics":
        """Return the kinematics of the feet in the robot frame of a gait."""


class FootKinematics(ABC):
    """Kinematics of legs in the robot frame of one gait: x right, y forward, z up.

    Feet are given as offsets from their home positions. All operations are elementwise, so that
    results do not depend on the batch size.

    Attributes:
        legs: the legs.
        homes_m: home positions of the feet, (legs, 2).
        frames: parameters of each leg for `solve`, (..., legs).
        is_costly: whether `solve` takes so long that a step's joint targets are interpolated
            between a few of its places.
    """

    legs: Legs
    homes_m: FloatArray
    frames: FloatArray
    is_costly: bool = False

    @abstractmethod
    def mirrored(self, signs: FloatArray) -> FloatArray:
        """Return `frames` for feet whose x is multiplied by their legs' signs, 1 or −1, (legs,)."""

    @abstractmethod
    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        """Compute the inverse kinematics of any feet.

        As few NumPy calls as possible, since every training step pays their overhead.

        Args:
            places: offsets from home to the right and forward [m], (2, ...).
            heights: heights above the ground [m]; broadcasts with `places`.
            frames: parameters of each foot's leg, as `frames` with feet in place of legs.

        Returns:
            (..., most joints of a leg) [rad], from the torso to the foot; NaN with a NumPy warning
            where a foot is out of reach, which `check_reach` rules out beforehand.
        """

    @abstractmethod
    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        """Compute the forward kinematics of one pose, the inverse of `joint_angles`.

        In plain floats, which are faster than arrays for the legs of one pose.

        Args:
            angles: angles of all joints [rad].

        Returns:
            For each leg (x, y, z), its foot's offset from home [m].
        """

    def joint_angles(self, offsets: FloatArray) -> FloatArray:
        """Compute the inverse kinematics of all feet.

        Args:
            offsets: offsets of the feet from home, (..., legs, 3) [m].

        Returns:
            (..., joints) [rad]; NaN where a foot is out of reach.
        """
        x, y, z = np.ascontiguousarray(np.moveaxis(offsets, -1, 0))
        *inner, legs = self.frames.shape
        frames = self.frames.reshape(*inner, *(1 for _ in offsets.shape[:-2]), legs)
        with np.errstate(invalid="ignore"):
            return self.in_pose_order(self.solve(np.array((x, y)), z, frames))

    def in_pose_order(self, angles: FloatArray) -> FloatArray:
        """Return the angles of all joints, (..., joints), from those by leg, (..., legs, most)."""
        *batch, legs, most = angles.shape
        if legs * most == len(self.legs.joints):
            return angles.reshape(*batch, -1)
        place = np.concatenate([np.arange(len(self.legs.of_leg(leg + 1))) for leg in range(legs)])
        return angles[..., self.legs.leg_of_joint, place]
