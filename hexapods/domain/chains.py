"""Legs that are any chain of hinges, with numeric kinematics (`hexapods.domain.chain_solver`).

A chain with more joints than it needs moves as little as it can from where it stands. A leg of two
joints, or one whose joints move the foot in a surface only, cannot follow a grid: its foot goes to
the nearest place of the right height.
"""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from hexapods.domain.chain_solver import EXACT, NEAR, ChainSolver, FootParameters
from hexapods.domain.errors import ImpossibleLegs
from hexapods.domain.gait import Gait
from hexapods.domain.legs import FootKinematics, Joint, Legs
from hexapods.domain.model_geometry import home_angles, leg_chains
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray

_CHUNK = 1500
"""Feet that are solved at once: their arrays fit into a processor's cache."""
_MAX_CACHED_FEET = 300
"""Largest number of feet whose parameters are cached: those of a step."""


class ChainLegs(Legs):
    """Legs of a robot from a file.

    Attributes:
        standing: joints and foot of each leg while the robot stands.
        standing_rad: angles of all joints then, (joints,).
    """

    def __init__(self, robot: ModelRobot) -> None:
        """Compute the angles with which the robot stands.

        Raises:
            ImpossibleLegs: if a foot does not reach the plane of the other feet.
        """
        model = robot.model
        legs = range(1, len(model.feet) + 1)
        super().__init__(
            [
                Joint(leg, joint.name, joint.limits_rad)
                for leg in legs
                for joint in model.joints_of(leg)
            ],
            [ordered_sum(link.mass_kg for link in model.links_of(leg)) for leg in legs],
        )
        angles = home_angles(model)
        self.standing = leg_chains(model, angles)
        self.standing_rad: FloatArray = np.concatenate([angles[leg] for leg in legs])
        self._stand_level(robot)
        self._solver = ChainSolver(self.standing)
        self.follows_grid = self._solver.follows_grid

    def _stand_level(self, robot: ModelRobot) -> None:
        """Move the feet of the file's stance to the ground on which they stand together."""
        on_ground_m = -robot.body_height_m - robot.foot_radius_m + np.array(robot.foot_radii_m)
        lifts_m = on_ground_m - np.array([chain.foot_m[2] for chain in self.standing])
        if np.abs(lifts_m).max() < 1e-9:
            return
        solver = ChainSolver(self.standing)
        offsets = np.zeros((3, len(self)))
        offsets[2] = lifts_m
        with np.errstate(all="ignore"):
            turned = solver.solve(offsets, solver.parameters_of(solver.parameters))
        for leg, angles in enumerate(turned.tolist(), start=1):
            if not math.isfinite(angles[0]):
                raise ImpossibleLegs(
                    f"the foot of leg {leg} cannot stand on one plane with the others, "
                    f"{1000 * lifts_m[leg - 1]:.0f} mm from where it is at home: choose another "
                    "stance",
                    [leg],
                )
        change = np.concatenate(
            [angles[: len(self.of_leg(leg))] for leg, angles in enumerate(turned, start=1)]
        )
        self.standing_rad = self.standing_rad + change
        by_leg = {leg: self.standing_rad[self.leg_of_joint == leg - 1] for leg in self._numbers}
        self.standing = leg_chains(
            robot.model, {leg: angles.tolist() for leg, angles in by_leg.items()}
        )

    @property
    def _numbers(self) -> range:
        return range(1, len(self) + 1)

    def feet_in_body(self, angles: FloatArray) -> FloatArray:
        return np.moveaxis(self._solver.feet_m(self.turned(angles)), 0, -1)

    def links_in_body(self, angles: Sequence[float]) -> list[FloatArray]:
        turned = self.turned(np.array([angles]))[:, 0]
        places = []
        for leg, chain in enumerate(self.standing):
            points = np.vstack((chain.anchors_m, chain.foot_m))
            for joint in reversed(range(len(chain.axes))):
                axis, anchor = chain.axes[joint], chain.anchors_m[joint]
                angle = turned[joint, leg]
                off = points[joint + 1 :] - anchor
                points[joint + 1 :] = (
                    anchor
                    + off * np.cos(angle)
                    + np.cross(axis, off) * np.sin(angle)
                    + np.outer(off @ axis, axis) * (1 - np.cos(angle))
                )
            places.append(points)
        return places

    def turned(self, angles: FloatArray) -> FloatArray:
        """Return by how much joints are turned from the standing pose, (max_joints, k, legs) [rad].

        Args:
            angles: angles of all joints, (k, joints) [rad].
        """
        if len(self.joints) == self._solver.max_joints * len(self):
            by_leg = (angles - self.standing_rad).reshape(len(angles), len(self), -1)
            return np.ascontiguousarray(np.moveaxis(by_leg, -1, 0))
        turned = np.zeros((self._solver.max_joints, len(angles), len(self)))
        first = np.searchsorted(self.leg_of_joint, self.leg_of_joint)
        place = np.arange(len(self.joints)) - first
        turned[place, :, self.leg_of_joint] = (angles - self.standing_rad).T
        return turned

    def under(self, gait: Gait) -> FootKinematics:
        return ChainKinematics(self, self._solver, gait)


class ChainKinematics(FootKinematics):
    """Kinematics of the feet of chains in the robot frame of a gait."""

    is_costly = True

    def __init__(self, legs: ChainLegs, solver: ChainSolver, gait: Gait) -> None:
        self.legs, self._solver, self._chain_legs = legs, solver, legs
        turn = math.radians(90 - gait.forward_deg)
        self._cos, self._sin = math.cos(turn), math.sin(turn)
        feet = np.array([chain.foot_m for chain in legs.standing])
        x, y = feet[:, 0], feet[:, 1]
        self._feet_m = feet.T[:, None]
        self._cached_parameters = lru_cache(maxsize=16)(self._parameters_of)
        self.homes_m = np.stack(
            (x * self._cos - y * self._sin, x * self._sin + y * self._cos), axis=1
        )
        ones = np.ones(len(legs))
        self._home_rad = np.zeros((len(legs), solver.max_joints))
        for leg in range(len(legs)):
            home_rad = legs.standing_rad[legs.leg_of_joint == leg]
            self._home_rad[leg, : len(home_rad)] = home_rad
        self.frames = np.array(
            [
                self._cos * ones,
                -self._sin * ones,
                self._sin * ones,
                self._cos * ones,
                np.arange(len(legs)),
            ]
        )
        """For each leg: x and y of the body frame for x of the robot frame, and for its y; and the
        index of the leg."""

    def mirrored(self, signs: FloatArray) -> FloatArray:
        frames = self.frames.copy()
        frames[:2] *= signs
        return frames

    def solve(self, places: FloatArray, heights: FloatArray, frames: FloatArray) -> FloatArray:
        return self._solve(places, heights, frames, NEAR)

    def joint_angles(self, offsets: FloatArray) -> FloatArray:
        x, y, z = np.ascontiguousarray(np.moveaxis(offsets, -1, 0))
        frames = np.broadcast_to(
            self.frames.reshape(5, *(1 for _ in x.shape[:-1]), x.shape[-1]), (5, *x.shape)
        )
        return self.in_pose_order(self._solve(np.array((x, y)), z, frames, EXACT))

    def _solve(
        self, places: FloatArray, heights: FloatArray, frames: FloatArray, near: float
    ) -> FloatArray:
        shape = places.shape[1:]
        offsets = np.empty((3, *shape))
        offsets[:2] = frames[:2] * places[0] + frames[2:4] * places[1]
        offsets[2] = heights
        offsets, legs = offsets.reshape(3, -1), frames[4].astype(int).ravel()
        angles = np.empty((len(legs), self._solver.max_joints))
        with np.errstate(invalid="ignore", over="ignore"):
            for start in range(0, len(legs), _CHUNK):
                chunk = slice(start, start + _CHUNK)
                is_cached = len(legs) <= _MAX_CACHED_FEET
                parameters_of = self._cached_parameters if is_cached else self._parameters_of
                parameters = parameters_of(legs[chunk].tobytes())
                turned = self._solver.solve(offsets[:, chunk], parameters, near)
                angles[chunk] = self._home_rad[legs[chunk]] + turned
        return angles.reshape(*shape, -1)

    def _parameters_of(self, legs: bytes) -> FootParameters:
        """Return the parameters of feet for `ChainSolver.solve`, by the indices of their legs."""
        return self._solver.parameters_of(self._solver.parameters[:, np.frombuffer(legs, int)])

    def foot_offsets(self, angles: Sequence[float]) -> list[tuple[float, float, float]]:
        turned = self._chain_legs.turned(np.array([angles]))
        x, y, z = (self._solver.feet_m(turned) - self._feet_m)[:, 0].tolist()
        cos, sin = self._cos, self._sin
        return [
            (cos * x_m - sin * y_m, sin * x_m + cos * y_m, up)
            for x_m, y_m, up in zip(x, y, z, strict=True)
        ]


@lru_cache(maxsize=64)
def chain_legs(robot: ModelRobot) -> ChainLegs:
    """Return the legs of a robot from a file; cached."""
    return ChainLegs(robot)
