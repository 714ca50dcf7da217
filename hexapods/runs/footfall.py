"""Footfalls: when each foot is on the ground, from recorded poses.

A footfall diagram (Hildebrand 1965, "Symmetrical gaits of horses", Science 150) draws for each leg
its stance, when the foot is on the ground, and its swing. The duty factor is the share of stance
(Alexander 2003, "Principles of Animal Locomotion", chapter 7).
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.disturbances import Lost
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.sums import ordered_sum
from hexapods.domain.terrain import ground_heights
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World

CONTACT_M = 0.0005
"""A foot whose lowest point is less than this above the ground is on it. Contacts in MuJoCo are
soft: feet sink in by 1 to 2 mm. By this threshold 97 to 99.8 % of the recorded frames agree with
its contacts; feet that slide or bounce touch the ground off and on."""

Interval = tuple[float, float]
"""From and to [s]."""


def clearances_m(
    robot: Robot, poses: FloatArray, steps: NDArray[np.int64], world: World
) -> FloatArray:
    """Return the clearance of each foot: height of its lowest point over the ground, (k, legs) [m].

    Args:
        robot: the robot as it was built.
        poses: (k, 7 + joints).
        steps: the step that each pose belongs to, counted from 0, (k,).
        world: disturbances by step; the foot of a lost leg has an infinite clearance.
    """
    feet = legs_of(robot).foot_positions(poses)
    clearance: FloatArray = feet[..., 2] - robot.foot_radii_m
    for stretch, conditions in _stretches(steps, world):
        clearance[stretch] -= ground_heights(conditions, feet[stretch, :, :2])
        for lost in conditions.all_of(Lost):
            clearance[stretch, np.array(lost.legs) - 1] = np.inf
    return clearance


def _stretches(steps: NDArray[np.int64], world: World) -> Iterator[tuple[slice, World]]:
    """Yield parts of consecutive poses with one set of conditions."""
    bounds = np.searchsorted(steps, world.change_steps)
    edges = np.unique(np.concatenate(([0], bounds, [len(steps)]))).tolist()
    for start, end in pairwise(edges):
        yield slice(start, end), world.as_of(int(steps[start]))


def stance_intervals(times_s: FloatArray, clearance_m: FloatArray) -> list[Interval]:
    """Return the intervals in which a foot is on the ground [s].

    Between two poses it touches or leaves the ground where the straight line between its clearances
    crosses the threshold.

    Args:
        times_s: times of the poses, ascending, (k,).
        clearance_m: clearance of the foot, (k,).
    """
    if not len(times_s):
        return []
    above = clearance_m - CONTACT_M
    stands = above < 0
    changes = np.flatnonzero(stands[1:] != stands[:-1])
    edges = []
    for before in changes.tolist():
        share, clearances = 0.0, above[before : before + 2]
        if np.isfinite(
            clearances
        ).all():  # else a leg is lost, or is there again, with the new step
            share = clearances[0] / (clearances[0] - clearances[1])
        edges.append(float(times_s[before] + share * (times_s[before + 1] - times_s[before])))
    if stands[0]:
        edges.insert(0, float(times_s[0]))
    if stands[-1]:
        edges.append(float(times_s[-1]))
    return list(zip(edges[::2], edges[1::2], strict=True))


def clipped(intervals: Sequence[Interval], from_s: float, to_s: float) -> list[Interval]:
    """Return the parts of intervals between two times."""
    cut = ((max(start, from_s), min(end, to_s)) for start, end in intervals)
    return [(start, end) for start, end in cut if end > start]


def duty_factor(stance: Sequence[Interval], from_s: float, to_s: float) -> float:
    """Return the share of the time between two times in which a foot is on the ground."""
    parts = clipped(stance, from_s, to_s)
    return ordered_sum(end - start for start, end in parts) / (to_s - from_s)
