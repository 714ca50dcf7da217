"""Whether a foot can step from where it stands."""

import numpy as np

from hexapods.domain.types import FloatArray
from hexapods.imports.legs.chain import PRECISION, LegChain

FOLLOWING_JOINTS = 3
"""Number of joints from which on a leg can follow a grid."""
_REACH_SHARE, _LIFT_SHARE = 0.08, 0.12
"""Least reach of each foot from home, to each side and upward, as shares of its leg's length."""
_ALONG_WEIGHTS, _STEP_SHARE = (0.01, 0.01), 0.7
"""Of two joints the height of the foot matters more than its place; least share of a step."""


def is_short_of_box(chain: LegChain, angles: FloatArray) -> bool:
    """Whether a foot does not reach its box; with two joints, whether it cannot step at all."""
    angles = np.clip(angles, *chain.limits)
    if len(angles) < FOLLOWING_JOINTS:
        return not can_step(chain, angles)
    corners = [(x * _REACH_SHARE, y * _REACH_SHARE, 0) for x in (-1, 1) for y in (-1, 1)]
    shares = np.array([*corners, (0, 0, _LIFT_SHARE)])
    targets = chain.feet(angles[None])[0] + chain.length_m * shares
    _, off = chain.solve(targets, angles)
    return bool((off > PRECISION * chain.length_m).any())


def can_step(chain: LegChain, angles: FloatArray) -> bool:
    """Whether the foot of two joints can rise, and move both ways along the ground.

    It moves on a surface: it need not rise straight up, and the way along the ground is the one
    that the joints have.
    """
    turns = np.radians(np.arange(0, 360, 45))
    along = np.stack([np.cos(turns), np.sin(turns), np.zeros(8)], axis=1)
    moves = chain.length_m * np.array([*_REACH_SHARE * along, (0, 0, _LIFT_SHARE)])
    home = chain.feet(angles[None])[0]
    solution, _ = chain.solve(home + moves, angles, np.array([*_ALONG_WEIGHTS, 1.0]))
    moved = chain.feet(solution) - home
    is_level = np.abs(moved[:, 2] - moves[:, 2]) <= PRECISION * chain.length_m
    went = (moved[:8] * along).sum(axis=1) >= _STEP_SHARE * _REACH_SHARE * chain.length_m
    goes = is_level[:8] & went
    return bool(is_level[8] and (goes[:4] & goes[4:]).any())
