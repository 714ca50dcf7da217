"""Kinematics of one leg as a chain of hinges: product of exponentials, and damped least squares."""

from dataclasses import dataclass

import numpy as np

from hexapods.domain.types import FloatArray

_ROUNDS, _DAMPING, _MOST_RAD = 60, 0.02, 0.3
_DIFFERENCE = 1e-6
PRECISION = 1e-3
"""A foot is in a place if it is as near, as a share of the leg's length."""


@dataclass(frozen=True, eq=False)
class LegChain:
    """A leg in the body frame, all of its angles 0.

    Attributes:
        axes: unit vectors, (joints, 3).
        anchors: points of the axes, (joints, 3) [m].
        foot: centre of the foot, (3,) [m].
        limits: lowest and highest angles, (2, joints) [rad].
    """

    axes: FloatArray
    anchors: FloatArray
    foot: FloatArray
    limits: FloatArray

    @property
    def length_m(self) -> float:
        """Sum of the distances between the joints, and to the foot."""
        return float(np.linalg.norm(np.diff([*self.anchors, self.foot], axis=0), axis=1).sum())

    def feet(self, angles: FloatArray) -> FloatArray:
        """Return the centres of the foot at many angles.

        Args:
            angles: (k, joints) [rad].

        Returns:
            (k, 3) [m].
        """
        places = np.broadcast_to(self.foot, (len(angles), 3))
        for joint in range(len(self.axes))[::-1]:
            axis, anchor = self.axes[joint], self.anchors[joint]
            out = places - anchor
            cos, sin = np.cos(angles[:, joint, None]), np.sin(angles[:, joint, None])
            along = np.outer(out @ axis, axis)
            places = anchor + along + (out - along) * cos + _crossed(axis, out) * sin
        return places

    def knee_heights_m(self, angles: FloatArray) -> FloatArray:
        """Return how high the knee is above the line from the hip to the foot, (k,).

        The hip is the second joint of three or more, which lifts the leg; the knee the joint after
        it that is farthest from the line. Below the line the height is negative.

        Args:
            angles: (k, joints) [rad].
        """
        hip_joint = 1 if len(self.axes) > 2 else 0
        hip = self._joint_at(hip_joint, angles)
        along = self.feet(angles) - hip
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
        heights, farthest = np.zeros(len(angles)), np.zeros(len(angles))
        for joint in range(hip_joint + 1, len(self.axes)):
            out = self._joint_at(joint, angles) - hip
            out = out - (out * along).sum(axis=1, keepdims=True) * along
            off = np.linalg.norm(out, axis=1)
            heights = np.where(off > farthest, out[:, 2], heights)
            farthest = np.maximum(farthest, off)
        return heights

    def _joint_at(self, joint: int, angles: FloatArray) -> FloatArray:
        """Return the places of a joint, (k, 3)."""
        above = LegChain(
            self.axes[:joint], self.anchors[:joint], self.anchors[joint], self.limits[:, :joint]
        )
        return above.feet(angles[:, :joint])

    def jacobians(self, angles: FloatArray) -> FloatArray:
        """Return the derivatives of the foot's place by the angles, (k, 3, joints)."""
        count, joints = angles.shape
        shifts = _DIFFERENCE * np.concatenate([np.eye(joints), -np.eye(joints)])
        near = (angles[:, None] + shifts).reshape(-1, joints)
        feet = self.feet(near).reshape(count, 2, joints, 3)
        return np.moveaxis((feet[:, 0] - feet[:, 1]) / (2 * _DIFFERENCE), 1, 2)

    def slopes(self, angles: FloatArray) -> FloatArray:
        """Return what `jacobians` does from the axes at these angles, faster for many.

        It differs in the last digits.

        Args:
            angles: (k, joints) [rad].
        """
        rotations = np.broadcast_to(np.eye(3), (len(angles), 3, 3))
        moved = np.zeros((len(angles), 3))
        axes, anchors = [], []
        for joint, (axis, anchor) in enumerate(zip(self.axes, self.anchors, strict=True)):
            axes.append(rotations @ axis)
            anchors.append(rotations @ anchor + moved)
            rotations = rotations @ _turned(axis, angles[:, joint])
            moved = anchors[-1] - rotations @ anchor
        foot = rotations @ self.foot + moved
        columns = [
            np.cross(axis, foot - anchor) for axis, anchor in zip(axes, anchors, strict=True)
        ]
        return np.stack(columns, axis=2)

    def solve(
        self, targets: FloatArray, start: FloatArray, weights: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Find angles within the limits at which the foot is in some places.

        Args:
            targets: (k, 3) [m].
            start: angles from which to search, (joints,) [rad].
            weights: of the coordinates, (3,), where a leg cannot reach a place in all of them; by
                default they are alike.

        Returns:
            angles, (k, joints) [rad], and the distances that are left, (k,) [m]; of a place out of
            reach it need not be the least.
        """
        low, high = self.limits
        angles = np.clip(np.tile(start, (len(targets), 1)), low, high)
        damping = (_DAMPING * self.length_m) ** 2 * np.eye(3)
        for round_ in range(_ROUNDS):
            off = targets - self.feet(angles)
            if round_ and np.abs(off).max() < 1e-9:
                break
            jacobians = self.jacobians(angles)
            if weights is not None:
                off, jacobians = off * weights, jacobians * weights[:, None]
            # Less damping near the end, where it only slows down.
            scale = np.minimum(1, np.linalg.norm(off, axis=1) / (0.1 * self.length_m)) ** 2 + 1e-6
            square = jacobians @ jacobians.transpose(0, 2, 1) + scale[:, None, None] * damping
            moves = jacobians.transpose(0, 2, 1) @ np.linalg.solve(square, off[:, :, None])
            angles = np.clip(angles + np.clip(moves[:, :, 0], -_MOST_RAD, _MOST_RAD), low, high)
        return angles, np.linalg.norm(targets - self.feet(angles), axis=1)


def _crossed(axis: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return the cross products of an axis with vectors, (k, 3).

    The same bits as of `np.cross`, which takes most of the time of a search for a stance.
    """
    (a, b, c), (x, y, z) = axis.tolist(), vectors.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)


def _turned(axis: FloatArray, angles: FloatArray) -> FloatArray:
    """Return the rotations about an axis by many angles, (k, 3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sin, cos = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    turned: FloatArray = np.eye(3) + sin * cross + (1 - cos) * (cross @ cross)
    return turned
