"""Request bodies of disturbances, one model for each kind, built from the declared fields."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from app.api.fields import INTEGRAL, Body, Declared, TaggedUnion
from hexapods.domain.disturbances import KINDS, LEGS, Disturbance, disturbance
from hexapods.domain.robot import MAX_LEGS
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import MAX_DISTURBANCES

Leg = Annotated[
    # The upper limit depends on the robot, so the domain validates it.
    int, Field(strict=True, json_schema_extra={"minimum": 1, "maximum": MAX_LEGS}), INTEGRAL
]
Legs = Annotated[
    list[Leg],
    Field(
        title=LEGS.title,
        description=LEGS.help,
        min_length=1,
        max_length=MAX_LEGS,
    ),
]


class DisturbanceBody(Body):
    """A disturbance; `kind` decides on its fields."""

    kind: str

    def disturbance(self) -> Disturbance:
        """Convert to the disturbance of the domain.

        Raises:
            InvalidInput: if its values are not valid together.
        """
        return disturbance(self.model_dump(exclude_none=True))


def _model(kind: type[Disturbance]) -> type[DisturbanceBody]:
    declared = declared_fields(kind)  # type: ignore[arg-type]  # of a class, not of an instance
    own: dict[str, Any] = {"kind": (Literal[kind.kind], ...)}
    for one in fields(kind):
        shape = Annotated[Any, Declared(declared[one.name])] if one.name in declared else Legs
        own[one.name] = (shape, ... if one.default is MISSING else one.default)
    name = "".join(word.capitalize() for word in kind.kind.split("-"))
    return create_model(f"{name}Disturbance", __base__=DisturbanceBody, __doc__=kind.help, **own)


_MODELS: Mapping[str, type[DisturbanceBody]] = {name: _model(one) for name, one in KINDS.items()}
AnyDisturbance = Annotated[DisturbanceBody, TaggedUnion(_MODELS, "kind", "disturbance")]
Disturbances = Annotated[
    list[AnyDisturbance],
    Field(
        max_length=MAX_DISTURBANCES,
        description="Changes of the robot and the ground, by step.",
    ),
]
