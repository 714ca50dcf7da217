"""Checks links against the limits of a `RobotModel`, in the words of the file."""

from collections.abc import Sequence

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot_model import (
    MAX_SIZE_M,
    MAX_TRIANGLES,
    ModelFoot,
    ModelLink,
    RobotModel,
)

_LEAST_KG, _MOST_KG = 1e-6, 1000.0
_OTHER_UNIT = "`scale` reads the file in another unit of length, 0.001 in millimetres"


def checked_model(links: Sequence[ModelLink], feet: Sequence[ModelFoot]) -> RobotModel:
    """Return a model, after a check of what its links weigh and how large they are.

    Raises:
        InvalidInput: naming the body of the file, and what is valid.
    """
    _check(links)
    try:
        return RobotModel(tuple(links), tuple(feet))
    except InvalidInput as error:
        # It speaks of a stored document.
        _, _, problem = str(error).partition(": ")
        raise InvalidInput(f"what was read is no robot that can walk here: {problem}") from error


def _check(links: Sequence[ModelLink]) -> None:
    for link in links:
        _check_mass(link)
        _check_sizes(link)
    triangles = sum(link.mesh.triangles for link in links if link.mesh is not None)
    if triangles > MAX_TRIANGLES:
        raise InvalidInput(
            f"its shapes have {triangles:,} triangles after they were simplified; at most "
            f"{MAX_TRIANGLES:,} are drawn: leave some shapes out"
        )


def _check_mass(link: ModelLink) -> None:
    if not _LEAST_KG <= link.mass_kg <= _MOST_KG:
        raise InvalidInput(
            f"body {link.name} weighs {link.mass_kg:,.6g} kg, with what is fixed to it; a link has "
            f"{_LEAST_KG:g} to {_MOST_KG:,.0f} kg. Shapes without a mass have 1,000 kg/m³ in MJCF: "
            f"give them `mass` or `density`, choose `mass_kg`, or {_OTHER_UNIT}"
        )


def _check_sizes(link: ModelLink) -> None:
    largest = max((max(geom.size_m) for geom in link.geoms), default=0.0)
    if largest > MAX_SIZE_M:
        raise InvalidInput(
            f"a shape of body {link.name} has a size of {largest:,.4g} m; at most "
            f"{MAX_SIZE_M:g} m is read: {_OTHER_UNIT}"
        )
    if link.mesh is None:
        return
    vertices, _ = link.mesh.arrays()
    farthest = float(np.abs(vertices).max()) if len(vertices) else 0.0
    if farthest > MAX_SIZE_M:
        raise InvalidInput(
            f"what is drawn of body {link.name} reaches {farthest:,.4g} m from its joint; at most "
            f"{MAX_SIZE_M:g} m is read: is its mesh in millimetres? `scale` of the mesh is "
            f"0.001 0.001 0.001 then; or {_OTHER_UNIT}"
        )
