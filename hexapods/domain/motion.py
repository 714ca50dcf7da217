"""Servo commands of a step: swing a group of feet to its new cell, then shift the body over them.

Turns plans of foot offsets into joint targets per substep, vectorised over many steps, such as a
whole layer of a look-ahead.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.gait import Gait
from hexapods.domain.kinematics import legs_of
from hexapods.domain.legs import FootKinematics
from hexapods.domain.robot import Robot
from hexapods.domain.simulator import RECORDING_HZ
from hexapods.domain.types import Action, FloatArray, IntArray

_SWING_KNOTS, _SHIFT_KNOTS = 8, 5
"""Places of a swing and of a shift for which costly inverse kinematics is solved: the angles
between them are right to 0.2 mrad."""


class StepPlan(NamedTuple):
    """Foot offsets at the phases of one step, without slip."""

    group: int
    """The group that swings."""
    start: Feet
    landed: Feet
    """Offsets after the swing."""
    end: Feet
    """Offsets after the shift."""
    advance_m: float
    """Displacement of the body in the shift."""


class StepMotion:
    """Plans steps and their joint targets, for one robot, gait and foot grid."""

    def __init__(
        self, robot: Robot, gait: Gait, law: StepLaw, substeps: IntArray | None = None
    ) -> None:
        """Compute the samples that all steps have in common.

        Args:
            robot: the robot.
            gait: the gait.
            law: the kinematic law by which the feet move.
            substeps: indices of the substeps whose joint targets are computed, ascending; None for
                all.
        """
        self.kinematics, self._law = legs_of(robot).under(gait), law
        total = robot.swing_substeps + robot.shift_substeps
        wanted = np.arange(total) if substeps is None else substeps
        swing, shift = _phases(robot, wanted)
        self._swing, swing = _knots(swing, _SWING_KNOTS, self.kinematics)
        # Feet move along a line in the shift, along which angles are smoother than in time.
        self._shift, shares = _knots(ease(shift), _SHIFT_KNOTS, self.kinematics)
        self._samples = _samples(robot, gait, self.kinematics, swing, shares)
        self._counts = len(swing), len(shares)

    def plan(self, start: Feet, action: Action) -> StepPlan:
        """Plan a step from the feet's offsets, by the kinematic law."""
        return StepPlan(action.group, start, *self._law.step(start, action))

    def joint_targets(self, plans: Sequence[StepPlan]) -> FloatArray:
        """Compute the commands of the position servos over the wanted substeps of each step.

        Args:
            plans: the n steps.

        Returns:
            (n, substeps, joints) [rad].
        """
        samples, swinging = self._samples, [plan.group for plan in plans]
        endpoints = np.array([_phase_endpoints(plan) for plan in plans])  # (n, 4, 2 · groups)
        source = samples.source.take(swinging, 1)  # (4, n, samples)
        order = samples.order.take(swinging, 0)  # (n, substeps · legs)
        if len(plans) > 1:  # offset the indices to each plan's rows of the flat arrays
            rows = np.arange(len(plans))[:, None]
            source += rows * endpoints[0].size
            order += rows * samples.share.size
        sample_endpoints = endpoints.take(source)
        places = sample_endpoints[:2] + samples.share * (
            sample_endpoints[2:] - sample_endpoints[:2]
        )  # of the groups, (2, n, samples)
        frames = samples.frames.take(swinging, -2)
        angles = self.kinematics.solve(places, samples.lift, frames)
        most = angles.shape[-1]
        by_leg = angles.reshape(-1, most).take(order, 0)
        by_leg = by_leg.reshape(len(plans), sum(self._counts), -1, most)  # whole numbers
        targets = self.kinematics.in_pose_order(by_leg)
        if self._swing is None and self._shift is None:
            return targets
        swing, shift = targets[:, : self._counts[0]], targets[:, self._counts[0] :]
        return np.concatenate(
            (_interpolated(swing, self._swing), _interpolated(shift, self._shift)), axis=1
        )


def _phase_endpoints(plan: StepPlan) -> tuple[tuple[float, ...], ...]:
    """Return from x, from y, to x, to y [m] of every group in the swing, then in the shift."""
    start, landed, end = plan.start, plan.landed, plan.end
    return (
        start.lateral_m + landed.lateral_m,
        start.forward_m + landed.forward_m,
        landed.lateral_m + end.lateral_m,
        landed.forward_m + end.forward_m,
    )


class _Samples(NamedTuple):
    """The distinct foot positions of a step, for which inverse kinematics is solved in one call.

    Feet that stand through the swing need a single sample, which keeps planning cheap in a
    look-ahead. Fields that depend on which group swings have a row for each group.
    """

    frames: FloatArray
    """`FootKinematics.frames` of the sample's leg, mirrored by the gait, (..., groups, samples)."""
    source: IntArray
    """Indices of each sample's from x, from y, to x, to y in the flattened result of
    `_phase_endpoints`, (4, groups, samples)."""
    share: FloatArray
    """Interpolation parameter of each sample within its phase, 0 to 1, (samples,)."""
    lift: FloatArray
    """Height of each sample above the ground [m], (samples,)."""
    order: IntArray
    """Index of the sample that commands each leg at each wanted substep,
    (groups, substeps · legs)."""


def _phases(robot: Robot, substeps: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the phase, 0 to 1, of each substep of the swing, and of each of the shift."""
    is_swing = substeps < robot.swing_substeps
    return (
        (substeps[is_swing] + 1) / robot.swing_substeps,
        (substeps[~is_swing] - robot.swing_substeps + 1) / robot.shift_substeps,
    )


def _knots(
    phases: FloatArray, count: int, kinematics: FootKinematics
) -> tuple[FloatArray | None, FloatArray]:
    """Return the phases at which inverse kinematics is solved, and weights that interpolate them.

    Returns:
        Weights of the knots at each phase, (phases, knots), None if they are the phases
        themselves; and the knots.
    """
    if not kinematics.is_costly or len(phases) <= count:
        return None, phases
    number = np.arange(count)
    # Chebyshev points with both ends, and Lagrange's polynomials in barycentric form (Berrut and
    # Trefethen 2004, "Barycentric Lagrange interpolation").
    knots = (1 - np.cos(np.pi * number / (count - 1))) / 2
    signs = (-1.0) ** number
    signs[[0, -1]] /= 2
    away = phases[:, None] - knots
    is_knot = np.abs(away) < 1e-12
    shares = signs / np.where(is_knot, 1.0, away)
    weights = shares / shares.sum(axis=1, keepdims=True)
    on_knot = is_knot.any(axis=1)
    weights[on_knot] = is_knot[on_knot]
    return weights, knots


def _interpolated(targets: FloatArray, weights: FloatArray | None) -> FloatArray:
    """Return joint targets between knots, elementwise.

    Args:
        targets: at the knots, (n, knots, joints).
        weights: as `_knots` returns them.

    Returns:
        (n, phases, joints).
    """
    if weights is None:
        return targets
    between = weights[:, :1] * targets[:, None, 0]
    for knot in range(1, weights.shape[1]):
        between = between + weights[:, knot, None] * targets[:, None, knot]
    return between


def _samples(
    robot: Robot,
    gait: Gait,
    kinematics: FootKinematics,
    swing_times: FloatArray,
    shift_shares: FloatArray,
) -> _Samples:
    """Sample the trajectory of a step: easing by half a cosine, lifting by half a sine.

    Args:
        robot: has the step height.
        gait: has the groups.
        kinematics: kinematics of the feet under this gait.
        swing_times: phases of the swing, 0 to 1.
        shift_shares: how far the feet have come in the shift, 0 to 1.
    """
    count = len(kinematics.legs)
    # The samples of each group have room for the legs of the largest group; a smaller one repeats
    # some of its legs, whose samples command nothing.
    all_legs, groups, size = np.arange(count), len(gait.groups), max(gait.sizes)
    swing, shift = len(swing_times), len(shift_shares)
    swing_phase, shift_share = np.repeat(swing_times, size), np.repeat(shift_shares, count)
    zeros = np.zeros(count)
    legs, order = [], []
    for group in gait.groups:
        swinging = np.array(group) - 1
        filled = np.resize(swinging, size)
        legs.append(np.concatenate((all_legs, np.tile(filled, swing), np.tile(all_legs, shift))))
        in_swing = np.tile(all_legs, (swing, 1))
        samples = count + np.arange(size * swing).reshape(swing, size)
        in_swing[:, swinging] = samples[:, : len(group)]
        in_shift = count + size * swing + np.arange(count * shift)
        order.append(np.concatenate((in_swing.ravel(), in_shift)))
    sample_legs = np.array(legs)
    in_phase = np.repeat((0, 0, groups), (count, size * swing, count * shift))
    group_of = np.array(gait.group_of_leg)[sample_legs] + in_phase  # (groups, samples)
    return _Samples(
        kinematics.mirrored(np.array(gait.mirror, float))[..., sample_legs],
        np.stack([group_of + row * 2 * groups for row in range(4)]),
        np.concatenate((zeros, ease(swing_phase), shift_share)),
        np.concatenate(
            (
                zeros,
                robot.step_height_m * np.sin(np.pi * swing_phase),
                np.zeros_like(shift_share),
            )
        ),
        np.array(order),
    )


def ease(phase: FloatArray) -> FloatArray:
    """Interpolate from 0 to 1 along half a cosine, with zero velocity at both ends."""
    return (1 - np.cos(np.pi * phase)) / 2


def recorded_substeps(robot: Robot) -> IntArray:
    """Return the indices of a step's substeps that are recorded, always including the last."""
    total = robot.swing_substeps + robot.shift_substeps
    stride = max(1, round(1 / (RECORDING_HZ * robot.dt_s)))
    return np.unique(np.append(np.arange(stride - 1, total, stride), total - 1))
