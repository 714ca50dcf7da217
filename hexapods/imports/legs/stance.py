"""Finds a robot's stance: a keyframe of the file, or all angles 0, or the result of a search.

A stance is good if the torso is clear of the ground, the feet are level, and each foot reaches the
corners of a box around it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Choices
from hexapods.imports.legs.chain import PRECISION, LegChain
from hexapods.imports.legs.heights import Heights, at_height, possible_heights
from hexapods.imports.legs.reach import FOLLOWING_JOINTS, is_short_of_box
from hexapods.imports.notes import Notes, listed, quoted

_CLEARANCE_SHARE, _LEVEL_SHARE = 0.04, 0.15
"""Least height of the torso over the ground and largest unevenness of the feet, by leg length."""
_SAMPLES, _ROUNDS, _NEAR = 3000, 6, 400
_HOMES = ("home", "stand", "standing", "init", "default")
"""Usual names of keyframes in which a robot stands, the best first."""
_WITHOUT_LIMIT_RAD = np.pi
_SPRAWLING = 0.35
"""A leg points outward if its foot is farther from the mount at the angles 0, of its length."""
_SPRAWLED = ((0.45, 0.6), (0.55, 0.6), (0.35, 0.7), (0.6, 0.7), (0.3, 0.6))
"""Postures of such legs: how far the foot is below its mount and out, of the leg's length."""
_UPRIGHT = (0.65, 0.72, 0.58, 0.5, 0.8)
"""Postures of other legs: how far the foot is below its mount."""
_ASTRIDE = 1.15
"""Lateral distance of such feet from their mounts, by the hips' offsets; at this none toppled."""
_POSTURES = len(_UPRIGHT)
_KNEE_SHARE, _KNEE_COST = 0.03, 10.0
"""Depth of a knee below the line from hip to foot, of the leg's length, that counts; its cost."""
_LEAST_UNDER = 0.15
"""Least depth of a foot below the torso, as a share of the leg's length."""
Angles = list[FloatArray]
"""Joint angles of each leg [rad], each (joints,)."""


@dataclass(frozen=True, eq=False)
class RobotWithLegs:
    """Inputs of a stance.

    Attributes:
        chains: the legs.
        radii_m: radii of their feet.
        names: names of their joints in the file.
        torso_bottom_m: lowest point of the torso in the body frame.
        keyframes: angles of the legs in each keyframe of the file.
        at_rest: angles of the legs in the initial pose of the file.
    """

    chains: Sequence[LegChain]
    radii_m: Sequence[float]
    names: Sequence[Sequence[str]]
    torso_bottom_m: float
    keyframes: Mapping[str, Angles]
    at_rest: Angles

    @property
    def length_m(self) -> float:
        """Mean length of a leg."""
        return float(np.mean([chain.length_m for chain in self.chains]))

    def bottoms_m(self, angles: Angles) -> FloatArray:
        """Return the height of the lowest point of each foot in the body frame, (legs,)."""
        feet = [
            chain.feet(leg_angles[None])[0, 2]
            for chain, leg_angles in zip(self.chains, angles, strict=True)
        ]
        return np.array(feet) - self.radii_m


class Stance(NamedTuple):
    """A stance.

    Attributes:
        angles: of each leg's joints [rad].
        heights: at which the robot could stand with its feet in the same places.
    """

    angles: Angles
    heights: Heights | None


def find_stance(robot: RobotWithLegs, choices: Choices, notes: Notes) -> Stance:
    """Return the robot's stance.

    Raises:
        InvalidInput: if chosen angles, a chosen height or keyframe are not possible.
    """
    angles = _level(robot, _stance_of_file(robot, choices, notes), notes)
    least_m = (
        _CLEARANCE_SHARE * robot.length_m - robot.torso_bottom_m - float(np.mean(robot.radii_m))
    )
    heights = possible_heights(robot.chains, angles, least_m)
    if choices.body_height_m is not None:
        angles = at_height(robot.chains, angles, heights, choices.body_height_m)
    if choices.home_rad:
        angles = _changed(robot, angles, choices.home_rad)
    return Stance(angles, heights)


def tell_of_reach(robot: RobotWithLegs, angles: Angles, notes: Notes) -> bool:
    """Return whether each foot reaches its box from a stance, and tell of those that do not."""
    short = [leg for leg, chain in enumerate(robot.chains) if len(chain.axes) < FOLLOWING_JOINTS]
    if short:
        notes.guess(
            "legs",
            f"a leg of two joints follows a grid only as far as it can: {_numbered(short)}",
            [name for leg in short for name in robot.names[leg]],
        )
    unreached = [
        leg
        for leg, (chain, leg_angles) in enumerate(_pairs(robot, angles))
        if is_short_of_box(chain, leg_angles)
    ]
    stuck = [leg for leg in unreached if leg in short]
    if stuck:
        notes.guess(
            "stance",
            "it cannot walk: from home a foot cannot both rise and move along the ground, that of "
            f"leg {_numbered(stuck)}; choose other angles with which it stands",
            [name for leg in stuck for name in robot.names[leg]],
        )
    elif unreached:
        notes.guess(
            "stance",
            "at home not every foot reaches to all sides: take a small grid",
            [name for leg in unreached for name in robot.names[leg]],
        )
    return not unreached


def _numbered(legs: Sequence[int]) -> str:
    return ", ".join(str(leg + 1) for leg in legs)


def _pairs(robot: RobotWithLegs, angles: Angles) -> list[tuple[LegChain, FloatArray]]:
    return list(zip(robot.chains, angles, strict=True))


def _stance_of_file(robot: RobotWithLegs, choices: Choices, notes: Notes) -> Angles:
    if choices.keyframe is not None:
        if choices.keyframe not in robot.keyframes:
            valid = listed(robot.keyframes) or "none"
            raise InvalidInput(
                f"the file has no keyframe {quoted(choices.keyframe)!r}; it has: {valid}"
            )
        return _within(robot, robot.keyframes[choices.keyframe])
    tried: list[str] = []
    for name in sorted(robot.keyframes, key=_suitability):
        problem = _problem(robot, robot.keyframes[name])
        if problem is None:
            notes.guess("stance", f"it stands as in keyframe {quoted(name)}")
            return _within(robot, robot.keyframes[name])
        tried.append(f"in keyframe {quoted(name)} {problem}")
    problem = _problem(robot, robot.at_rest)
    if problem is None:
        notes.guess("stance", "it stands as the file begins, all angles 0")
        return _within(robot, robot.at_rest)
    tried.append(f"as the file begins {problem}")
    notes.guess("stance", f"it stands with bent knees, as was searched: {'; '.join(tried[:3])}")
    return search(robot)


def _suitability(name: str) -> int:
    plain = name.lower()
    ranks = [place for place, usual in enumerate(_HOMES) if usual in plain]
    return min(ranks, default=len(_HOMES))


def _within(robot: RobotWithLegs, angles: Angles) -> Angles:
    return [np.clip(leg_angles, *chain.limits) for chain, leg_angles in _pairs(robot, angles)]


def _problem(robot: RobotWithLegs, angles: Angles) -> str | None:
    """Return the reason that a stance is not good, in words; None if it is good."""
    for (chain, leg_angles), names in zip(_pairs(robot, angles), robot.names, strict=True):
        low, high = chain.limits
        out = np.flatnonzero((leg_angles < low - 1e-3) | (leg_angles > high + 1e-3))
        if len(out):
            return f"joint {quoted(names[int(out[0])])} would be outside its limits"
    bottoms = robot.bottoms_m(angles)
    if np.ptp(bottoms) > _LEVEL_SHARE * robot.length_m:
        return "the feet would not be level"
    if robot.torso_bottom_m - bottoms.max() < _CLEARANCE_SHARE * robot.length_m:
        return "the torso would touch the ground"
    for number, (chain, leg_angles) in enumerate(_pairs(robot, angles)):
        if is_short_of_box(chain, leg_angles):
            return f"the foot after {quoted(robot.names[number][-1])} could hardly move"
    return None


def _level(robot: RobotWithLegs, angles: Angles, notes: Notes) -> Angles:
    """Move the feet up or down to their mean height, if it is within reach."""
    bottoms = robot.bottoms_m(angles)
    if np.ptp(bottoms) < 1e-6:
        return angles
    moved, unreached = [], []
    for number, (chain, leg_angles) in enumerate(_pairs(robot, angles)):
        target = chain.feet(leg_angles[None])[0] + [0, 0, float(bottoms.mean() - bottoms[number])]
        solution, off = chain.solve(target[None], leg_angles)
        moved.append(solution[0])
        # With two joints only the height matters.
        left = (
            abs(float(chain.feet(solution)[0, 2] - target[2]))
            if len(leg_angles) < 3
            else float(off[0])
        )
        if left > PRECISION * chain.length_m:
            unreached.append(number + 1)
    if unreached:
        notes.guess(
            "stance",
            f"at home the feet are not level: legs {', '.join(map(str, unreached))} do not reach "
            "the height of the others",
            [name for leg in unreached for name in robot.names[leg - 1]],
        )
    elif np.ptp(bottoms) > 1e-3:
        notes.repair(
            "stance", f"the feet stood up to {1000 * np.ptp(bottoms):.0f} mm uneven; now level"
        )
    return moved


def _changed(robot: RobotWithLegs, angles: Angles, chosen: Mapping[str, float]) -> Angles:
    """Return a stance with the joint angles that a person has chosen, by the joint's name."""
    places = {
        name: (leg, joint)
        for leg, names in enumerate(robot.names)
        for joint, name in enumerate(names)
    }
    changed = [leg_angles.copy() for leg_angles in angles]
    for name, angle in chosen.items():
        if name not in places:
            raise InvalidInput(
                f"no leg has a joint {quoted(name)!r}; the legs' joints are: {listed(places)}"
            )
        leg, joint = places[name]
        low, high = robot.chains[leg].limits[:, joint]
        if not low <= angle <= high:
            raise InvalidInput(
                f"joint {quoted(name)} of leg {leg + 1} must be from {low:.3g} to {high:.3g} rad, "
                f"not {angle:g}"
            )
        changed[leg][joint] = angle
    return changed


def search(robot: RobotWithLegs) -> Angles:
    """Return a stance with bent knees, symmetric for legs that mirror each other.

    Of several postures it is the first from which all feet reach their boxes, or most feet. Knees
    of legs that point outward are above the line from the hip to the foot, if the limits allow it
    without a loss of reach.
    """
    stance, number, unreached = _most_reaching(robot)
    if _knees_down(robot, stance):
        other = _posture(robot, number, knees_up=True)
        if _unreached(robot, other) <= unreached and not _knees_down(robot, other):
            return other
    return stance


def _most_reaching(robot: RobotWithLegs) -> tuple[Angles, int, int]:
    """Return the stance from which most feet reach their boxes.

    Returns:
        its angles, the number of its posture, and how many feet do not reach.
    """
    fewest, best, stance = len(robot.chains) + 1, 0, list[FloatArray]()
    for number in range(_POSTURES):
        angles = _posture(robot, number, knees_up=False)
        unreached = _unreached(robot, angles)
        if unreached < fewest:
            fewest, best, stance = unreached, number, angles
        if not unreached:
            break
    return stance, best, fewest


def _unreached(robot: RobotWithLegs, angles: Angles) -> int:
    """Return how many feet do not reach their boxes."""
    pairs = _pairs(robot, angles)
    return sum(is_short_of_box(chain, at_rad) for chain, at_rad in pairs)  # whole numbers


def _knees_down(robot: RobotWithLegs, angles: Angles) -> bool:
    """Whether a leg that points outward has its knee below the line from its hip to its foot."""
    for chain, at_rad in _pairs(robot, angles):
        out = chain.feet(at_rad[None])[0] - chain.anchors[0]
        height_m = float(chain.knee_heights_m(at_rad[None])[0])
        is_outward = np.hypot(*out[:2]) > _SPRAWLING * chain.length_m
        if is_outward and height_m < -_KNEE_SHARE * chain.length_m:
            return True
    return False


def _posture(robot: RobotWithLegs, number: int, *, knees_up: bool) -> Angles:
    rng = np.random.default_rng(0)
    first: FloatArray | None = None
    posture = []
    for chain in robot.chains:
        is_alike = first is not None and len(first) == len(chain.axes)
        wanted = _wanted(chain, robot.torso_bottom_m, number)
        best = _best(chain, wanted, first if is_alike else None, rng, knees_up=knees_up)
        first = best if first is None else first
        posture.append(best)
    return posture


def _wanted(chain: LegChain, torso_bottom_m: float, number: int) -> FloatArray:
    """Return the target of a foot relative to its mount, as shares of the leg's length, (3,).

    The target is well below, and outward in the direction of the leg at the angles 0.

    Args:
        chain: the leg.
        torso_bottom_m: lowest point of the torso.
        number: number of the posture; each is a bit lower than the one before, or wider.
    """
    mount = chain.anchors[0]
    straight = (chain.foot - mount) / chain.length_m
    least = (mount[2] - torso_bottom_m) / chain.length_m + _LEAST_UNDER
    out = float(np.linalg.norm(straight[:2]))
    if out > _SPRAWLING:
        down, wide = _SPRAWLED[number]
        at = wide * straight[:2] / out
    else:
        down = _UPRIGHT[number]
        at = np.array([_ASTRIDE * straight[0], 0.0])
    return np.array([*at, -max(down, least)])


def _best(
    chain: LegChain,
    wanted: FloatArray,
    like: FloatArray | None,
    rng: np.random.Generator,
    *,
    knees_up: bool,
) -> FloatArray:
    """Return the angles of least cost: many at random, then nearer and nearer to the best."""
    low, high = np.clip(chain.limits, -_WITHOUT_LIMIT_RAD, _WITHOUT_LIMIT_RAD)
    angles = rng.uniform(low, high, (_SAMPLES, len(low)))

    def costs(angles: FloatArray) -> FloatArray:
        below = np.maximum(0, -chain.knee_heights_m(angles) / chain.length_m) if knees_up else 0
        return _costs(chain, angles, wanted, like) + _KNEE_COST * below

    best: FloatArray = angles[int(costs(angles).argmin())]
    spread = 0.25
    for _ in range(_ROUNDS):
        near = best + rng.normal(0, spread, (_NEAR, len(low)))
        near = np.concatenate([best[None], np.clip(near, low, high)])
        best = near[int(costs(near).argmin())]
        spread *= 0.4
    return best


def _costs(
    chain: LegChain, angles: FloatArray, wanted: FloatArray, like: FloatArray | None
) -> FloatArray:
    """Return the cost of a leg's stance at each row of angles, (k,).

    The cost is low with the foot at its target, a Jacobian far from singular, and angles that are
    small, far from their limits, and like those of the first leg.
    """
    length_m = chain.length_m
    feet = (chain.feet(angles) - chain.anchors[0]) / length_m
    costs: FloatArray = 3 * ((feet - wanted) ** 2).sum(axis=1)
    if angles.shape[1] >= FOLLOWING_JOINTS:
        least = np.linalg.svd(chain.slopes(angles) / length_m, compute_uv=False)[:, 2]
        costs += 4 * np.maximum(0, 0.25 - least) ** 2
    low, high = chain.limits
    margin = np.minimum(angles - low, high - angles)
    costs += 0.3 * (np.maximum(0, 0.35 - margin) ** 2).sum(axis=1)
    costs += 0.004 * (angles**2).sum(axis=1)
    if like is not None:
        costs += 0.05 * ((np.abs(angles) - np.abs(like)) ** 2).sum(axis=1)
    return costs
