"""Finds chains of which two are one leg: a closed loop, as of five bars, that the file leaves open.

A five-bar leg has two chains from the torso to one foot, each with a motor; a URDF, which is a
tree, describes them as two legs.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from hexapods.domain.body import MIN_LEGS
from hexapods.domain.types import FloatArray
from hexapods.imports.legs.feet import FoundLeg

_PARALLEL = 0.995
"""Least cosine of the angle between axes of one loop."""
_SAME_SHARE, _BESIDE_SHARE = 0.05, 0.3
"""Largest distance between two axes or two feet of a loop, and along them, by leg length."""


def second_chains(legs: Sequence[FoundLeg], data: mujoco.MjData) -> list[FoundLeg]:
    """Return the chains that end at the foot of another one; none unless all legs are such pairs.

    Of a pair the chain is kept that is farther out, or that comes first.

    Args:
        legs: the chains.
        data: the robot in its resting pose.
    """
    partners = [_partner(leg, legs, data) for leg in range(len(legs))]
    pairs = [
        (leg, partner)
        for leg, partner in enumerate(partners)
        if partner is not None and partners[partner] == leg and leg < partner
    ]
    if 2 * len(pairs) != len(legs) or len(pairs) < MIN_LEGS:
        return []
    center = np.mean([_hip(leg, data) for leg in legs], axis=0)

    def distance_m(leg: int) -> float:
        return round(float(np.linalg.norm(_hip(legs[leg], data) - center)), 4)

    return [legs[min(pair, key=lambda leg: (distance_m(leg), -leg))] for pair in pairs]


def _partner(leg: int, legs: Sequence[FoundLeg], data: mujoco.MjData) -> int | None:
    """Return the nearest chain that may be of the same loop."""
    possible = [
        (distance_m, other)
        for other in range(len(legs))
        if other != leg and (distance_m := _distance_m(legs[leg], legs[other], data)) is not None
    ]
    return min(possible)[1] if possible else None


def _distance_m(leg: FoundLeg, other: FoundLeg, data: mujoco.MjData) -> float | None:
    """Return the distance along the axes of two chains; None if they are of no loop."""
    if len(leg.joints) != len(other.joints):
        return None
    axis = data.xaxis[leg.joints[0]]
    axes = data.xaxis[[*leg.joints, *other.joints]]
    if (np.abs(axes @ axis) < _PARALLEL).any():
        return None
    length_m, other_m = (_length_m(chain, data) for chain in (leg, other))
    if abs(length_m - other_m) > _SAME_SHARE * length_m:
        return None
    for apart in (
        _hip(other, data) - _hip(leg, data),
        other.foot.in_world(data) - leg.foot.in_world(data),
    ):
        along_m = abs(float(apart @ axis))
        across_m = float(np.linalg.norm(apart - (apart @ axis) * axis))
        if across_m <= _SAME_SHARE * length_m and along_m <= _BESIDE_SHARE * length_m:
            return along_m
    return None


def _hip(leg: FoundLeg, data: mujoco.MjData) -> FloatArray:
    return np.array(data.xanchor[leg.joints[0]])


def _length_m(leg: FoundLeg, data: mujoco.MjData) -> float:
    """Return the sum of the distances from joint to joint, and to the foot."""
    points = [*data.xanchor[list(leg.joints)], leg.foot.in_world(data)]
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
