"""Finds which axis of a file is up, by where its legs are."""

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Axis, Choices
from hexapods.imports.compiling import Compiled
from hexapods.imports.legs.feet import FoundLeg
from hexapods.imports.legs.skeleton import Skeleton, find_skeleton
from hexapods.imports.notes import Notes
from hexapods.imports.posed_robot import initial_pose
from hexapods.imports.units import turn_upright

_OTHER_UPS: Sequence[Axis] = ("y", "-y", "x", "-x", "-z")
_USUAL_UPS: Sequence[Axis] = ("y", "-y")
"""Of these a person is asked: with others two-legged robots lie on four limbs."""
_BELOW_SHARE = 0.25
"""Least depth of each foot below its mount, of the distance between them, by which up is sure."""
_LEVEL_SHARE = 0.3
"""Largest difference of heights of the mounts, of the size of the robot."""


def find_upright(compiled: Compiled, choices: Choices, notes: Notes) -> tuple[Skeleton, Axis]:
    """Return torso and legs, and the axis of the file that is up; the model is turned.

    Up is z, unless a person has chosen another axis, or only with another one there are legs, all
    of whose feet are below.

    Raises:
        InvalidInput: if there are not 3 to 12 legs of 2 to 6 joints.
    """
    if choices.up is not None:
        turn_upright(compiled.model, choices.up)
        return find_skeleton(compiled, initial_pose(compiled.model), choices, notes), choices.up
    try:
        skeleton = find_skeleton(compiled, initial_pose(compiled.model), choices, notes)
    except InvalidInput as error:
        possible = list(_possible_ups(compiled, choices)) if choices.feet is None else []
        sure = [up for up, is_sure in possible if is_sure]
        if sure:
            turn_upright(compiled.model, sure[0])
            notes.guess(
                "base", f"{sure[0]} of the file is up: with z up it has no legs to stand on"
            )
            skeleton = find_skeleton(compiled, initial_pose(compiled.model), choices, notes)
            return skeleton, sure[0]
        asked = [up for up, _ in possible if up in _USUAL_UPS]
        if asked:
            up = asked[0]
            notes.guess("base", f"is {up} of the file up?", offer=Choices(up=up))
            raise InvalidInput(f"{error}; or choose the axis that is up, such as {up}") from error
        raise
    _tell_of_wall(compiled, skeleton, notes)
    return skeleton, "z"


def _possible_ups(compiled: Compiled, choices: Choices) -> Iterator[tuple[Axis, bool]]:
    """Iterate over the axes with which there are level legs, and whether all feet are below."""
    for up in _OTHER_UPS:
        turn_upright(compiled.model, up)
        try:
            skeleton = find_skeleton(compiled, initial_pose(compiled.model), choices, Notes())
        except InvalidInput:
            continue
        else:
            mounts, feet = _places(compiled, skeleton.legs)
            size_m = float(np.ptp(np.concatenate([mounts, feet]), axis=0).max())
            if np.ptp(mounts[:, 2]) > _LEVEL_SHARE * size_m:
                continue
            lengths = np.linalg.norm(feet - mounts, axis=1)
            yield up, bool((mounts[:, 2] - feet[:, 2] > _BELOW_SHARE * lengths).all())
        finally:
            turn_upright(compiled.model, "z", before=up)


def _tell_of_wall(compiled: Compiled, skeleton: Skeleton, notes: Notes) -> None:
    """Ask whether another axis is up if all legs are mounted in a plane that stands upright."""
    mounts, feet = _places(compiled, skeleton.legs)
    extents = np.ptp(mounts, axis=0)
    across = int(extents[:2].argmin())
    if extents[2] > 0.5 * extents[1 - across] and extents[across] < 0.2 * extents[2]:
        is_below = float((feet - mounts)[:, across].mean()) <= 0
        up: Axis = ("x", "y")[across] if is_below else ("-x", "-y")[across]
        notes.guess(
            "base",
            f"legs are mounted one above the other: is {up} of the file up, not z?",
            offer=Choices(up=up),
        )


def _places(compiled: Compiled, legs: Sequence[FoundLeg]) -> tuple[FloatArray, FloatArray]:
    """Return the mounts and the feet of legs, each (legs, 3) [m]."""
    data = mujoco.MjData(compiled.model)
    data.qpos[:] = initial_pose(compiled.model)
    mujoco.mj_kinematics(compiled.model, data)
    mounts = data.xanchor[[leg.joints[0] for leg in legs]]
    return mounts, np.array([leg.foot.in_world(data) for leg in legs])
