"""Checks the size and the mass of a robot, and offers another reading where they do not fit."""

from collections.abc import Sequence

from hexapods.domain.errors import InvalidInput
from hexapods.imports.choices import Choices
from hexapods.imports.legs.chain import LegChain
from hexapods.imports.legs.feet import Foot
from hexapods.imports.notes import Notes, quoted

_USUAL_RATIO = 150.0
"""Mass by the cube of a leg's length of robots that people publish, 20 to 600 [kg/m³]."""
_LARGE, _SMALL = 0.18, 4.0
"""Factor of the lengths, beyond which they are more likely wrong than the robot unusual."""
_LEAST_KG, _MOST_KG = 0.02, 500.0
"""Outside of these masses a robot with the usual ratio is offered another scale."""
_SHORT_LEG_M = 0.06
"""Below it the lengths of a robot that is too heavy are more likely wrong than its mass."""
_SCALES = (0.001, 0.01, 0.0254, 0.1, 10.0, 100.0, 1000.0)

_LEAST_LEG_M, _MOST_LEG_M = 0.01, 5.0
_LEAST_FOOT_M, _MOST_FOOT_M = 0.001, 2.0
_LEAST_ROBOT_KG, _MOST_ROBOT_KG = 0.001, 10_000.0
_OTHER_UNIT = "`scale` reads the lengths of the file in another unit, 0.001 in millimetres"


def check_legs(chains: Sequence[LegChain], feet: Sequence[Foot]) -> None:
    """Check the length of each leg and the radius of its foot.

    Raises:
        InvalidInput: if one is too large or too small.
    """
    for number, (chain, foot) in enumerate(zip(chains, feet, strict=True), start=1):
        if not _LEAST_LEG_M <= chain.length_m <= _MOST_LEG_M:
            raise InvalidInput(
                f"leg {number} (to {quoted(foot.name)}) is {chain.length_m:.3g} m long; a leg has "
                f"from {_LEAST_LEG_M:g} to {_MOST_LEG_M:g} m: {_OTHER_UNIT}"
            )
        if not _LEAST_FOOT_M <= foot.radius_m <= _MOST_FOOT_M:
            raise InvalidInput(
                f"the foot {quoted(foot.name)} has a radius of {foot.radius_m:.3g} m; a foot has "
                f"from {_LEAST_FOOT_M:g} to {_MOST_FOOT_M:g} m: {_OTHER_UNIT}"
            )


def check_mass(mass_kg: float) -> None:
    """Check the mass of a robot.

    Raises:
        InvalidInput: if it is too heavy or too light.
    """
    if not _LEAST_ROBOT_KG <= mass_kg <= _MOST_ROBOT_KG:
        raise InvalidInput(
            f"it weighs {weight(mass_kg)}; a robot has from {_LEAST_ROBOT_KG:g} to "
            f"{_MOST_ROBOT_KG:,.0f} kg: {_OTHER_UNIT}, which masses by density follow; `mass_kg` "
            "is what it should weigh"
        )


def tell_of_size(mass_kg: float, leg_m: float, height_m: float, notes: Notes) -> None:
    """Offer a scale, or a mass, for a robot that is too light or too heavy for its size.

    Args:
        mass_kg: the mass that the file gives.
        leg_m: mean length of its legs.
        height_m: how high it stands.
        notes: gets the offer.
    """
    fitting = (mass_kg / (_USUAL_RATIO * leg_m**3)) ** (1 / 3)
    size = f"it stands {_metres(height_m)} high and weighs {weight(mass_kg)}"
    usual_kg = float(f"{_USUAL_RATIO * leg_m**3:.1g}")
    if fitting < _LARGE or (fitting < _SMALL and mass_kg > _MOST_KG):
        # Of both too large the lengths are read anew: masses by density follow them.
        scale = _nearest(fitting) if fitting < _LARGE else 0.1
        notes.guess("size", f"{size}: read it at 1:{1 / scale:g}?", offer=Choices(scale=scale))
    elif fitting > _SMALL and leg_m < _SHORT_LEG_M:
        scale = max(_nearest(fitting), 10.0)
        notes.guess("size", f"{size}: read it at {scale:g}:1?", offer=Choices(scale=scale))
    elif fitting > _SMALL:
        notes.guess(
            "size",
            f"{size}, far too much for its size: with {weight(usual_kg)} it would be usual",
            offer=Choices(mass_kg=usual_kg),
        )
    elif mass_kg < _LEAST_KG:
        scale = max(_nearest((1 / mass_kg) ** (1 / 3)), 10.0)
        notes.guess("size", f"{size}: read it at {scale:g}:1?", offer=Choices(scale=scale))


def weight(mass_kg: float) -> str:
    """Return a mass with a unit that makes it short."""
    if mass_kg >= 1000:
        return f"{mass_kg / 1000:.3g} t"
    if mass_kg >= 0.1:
        return f"{mass_kg:.3g} kg"
    return f"{1000 * mass_kg:.3g} g" if mass_kg >= 1e-4 else f"{1e6 * mass_kg:.3g} mg"


def _metres(length_m: float) -> str:
    return f"{length_m:.2g} m" if length_m >= 0.1 else f"{1000 * length_m:.2g} mm"


def _nearest(factor: float) -> float:
    """Return the usual scale that is nearest to a factor, by their ratio."""
    return min(_SCALES, key=lambda scale: max(scale / factor, factor / scale))
