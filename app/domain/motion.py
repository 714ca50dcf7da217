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
        self._places = [(float(x), float(y)) for x, y in grid.cells]
        self._pairs = len(gait.pairs)
        self._samples = _samples(robot, gait)

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
        samples, rows = self._samples, np.arange(len(plans))[:, None]
        swinging = [plan.pair for plan in plans]
        source = samples.source[swinging]  # (n, samples)
        ways = np.array(
            [
                (
                    (*p.start.lateral_m, *p.landed.lateral_m),
                    (*p.start.forward_m, *p.landed.forward_m),
                    (*p.landed.lateral_m, *p.end.lateral_m),
                    (*p.landed.forward_m, *p.end.forward_m),
                )
                for p in plans
            ]
        )  # (n, from x, from y, to x, to y; pair in the swing, pair in the shift)
        from_x, from_y, to_x, to_y = (ways[rows, part, source] for part in range(4))
        x = samples.side[swinging] * (from_x + samples.share * (to_x - from_x))
        y = from_y + samples.share * (to_y - from_y)
        angles = self.legs.solve(x, y, samples.lift, samples.legs[swinging])
        targets = angles[rows[..., None], samples.order[swinging]]
        return targets.reshape(len(plans), -1, targets.shape[2] * 3)


class _Samples(NamedTuple):
    """The few places of feet for which a step needs inverse kinematics, all found in one call.

    Feet that stand through the swing need one. In a look-ahead planning stays a small part.
    What depends on which pair swings has a row for each pair.
    """

    legs: IntArray
    """Whose place, (pairs, samples)."""
    side: FloatArray
    """1 for a leader and −1 for a partner, (pairs, samples)."""
    source: IntArray
    """Its pair in the swing, or pairs + its pair in the shift, (pairs, samples)."""
    share: FloatArray
    """How much of its way in this phase the foot has gone, (samples,)."""
    lift: FloatArray
    """How high it is lifted [m], (samples,)."""
    order: IntArray
    """Which sample commands which leg at which substep, (pairs, substeps, legs)."""


def _samples(robot: Robot, gait: Gait) -> _Samples:
    """A half cosine forward and a half sine up in the swing, a half cosine in the shift."""
    count, swing, shift = len(robot.legs), robot.swing_substeps, robot.shift_substeps
    everyone, movers = np.arange(count), np.array(gait.pairs) - 1
    swung = np.repeat(np.arange(1, swing + 1) / swing, 2)
    shifted = np.repeat(np.arange(1, shift + 1) / shift, count)
    legs, order = [], []
    for pair in movers:
        legs.append(np.concatenate((everyone, np.tile(pair, swing), np.tile(everyone, shift))))
        in_swing = np.tile(everyone, (swing, 1))
        in_swing[:, pair] = count + np.arange(2 * swing).reshape(swing, 2)
        in_shift = count + 2 * swing + np.arange(count * shift).reshape(shift, count)
        order.append(np.concatenate((in_swing, in_shift)))
    pair_of = np.argsort(movers.ravel()) // 2
    side_of = np.where(np.argsort(movers.ravel()) % 2, -1.0, 1.0)
    whose, still = np.array(legs), np.zeros(count)
    in_phase = np.repeat((0, 0, len(movers)), (count, 2 * swing, count * shift))
    return _Samples(
        whose,
        side_of[whose],
        pair_of[whose] + in_phase,
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
