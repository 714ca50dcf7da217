"""Finds the direction in which a robot walks, and numbers its legs."""

import math
from collections.abc import Mapping, Sequence
from typing import get_args

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec, resolve
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Axis, Choices
from hexapods.imports.legs.sides import Side, contradict, sides_by_names
from hexapods.imports.notes import Notes, listed, quoted
from hexapods.imports.units import horizontal_axes

_AHEAD_DEG = 90.0
"""Forward in the body frame."""
_NEARLY_DEG = 1.0
_APART_SHARE, _ROUND_SHARE = 0.05, 0.05
"""Least distance of a leg from the line between two columns, of the size of the robot; largest
deviation of evenly spaced legs [of their radius, and rad]."""


def find_forward(
    mounts: FloatArray,
    names: Sequence[Sequence[str]],
    up: Axis,
    choices: Choices,
    notes: Notes,
) -> float:
    """Return the direction in which the robot walks, as `Choices.forward` has it [°].

    Args:
        mounts: places of the legs' mounts from above, (legs, 2).
        names: names of the joints and bodies of each leg.
        up: axis of the file that points up.
        choices: choices of a person.
        notes: collects the guess.

    Raises:
        InvalidInput: if the chosen direction is not valid.
    """
    axes = horizontal_axes(up)
    if choices.forward is not None:
        return _chosen(choices.forward, axes, up)
    sides = sides_by_names(mounts, names)
    front, hind, left, right = (sides[side] for side in get_args(Side))
    offer = None
    if contradict(sides) and front is not None and hind is not None:
        ahead, _ = _without_names(mounts)
        why = "since the names of the legs contradict their places"
        by_names = _nearest_axis(front - hind, axes)
        offer = Choices(forward=by_names) if by_names != _nearest_axis(ahead, axes) else None
    elif front is not None and hind is not None:
        ahead, why = front - hind, "by the names of the legs in front and behind"
    elif left is not None and right is not None:
        across = left - right
        ahead, why = np.array([across[1], -across[0]]), "by the names of the legs left and right"
    else:
        ahead, why = _without_names(mounts)
        offer = Choices(forward=_nearest_axis(-ahead, axes))
    axis = _nearest_axis(ahead, axes)
    notes.guess("forward", f"forward is {axis} of the file's frame, {why}", offer=offer)
    return axes[axis]


def _nearest_axis(ahead: FloatArray, axes: Mapping[Axis, float]) -> Axis:
    angle = math.degrees(math.atan2(ahead[1], ahead[0]))
    return min(axes, key=lambda name: abs(_wrapped(angle - axes[name])))


def _without_names(mounts: FloatArray) -> tuple[FloatArray, str]:
    """Return a direction to walk in, and why: along two columns of legs, or x."""
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    if not _are_round(mounts) and not _are_columns(mounts, 0) and _are_columns(mounts, 1):
        return y, "along the two columns of legs, since no name tells"
    if _asymmetry(mounts, 1) <= _asymmetry(mounts, 0) + 1e-6:
        return x, "as in most files, since no name tells"
    return y, "since the legs are symmetric to that axis"


def _are_columns(mounts: FloatArray, axis: int) -> bool:
    """Whether as many legs are on both sides of an axis, each with another one opposite to it."""
    centred = mounts - (mounts.min(axis=0) + mounts.max(axis=0)) / 2
    size_m = float(np.abs(centred).max())
    across = centred[:, 1 - axis]
    is_apart = bool((np.abs(across) > _APART_SHARE * size_m).all())
    is_even = 2 * int((across > 0).sum()) == len(mounts)
    return (
        is_apart and is_even and _asymmetry(mounts, 1 - axis) < _APART_SHARE * size_m * len(mounts)
    )


def _are_round(mounts: FloatArray) -> bool:
    """Whether the legs are evenly spaced on a circle, where any direction is as good."""
    centred = mounts - (mounts.min(axis=0) + mounts.max(axis=0)) / 2
    radii = np.linalg.norm(centred, axis=1)
    azimuths = np.sort(np.arctan2(centred[:, 1], centred[:, 0]))
    gaps = np.diff([*azimuths, azimuths[0] + 2 * np.pi])
    return bool(np.ptp(radii) < _ROUND_SHARE * radii.max() and np.ptp(gaps) < _ROUND_SHARE)


def _chosen(forward: str | float, axes: Mapping[Axis, float], up: Axis) -> float:
    for axis, angle in axes.items():
        if forward == axis:
            return angle
    try:
        angle = float(forward)
    except ValueError:
        angle = math.nan
    if not math.isfinite(angle) or abs(angle) > 360:
        raise InvalidInput(
            f"forward must be {listed(axes)} or an angle in degrees, -360 to 360, since {up} of "
            f"the file is up; not {quoted(str(forward))}"
        )
    return angle


def _asymmetry(mounts: FloatArray, mirrored: int) -> float:
    """Return the sum of the mounts' distances to the nearest mount mirrored in a coordinate [m]."""
    centred = mounts - (mounts.min(axis=0) + mounts.max(axis=0)) / 2
    image = centred.copy()
    image[:, mirrored] *= -1
    distances = np.linalg.norm(centred[:, None] - image[None], axis=2)
    return float(distances.min(axis=1).sum())


def _wrapped(angle_deg: float) -> float:
    return (angle_deg + 180) % 360 - 180


def numbered(places: FloatArray) -> list[int]:
    """Return indices of legs anticlockwise from the front right one.

    Args:
        places: places of the legs in the body frame, x right and y forward, (legs, 2).
    """
    azimuths = np.degrees(np.arctan2(places[:, 1], places[:, 0]))
    right = [leg for leg, azimuth in enumerate(azimuths) if abs(azimuth) < _AHEAD_DEG - 1e-6]
    start = max((azimuths[leg] for leg in right), default=-_AHEAD_DEG)
    order = np.round((azimuths - start) % 360, 6) % 360
    return sorted(range(len(places)), key=lambda leg: float(order[leg]))


def find_gait(places: FloatArray, choices: Choices, notes: Notes) -> str | GaitSpec:
    """Return the gait: the groups of legs that move together.

    Args:
        places: places of the mounts in the body frame, in the order of the legs, (legs, 2).
        choices: choices of a person.
        notes: collects the guess.

    Raises:
        InvalidInput: if the chosen gait does not fit the legs.
    """
    azimuths = np.degrees(np.arctan2(places[:, 1], places[:, 0])).tolist()
    if choices.gait is not None:
        resolve(choices.gait, azimuths)
        return choices.gait
    name = {4: "trot", 6: "tripod", 8: "tetrapod"}.get(len(places))
    if name is not None and _leads_ahead(name, azimuths):
        spec: str | GaitSpec = name
    else:
        spec = _by_hand(name, azimuths)
    gait = resolve(spec, azimuths)
    groups = "; ".join(" ".join(map(str, group)) for group in gait.groups)
    notes.guess(
        "groups",
        f"legs move in {counted(len(gait.groups), 'group')}: {groups}"
        + ("" if name is None or spec != name else f" ({name})"),
    )
    return spec


def _leads_ahead(gait: str, azimuths: Sequence[float]) -> bool:
    """Whether a gait makes sense for these legs, and goes forward."""
    try:
        return abs(_wrapped(resolve(gait, azimuths).forward_deg - _AHEAD_DEG)) < _NEARLY_DEG
    except InvalidInput:
        return False


def _by_hand(name: str | None, azimuths: Sequence[float]) -> GaitSpec:
    """Return groups of legs, and the two legs between which the forward direction lies."""
    legs = range(1, len(azimuths) + 1)

    def off(pair: tuple[int, int]) -> float:
        right, left = (azimuths[leg - 1] for leg in pair)
        return abs(_wrapped(right + ((left - right) % 360) / 2 - _AHEAD_DEG))

    pairs = [(right, left) for right in legs for left in legs if right != left]
    right, left = min(pairs, key=lambda pair: (round(off(pair), 3), pair))
    if name is not None:
        try:
            spec = GaitSpec(right, left, groups=name)  # type: ignore[arg-type]  # a grouping
            resolve(spec, azimuths)
        except InvalidInput:
            pass
        else:
            return spec
    odd, even = tuple(legs)[::2], tuple(legs)[1::2]
    if len(azimuths) % 2 == 0:
        groups: tuple[tuple[int, ...], ...] = (odd, even)
    elif len(azimuths) == 3:
        groups = tuple((leg,) for leg in legs)
    else:
        # Neighbours of one group would leave a side without a leg that stands.
        groups = (odd[:-1], even, odd[-1:])
    return GaitSpec(right, left, groups=groups)
