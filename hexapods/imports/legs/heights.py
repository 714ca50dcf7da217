"""The heights at which a robot can stand with its feet where they are."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.imports.legs.chain import PRECISION, LegChain
from hexapods.imports.legs.reach import FOLLOWING_JOINTS

_STEPS = 25
"""Number of heights that are tried, each higher by this part of the legs' length."""
_LATERAL_WEIGHT = 0.01
"""With two joints the height of a foot matters, not its place."""


class Heights(NamedTuple):
    """Heights of the torso's centre above the centres of the feet [m]."""

    lowest: float
    highest: float


def body_height_m(chains: Sequence[LegChain], angles: Sequence[FloatArray]) -> float:
    """Return the height of the torso's centre above the mean of the feet's centres [m]."""
    return -float(np.mean([foot[2] for foot in _feet(chains, angles)]))


def possible_heights(
    chains: Sequence[LegChain], angles: Sequence[FloatArray], least_m: float
) -> Heights | None:
    """Return the lowest and highest height, to the millimetre; None if there is no range.

    Args:
        chains: the legs.
        angles: those of a stance, leg by leg [rad].
        least_m: height below which the torso would touch the ground.
    """
    home_m = body_height_m(chains, angles)
    length_m = float(np.mean([chain.length_m for chain in chains]))
    moves = np.linspace(-length_m, length_m, 2 * _STEPS + 1)
    moves = moves[home_m + moves >= min(least_m, home_m)]
    reached = np.ones(len(moves), dtype=bool)
    for chain, at_rad in zip(chains, angles, strict=True):
        _, off_m = _moved(chain, at_rad, moves)
        reached &= off_m <= PRECISION * chain.length_m
    home = int(np.abs(moves).argmin())
    if not reached[home]:
        return None
    low = high = home
    while low and reached[low - 1]:
        low -= 1
    while high + 1 < len(moves) and reached[high + 1]:
        high += 1
    lowest = float(np.ceil(1000 * (home_m + moves[low])) / 1000)
    highest = float(np.floor(1000 * (home_m + moves[high])) / 1000)
    return Heights(lowest, highest) if lowest < highest else None


def at_height(
    chains: Sequence[LegChain],
    angles: Sequence[FloatArray],
    heights: Heights | None,
    height_m: float,
) -> list[FloatArray]:
    """Return the angles at which the robot stands on the same places at another height.

    Raises:
        InvalidInput: if the height is not possible.
    """
    if heights is None:
        raise InvalidInput(
            "body_height_m cannot be chosen: from its home the robot can neither rise nor sink"
        )
    if not heights.lowest <= height_m <= heights.highest:
        raise InvalidInput(
            f"body_height_m must be from {heights.lowest:g} to {heights.highest:g} m, not "
            f"{height_m:g}: there its feet stay in their places"
        )
    move = np.array([height_m - body_height_m(chains, angles)])
    pairs = zip(chains, angles, strict=True)
    return [_moved(chain, at_rad, move)[0][0] for chain, at_rad in pairs]


def _moved(chain: LegChain, angles: FloatArray, moves: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles of a leg at some heights, and by how far its foot misses them.

    Args:
        chain: the leg.
        angles: those of its stance [rad].
        moves: by how much the torso is higher, (k,) [m].

    Returns:
        angles, (k, joints) [rad], and distances, (k,) [m].
    """
    down = np.outer(moves, [0, 0, -1])
    targets = chain.feet(np.clip(angles, *chain.limits)[None])[0] + down
    if len(angles) >= FOLLOWING_JOINTS:
        return chain.solve(targets, angles)
    solution, _ = chain.solve(targets, angles, np.array([_LATERAL_WEIGHT, _LATERAL_WEIGHT, 1.0]))
    return solution, np.abs(chain.feet(solution)[:, 2] - targets[:, 2])


def _feet(chains: Sequence[LegChain], angles: Sequence[FloatArray]) -> list[FloatArray]:
    pairs = zip(chains, angles, strict=True)
    return [chain.feet(at_rad[None])[0] for chain, at_rad in pairs]
