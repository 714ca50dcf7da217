"""Base class of the records that the API sends."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, TypeVar, cast, dataclass_transform

from annotated_types import Ge

from hexapods.domain.records import Record

A = TypeVar("A", bound="Answer")
Count = Annotated[int, Ge(0)]


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(field,))
class Answer(Record):
    """Base class of what routes and events send. Subclasses are frozen dataclasses by themselves.

    Their docstrings describe them and their members in the OpenAPI document. Members with a
    default may be left out of what is stored, so that clients cannot rely on them.
    """

    __pydantic_config__: ClassVar[Mapping[str, Any]] = {"extra": "forbid"}

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True, kw_only=True)(cls)


def extended(answer: type[A], members: Mapping[str, Any]) -> type[A]:
    """Return a subclass of the same name and description, with members of these types."""
    namespace = {"__doc__": answer.__doc__, "__annotations__": dict(members)}
    return cast("type[A]", type(answer.__name__, (answer,), namespace))
