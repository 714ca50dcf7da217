"""Finds the direction in which a robot walks, and numbers its legs."""

import math
import re
from collections.abc import Mapping, Sequence

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec, resolve
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Axis, Choices
from hexapods.imports.notes import Notes, listed, quoted
from hexapods.imports.units import horizontal_axes

_SHORT = {
    "front": frozenset(["fl", "fr", "lf", "rf"]),
    "hind": frozenset(["hl", "hr", "lh", "rh", "bl", "br", "lb", "rb", "rl", "rr", "lr"]),
    "left": frozenset(["l", "fl", "lf", "hl", "lh", "bl", "lb", "rl", "lr", "ml", "lm"]),
    "right": frozenset(["r", "fr", "rf", "hr", "rh", "br", "rb", "rr", "mr", "rm"]),
}
_LONG = {
    "front": ("front", "fore"),
    "hind": ("hind", "rear", "back"),
    "left": ("left",),
    "right": ("right",),
}
_AHEAD_DEG = 90.0
"""Forward in the body frame."""
_NEARLY_DEG = 1.0


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
    at = {word: _mean(mounts, names, word) for word in _SHORT}
    front, hind, left, right = at["front"], at["hind"], at["left"], at["right"]
    if _contradict(front, hind, left, right):
        ahead, why = np.array([1.0, 0.0]), "since the names of the legs contradict their places"
    elif front is not None and hind is not None:
        ahead, why = front - hind, "by the names of the legs in front and behind"
    elif left is not None and right is not None:
        across = left - right
        ahead, why = np.array([across[1], -across[0]]), "by the names of the legs left and right"
    elif _asymmetry(mounts, 1) <= _asymmetry(mounts, 0) + 1e-6:
        ahead, why = np.array([1.0, 0.0]), "as in most files, since no name tells"
    else:
        ahead, why = np.array([0.0, 1.0]), "since the legs are symmetric to that axis"
    angle = math.degrees(math.atan2(ahead[1], ahead[0]))
    axis = min(axes, key=lambda name: abs(_wrapped(angle - axes[name])))
    notes.guess("forward", f"forward is {axis} of the file's frame, {why}")
    return axes[axis]


def _contradict(
    front: FloatArray | None,
    hind: FloatArray | None,
    left: FloatArray | None,
    right: FloatArray | None,
) -> bool:
    """Whether the left legs are on the right, seen in the direction from hind to front legs."""
    if front is None or hind is None or left is None or right is None:
        return False
    ahead, across = front - hind, left - right
    return float(ahead[0] * across[1] - ahead[1] * across[0]) <= 0


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


def _mean(mounts: FloatArray, names: Sequence[Sequence[str]], word: str) -> FloatArray | None:
    """Return the mean place of the legs whose names have a word; None if none have."""
    other = {"front": "hind", "hind": "front", "left": "right", "right": "left"}[word]
    named = [_has(words, word) and not _has(words, other) for words in names]
    return mounts[named].mean(axis=0) if any(named) else None


def _has(names: Sequence[str], word: str) -> bool:
    for name in names:
        apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
        words = re.split(r"[^a-z]+", apart)
        if any(long_word in apart for long_word in _LONG[word]) or _SHORT[word] & {*words}:
            return True
    return False


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
