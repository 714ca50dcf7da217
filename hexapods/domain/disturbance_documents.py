"""Disturbances in JSON, and as texts on a command line, such as `limp:legs=1,4:at=25`."""

from collections.abc import Mapping
from dataclasses import MISSING, fields
from types import MappingProxyType
from typing import Annotated, Any

from hexapods.domain.disturbances import KINDS, LEGS, Disturbance
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import JsonForm, Schema
from hexapods.domain.robot import MAX_LEGS
from hexapods.domain.settings import declared_fields


def disturbance_from(data: Mapping[str, Any] | Disturbance) -> Disturbance:
    """Build a disturbance from user input: its kind and its fields by name, or itself.

    Raises:
        UnknownName: for an unknown kind or field.
        InvalidInput: for a missing field, or a value out of its limits.
    """
    if isinstance(data, Disturbance):
        return data
    if not isinstance(data, Mapping):
        raise InvalidInput(f"a disturbance is an object of a kind, {', '.join(KINDS)}, and fields")
    values = dict(data)
    name = values.pop("kind", None)
    if not isinstance(name, str) or name not in KINDS:
        raise UnknownName("kind of disturbance", name, KINDS)
    kind = KINDS[name]
    required = {field.name: field.default is MISSING for field in fields(kind)}
    for field_name in values:
        if field_name not in required:
            raise UnknownName(f"field of {name}", field_name, required)
    missing = [
        field_name
        for field_name, is_required in required.items()
        if is_required and field_name not in values
    ]
    if missing:
        raise InvalidInput(f"{name} needs {', '.join(missing)}")
    return kind(**values)


def as_mapping(value: Disturbance) -> dict[str, Any]:
    """Return a disturbance in plain types, the inverse of `disturbance_from`."""
    values = {field.name: getattr(value, field.name) for field in fields(value)}
    plain = {k: list(v) if isinstance(v, tuple) else v for k, v in values.items() if v is not None}
    return {"kind": value.kind, **plain}


def json_schema(kind: type[Disturbance]) -> Schema:
    """Return the JSON schema of a kind of disturbance."""
    # Imported only here, as in `hexapods.domain.records`.
    from pydantic import TypeAdapter  # noqa: PLC0415

    declared = declared_fields(kind)  # type: ignore[arg-type]  # of a class, not of an instance
    leg = {"type": "integer", "minimum": 1, "maximum": MAX_LEGS}
    legs = {"type": "array", "items": leg, "minItems": 1, "maxItems": MAX_LEGS}
    properties: Schema = {"kind": {"const": kind.kind, "type": "string"}}
    for field in fields(kind):
        setting = declared.get(field.name)
        properties[field.name] = (
            {**legs, "title": LEGS.title, "description": LEGS.help}
            if setting is None
            else TypeAdapter(setting.annotation).json_schema()
        )
    return {
        "type": "object",
        "title": kind.title,
        "description": kind.help,
        "properties": properties,
        "required": ["kind", *(field.name for field in fields(kind) if field.default is MISSING)],
        "additionalProperties": False,
    }


def any_kind_schema() -> Schema:
    """Return the JSON schema of a disturbance of any kind, in requests."""
    return {"anyOf": [json_schema(kind) for kind in KINDS.values()]}


_FIELD_SCHEMA: Schema = {
    "anyOf": [
        {"type": ["number", "string", "null"]},
        {"type": "array", "items": {"type": "integer"}},
    ]
}
DISTURBANCE_SCHEMA: Schema = {
    "type": "object",
    "description": "A disturbance from a step on; the fields of its kind are further members.",
    "properties": {"kind": {"type": "string"}, "at_step": {"type": "integer", "minimum": 0}},
    "required": ["kind", "at_step"],
    "additionalProperties": _FIELD_SCHEMA,
}
"""JSON schema of a disturbance in answers."""
AnyDisturbance = Annotated[
    Disturbance, JsonForm(disturbance_from, as_mapping, any_kind_schema, DISTURBANCE_SCHEMA)
]
"""A disturbance of any kind."""


SHORT_NAMES = MappingProxyType({"at": "at_step", "until": "until_step"})
"""Fields with a shorter name in a text: short name → field."""


def as_text(value: Disturbance) -> str:
    """Return a disturbance as on a command line, the inverse of `parse_disturbance`."""
    values = as_mapping(value)
    name = values.pop("kind")
    times = [(short, values.pop(field)) for short, field in SHORT_NAMES.items() if field in values]
    assignments = [
        f"{field}={','.join(map(str, setting)) if isinstance(setting, list) else setting}"
        for field, setting in [*values.items(), *times]
    ]
    return ":".join([name, *assignments])


def parse_disturbance(text: str) -> Disturbance:
    """Parse a disturbance from a command line, such as `limp:legs=1,4:at=25`.

    Raises:
        UnknownName, InvalidInput: if it is not valid.
    """
    name, *assignments = text.split(":")
    if name not in KINDS:
        raise UnknownName("disturbance", name, KINDS)
    settings = declared_fields(KINDS[name])  # type: ignore[arg-type]
    values: dict[str, Any] = {}
    for assignment in assignments:
        field, equals, value = assignment.partition("=")
        field = SHORT_NAMES.get(field, field)
        if not equals or field in values or field == "kind":
            raise InvalidInput(
                f"{text!r}: give each field once, as in limp:legs=1,4:at=25; {assignment!r} is not"
            )
        if field in settings:
            values[field] = settings[field].parse(value)
        elif field == "legs" and all(leg.isdecimal() and len(leg) < 4 for leg in value.split(",")):
            values[field] = [int(leg) for leg in value.split(",")]
        else:
            values[field] = value
    return disturbance_from({"kind": name, **values})
