"""Mass, centre of mass and inertia of links, and guesses where the file gives none."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import LEAST_KG
from hexapods.imports.notes import Notes, listed
from hexapods.imports.posed_robot import PosedRobot

_DENSITY = 500.0
"""Density of shapes whose mass is guessed [kg/m³]: half that of water, since robots are hollow."""
_NO_MASS_KG = 1e-5
_PLACEHOLDER_KG, _PLACEHOLDER_SHARE = 0.01, 0.06
"""Placeholders weigh less, and less than this share of what their shapes would."""
_REAL_KG, _UNLIKELY_RATIO = 0.02, 10.0
"""Placeholders are not worth so much more than other links that weigh more than this."""
_ROD_WIDTH = 0.1
"""Width of a rod of a link without shapes, as a share of its length."""
_SAME = 1e-3
_SHARE = 0.05
"""Share of the robot's mass that a link without mass and shapes gets."""
_LEAST_INERTIA = 1e-9


@dataclass(frozen=True, eq=False)
class Mass:
    """Mass of a link.

    Attributes:
        kg: its mass.
        center_m: its centre in the body frame, (3,).
        inertia: about the centre, in the body frame, (3, 3) [kg·m²].
    """

    kg: float
    center_m: FloatArray
    inertia: FloatArray


def mass_in_file_kg(posed: PosedRobot) -> float:
    """Return the mass that the file gives the robot, without what is guessed."""
    return ordered_sum(
        float(posed.compiled.model.body_mass[body]) for body in posed.skeleton.bodies
    )


def find_masses(
    posed: PosedRobot,
    links: Mapping[int | None, str],
    ends: Mapping[int | None, FloatArray],
    choices: Choices,
    notes: Notes,
    *,
    are_whole: bool = False,
) -> dict[int | None, Mass]:
    """Return the mass of each link.

    Args:
        posed: the robot.
        links: name of each link, by the joint that moves it; None for the torso.
        ends: two points of each link, (2, 3), between which one without shapes lies.
        choices: what a person decided.
        notes: gets the guesses.
        are_whole: whether each mass in the file is that of its link, however small.

    Raises:
        InvalidInput: if no link has a mass or a shape.
    """
    more = 0.0 if are_whole else _LEAST_INERTIA
    masses = {joint: mass_of(posed, posed.bodies_of(joint), more) for joint in links}
    # A body with two joints is two links, the first of which has nothing.
    between = {joint for joint in links if joint is not None and not posed.bodies_of(joint)}
    weighed = [] if are_whole else [joint for joint in links if joint not in between]
    by_shapes = {
        joint: _of_shapes(posed, posed.geoms_of(posed.bodies_of(joint)))
        for joint in weighed
        if masses[joint].kg < _PLACEHOLDER_KG
    }
    expected_kg = {joint: _expected_kg(posed, joint, ends[joint]) for joint in by_shapes}
    placeholders = _placeholders({joint: masses[joint].kg for joint in by_shapes}, expected_kg)
    other_kg = ordered_sum(masses[joint].kg for joint in weighed if joint not in placeholders)
    missing_kg = ordered_sum(expected_kg[joint] for joint in placeholders)
    if other_kg > _REAL_KG and missing_kg > _UNLIKELY_RATIO * other_kg:
        # All is light for its size: the lengths are in another unit.
        placeholders = []
    unknown = [
        joint for joint in weighed if masses[joint].kg < _NO_MASS_KG or joint in placeholders
    ]
    known_kg = ordered_sum(mass.kg for joint, mass in masses.items() if joint not in unknown)
    shaped = [by_shapes[joint] for joint in unknown]
    shaped_kg = ordered_sum(mass.kg for mass in shaped if mass is not None)
    if known_kg < _NO_MASS_KG and shaped_kg <= 0:
        raise InvalidInput(
            "no link has a mass, nor a shape by which to guess one: give the links <inertial>"
        )
    for joint in unknown:
        of_shapes = by_shapes[joint]
        kg = _SHARE * (known_kg + shaped_kg)
        ball = _ball(max(kg, LEAST_KG), ends[joint].mean(axis=0), ends[joint])
        masses[joint] = ball if of_shapes is None or of_shapes.kg < LEAST_KG else of_shapes
    for joint in between:
        masses[joint] = Mass(LEAST_KG, ends[joint][0], np.eye(3) * _LEAST_INERTIA)
    _tell(
        [links[joint] for joint in unknown if joint not in placeholders],
        [links[joint] for joint in placeholders],
        notes,
    )
    return masses if choices.mass_kg is None else _weighing(masses, choices.mass_kg)


def _weighing(masses: Mapping[int | None, Mass], total_kg: float) -> dict[int | None, Mass]:
    """Return masses in the same ratios with another sum."""
    factor = total_kg / ordered_sum(mass.kg for mass in masses.values())
    return {
        joint: Mass(max(factor * mass.kg, LEAST_KG), mass.center_m, factor * mass.inertia)
        for joint, mass in masses.items()
    }


def _placeholders(
    kg: Mapping[int | None, float], expected_kg: Mapping[int | None, float]
) -> list[int | None]:
    """Return the links whose masses only stand in the file because programs want some.

    Such a mass is far below what the link would weigh, and the same for several links; where light
    links all differ, they are weighed in another unit.
    """
    light = [
        joint
        for joint, mass_kg in kg.items()
        if _NO_MASS_KG <= mass_kg < _PLACEHOLDER_SHARE * expected_kg[joint]
    ]
    values = sorted(kg[joint] for joint in light)
    distinct = sum(
        below * (1 + _SAME) < above for below, above in zip([0.0, *values], values, strict=False)
    )
    return light if distinct <= max(3, len(light) // 4) else []


def _expected_kg(posed: PosedRobot, joint: int | None, ends: FloatArray) -> float:
    """Return what a link would weigh by its shapes, or as a rod between its ends, (2, 3).

    Boxes have the axes of each shape, since those around a slanted rod are nearly empty.
    """
    geoms = posed.geoms_of(posed.bodies_of(joint))
    colliding = [geom for geom in geoms if posed.compiled.collides[geom]]
    volumes = [_volume(posed.own_surface(geom)[0]) for geom in colliding or geoms]
    if (volume := ordered_sum(volumes)) > 0:
        return 0.5 * _DENSITY * volume
    length_m = float(np.linalg.norm(ends[1] - ends[0]))
    return _DENSITY * length_m * (_ROD_WIDTH * length_m) ** 2


def _volume(vertices: FloatArray) -> float:
    """Return the volume of the box around points, (n, 3) [m³]."""
    return float(np.prod(np.ptp(vertices, axis=0))) if len(vertices) else 0.0


def _tell(without: Sequence[str], placeholders: Sequence[str], notes: Notes) -> None:
    if without:
        notes.guess(
            "masses",
            f"the file gives no mass for {listed(without)}: guessed by its shapes or by the others",
            parts=without,
        )
    if placeholders:
        notes.guess(
            "masses",
            f"the masses in the file of {listed(placeholders)} are placeholders, far below what "
            "such links weigh: guessed by their shapes or by the others",
            parts=placeholders,
        )


def mass_of(posed: PosedRobot, bodies: Sequence[int], more_inertia: float = 0.0) -> Mass:
    """Return the mass of some bodies together, as the file gives it.

    Args:
        posed: the robot.
        bodies: the bodies.
        more_inertia: is added to the inertia about each axis, which may be 0 in a file [kg·m²].
    """
    masses = posed.compiled.model.body_mass
    body_masses = [
        Mass(float(masses[body]), posed.center_of_mass(body), posed.inertia(body))
        for body in bodies
        if masses[body] > 0
    ]
    kg = ordered_sum(mass.kg for mass in body_masses)
    if kg <= 0:
        return Mass(0.0, np.zeros(3), np.zeros((3, 3)))
    center = ordered_sum((mass.kg * mass.center_m for mass in body_masses), np.zeros(3)) / kg
    inertia = np.zeros((3, 3))
    for mass in body_masses:
        out = mass.center_m - center
        inertia += mass.inertia + mass.kg * (out @ out * np.eye(3) - np.outer(out, out))
    return Mass(kg, center, inertia + more_inertia * np.eye(3))


def _of_shapes(posed: PosedRobot, geoms: Sequence[int]) -> Mass | None:
    """Return the mass of the boxes around shapes; None if there are none."""
    colliding = [geom for geom in geoms if posed.compiled.collides[geom]]
    boxes = []
    for geom in colliding or geoms:
        vertices, _ = posed.surface(geom)
        if len(vertices):
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            # Round shapes and meshes fill about half of the box around them.
            kg = 0.5 * _DENSITY * float(np.prod(high - low))
            boxes.append(_ball(kg, (low + high) / 2, np.array([low, high])))
    kg = ordered_sum(box.kg for box in boxes)
    if kg <= 0:
        return None
    center = ordered_sum((box.kg * box.center_m for box in boxes), np.zeros(3)) / kg
    return Mass(kg, center, ordered_sum((box.inertia for box in boxes), np.zeros((3, 3))))


def _ball(kg: float, center: FloatArray, ends: FloatArray) -> Mass:
    radius = max(float(np.linalg.norm(ends[1] - ends[0])) / 2, 0.005)
    return Mass(kg, center, 0.4 * kg * radius**2 * np.eye(3))
