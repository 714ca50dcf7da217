"""Tells whether a robot topples: where its centre of mass is over the feet that stand."""

from collections.abc import Sequence
from statistics import fmean

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import AnyGait, GaitSpec, gait_spec, resolve
from hexapods.domain.model_geometry import home_angles, leg_chains, link_frames
from hexapods.domain.model_robot import leg_length_m, model_robot
from hexapods.domain.robot_model import RobotModel
from hexapods.domain.sums import ordered_sum
from hexapods.domain.support import STANDS_M, Support
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Choices
from hexapods.imports.legs.heights import Heights
from hexapods.imports.notes import Notes

_FALL_SHARE = 0.1
"""On two feet a robot falls for as short as a swing takes; none of those that were read toppled
with its centre of mass nearer than this share of its legs to the line between them."""
_NARROW, _WIDE_ENOUGH = 0.36, 0.42
"""Distance of the centre of mass from the edge of the feet by its height: Laikago, with 0.34,
toppled in a trot; none that was read did with 0.37."""


def tell_of_balance(
    model: RobotModel, gait: AnyGait, heights: Heights | None, notes: Notes
) -> None:
    """Tell if the robot topples as it stands, or while a group of legs swings, with other groups.

    Args:
        model: the robot.
        gait: the groups of legs.
        heights: at which it can stand.
        notes: gets the guess.

    Raises:
        InvalidInput: if the gait does not divide the legs.
    """
    robot = model_robot(model, "robot")
    resolved = resolve(gait, robot.azimuths_deg)
    x, y, z = center_of_mass_m(model).tolist()
    support = Support.of_points(robot.homes_m, (x, y))
    margin_m = support.margin_m()
    if margin_m < STANDS_M:
        notes.guess(
            "stance",
            f"its centre of mass is {_millimetres(margin_m)} outside its feet: it topples as it "
            "stands",
        )
        return
    chains = leg_chains(model, home_angles(model))
    margins = {group: support.margin_m(group) for group in resolved.groups}
    on_two_feet = [group for group in margins if len(model.feet) - len(group) < 3]
    tipping = [
        group
        for group, margin_m in margins.items()
        if margin_m < (-_FALL_SHARE * leg_length_m(chains) if group in on_two_feet else STANDS_M)
    ]
    if not tipping:
        if on_two_feet:
            height_m = -fmean(float(chain.foot_m[2]) for chain in chains)
            _tell_of_height(margin_m, height_m, z, heights, notes)
        return
    worst = min(tipping, key=lambda group: margins[group])
    groups = support.steadiest_groups()
    spec = gait_spec(gait)
    offer = GaitSpec(spec.right_leg, spec.left_leg, groups=groups)
    is_better = support.least_margin_m(groups) > margins[worst] and _divides(
        offer, robot.azimuths_deg
    )
    notes.guess(
        "groups",
        f"it topples while legs {' '.join(map(str, worst))} swing: its centre of mass is "
        f"{_millimetres(margins[worst])} outside the feet that stand"
        + (f"; better groups are {_written(groups)}" if is_better else ""),
        offer=Choices(gait=offer) if is_better else None,
    )


def _tell_of_height(
    margin_m: float, height_m: float, center_m: float, heights: Heights | None, notes: Notes
) -> None:
    """Tell if the robot is too high for its width to walk on two feet at a time.

    Args:
        margin_m: distance of its centre of mass from the edge of the polygon of all feet.
        height_m: height of the torso's centre above the feet.
        center_m: height of the centre of mass above the torso's centre.
        heights: at which it can stand.
        notes: gets the guess.
    """
    if margin_m >= _NARROW * (height_m + center_m):
        return
    lower_m = margin_m / _WIDE_ENOUGH - center_m
    if heights is not None:
        lower_m = max(lower_m, heights.lowest)
    is_possible = heights is not None and lower_m < height_m
    lower_m = round(lower_m, 3)
    notes.guess(
        "stance",
        f"it may topple in this gait: its centre of mass is {1000 * (height_m + center_m):.0f} mm "
        f"above its feet, but {1000 * margin_m:.0f} mm from the edge between them"
        + (f"; let it stand {lower_m:g} m high" if is_possible else ""),
        offer=Choices(body_height_m=lower_m) if is_possible else None,
    )


def center_of_mass_m(model: RobotModel) -> FloatArray:
    """Return the centre of mass at home in the body frame, (3,) [m]."""
    frames = link_frames(model, home_angles(model))
    total_kg = ordered_sum(link.mass_kg for link in model.links)
    moments = (
        link.mass_kg * frame.point(link.center_m)
        for link, frame in zip(model.links, frames, strict=True)
    )
    center: FloatArray = ordered_sum(moments, np.zeros(3)) / total_kg
    return center


def _divides(gait: GaitSpec, azimuths_deg: Sequence[float]) -> bool:
    try:
        resolve(gait, azimuths_deg)
    except InvalidInput:
        return False
    return True


def _millimetres(margin_m: float) -> str:
    return f"{-1000 * margin_m:.0f} mm"


def _written(groups: tuple[tuple[int, ...], ...]) -> str:
    return "; ".join(" ".join(map(str, group)) for group in groups)
