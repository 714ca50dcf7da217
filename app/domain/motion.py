"""The motion of one step: swing two feet to their new cell, then shift the body over the feet.

From a plan of where the feet go to the commands of the servos, substep by substep, for many steps
at once: a whole layer of a look-ahead.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.domain.feet import Feet
from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.kinematics import Legs
from app.domain.robot import Robot
from app.domain.simulator import RECORDING_HZ
from app.domain.types import Action, FloatArray, IntArray


class StepPlan(NamedTuple):
    """What one step does to the feet, if nothing slips."""

    pair: int
    """The one that swings."""
    start: Feet
    landed: Feet
    """After the swing."""
    end: Feet
    """After the shift."""
    advance_m: float
    """How far the body moves in the shift."""


class StepMotion:
    """Plans steps of one robot under one gait on one foot grid."""

    def __init__(self, robot: Robot, gait: Gait, grid: FootGrid) -> None:
        self.legs = Legs(robot, gait)
        self._places = grid.places_m
        self._pairs = len(gait.pairs)
        self._samples = _samples(robot, gait, self.legs.frames)
        self._substeps = robot.swing_substeps + robot.shift_substeps

    def at_home(self) -> Feet:
        """Every foot at home."""
        return Feet.at_home(self._pairs)

    def plan(self, start: Feet, action: Action) -> StepPlan:
        """Where the feet go in a step (`app.domain.feet` has the law)."""
        pair, cell = action
        landed = start.landed(pair, cell, self._places[cell])
        end, advance = landed.centred()
        return StepPlan(pair, start, landed, end, advance)

    def joint_targets(self, plans: Sequence[StepPlan]) -> FloatArray:
        """Commands for the position servos over the substeps of each step.

        Returns:
            (n, substeps, legs · 3) [rad]; in each row legs in order, coxa, femur, tibia.
        """
        samples, swinging = self._samples, [plan.pair for plan in plans]
        ways = np.array([_ways(plan) for plan in plans])  # (n, 4, 2 · pairs)
        source = samples.source.take(swinging, 1)  # (4, n, samples)
        order = samples.order.take(swinging, 0)  # (n, substeps · legs)
        if len(plans) > 1:  # each has its own part of the flat arrays
            rows = np.arange(len(plans))[:, None]
            source += rows * ways[0].size
            order += rows * samples.share.size
        way = ways.take(source)
        places = way[:2] + samples.share * (way[2:] - way[:2])  # of the leader, (2, n, samples)
        frames = samples.frames.take(swinging, 2)
        angles = self.legs.solve(places, samples.lift, frames)
        targets: FloatArray = angles.reshape(-1, 3).take(order, 0)
        return targets.reshape(len(plans), self._substeps, -1)


def _ways(plan: StepPlan) -> tuple[tuple[float, ...], ...]:
    """From x, from y, to x, to y: of every pair in the swing, then of every pair in the shift."""
    start, landed, end = plan.start, plan.landed, plan.end
    return (
        start.lateral_m + landed.lateral_m,
        start.forward_m + landed.forward_m,
        landed.lateral_m + end.lateral_m,
        landed.forward_m + end.forward_m,
    )


class _Samples(NamedTuple):
    """The few places of feet for which a step needs inverse kinematics, all found in one call.

    Feet that stand through the swing need one. In a look-ahead planning stays a small part.
    What depends on which pair swings has a row for each pair.
    """

    frames: FloatArray
    """`Legs.frames` of the sample's leg, mirrored for a partner, (3, 2, pairs, samples)."""
    source: IntArray
    """Where `_ways` has the sample's from x, from y, to x, to y, (4, pairs, samples)."""
    share: FloatArray
    """How much of its way in this phase the foot has gone, (samples,)."""
    lift: FloatArray
    """How high it is lifted [m], (samples,)."""
    order: IntArray
    """Which sample commands which leg at which substep, (pairs, substeps · legs)."""


def _samples(robot: Robot, gait: Gait, frames: FloatArray) -> _Samples:
    """A half cosine forward and a half sine up in the swing, a half cosine in the shift."""
    count, swing, shift = len(robot.legs), robot.swing_substeps, robot.shift_substeps
    everyone, movers = np.arange(count), np.array(gait.pairs) - 1
    swung = np.repeat(np.arange(1, swing + 1) / swing, 2)
    shifted = np.repeat(np.arange(1, shift + 1) / shift, count)
    still = np.zeros(count)
    legs, order = [], []
    for pair in movers:
        legs.append(np.concatenate((everyone, np.tile(pair, swing), np.tile(everyone, shift))))
        in_swing = np.tile(everyone, (swing, 1))
        in_swing[:, pair] = count + np.arange(2 * swing).reshape(swing, 2)
        in_shift = count + 2 * swing + np.arange(count * shift)
        order.append(np.concatenate((in_swing.ravel(), in_shift)))
    whose, place = np.array(legs), np.argsort(movers.ravel())
    mirrored = frames.copy()
    mirrored[1] *= np.where(place % 2, -1.0, 1.0)  # a partner is at (−x, y)
    in_phase = np.repeat((0, 0, len(movers)), (count, 2 * swing, count * shift))
    pair_of = (place // 2)[whose] + in_phase  # (pairs, samples)
    return _Samples(
        mirrored[:, :, whose],
        np.stack([pair_of + part * 2 * len(movers) for part in range(4)]),
        np.concatenate((still, ease(swung), ease(shifted))),
        np.concatenate(
            (still, robot.step_height_m * np.sin(np.pi * swung), np.zeros_like(shifted))
        ),
        np.array(order),
    )


def ease(phase: FloatArray) -> FloatArray:
    """From 0 to 1 along a half cosine: starts and ends at rest."""
    return (1 - np.cos(np.pi * phase)) / 2


def recorded_substeps(robot: Robot) -> IntArray:
    """Which substeps of a step a recording keeps, counted from 0; always the last."""
    total = robot.swing_substeps + robot.shift_substeps
    stride = max(1, round(1 / (RECORDING_HZ * robot.dt_s)))
    return np.unique(np.append(np.arange(stride - 1, total, stride), total - 1))
