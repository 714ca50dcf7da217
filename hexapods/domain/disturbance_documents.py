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
    kind_fields = fields(kind)
    for field in values:
        if field not in {field_.name for field_ in kind_fields}:
            raise UnknownName(f"field of {name}", field, [field_.name for field_ in kind_fields])
    missing = [
        field_.name
        for field_ in kind_fields
        if field_.default is MISSING and field_.name not in values
    ]
    if missing:
        raise InvalidInput(f"{name} needs {', '.join(missing)}")
    return kind(**values)


def as_mapping(value: Disturbance) -> dict[str, Any]:
    """Return a disturbance in plain types, the inverse of `disturbance`."""
    values = {field.name: getattr(value, field.name) for field in fields(value)}
    plain = {k: list(v) if isinstance(v, tuple) else v for k, v in values.items() if v is not None}
    return {"kind": value.kind, **plain}


def json_schema(kind: type[Disturbance]) -> Schema:
    """Return the JSON schema of a kind of disturbance."""
    # As in `hexapods.domain.records`.
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


def _any_kind() -> Schema:
    return {"anyOf": [json_schema(kind) for kind in KINDS.values()]}


_PART: Schema = {
    "anyOf": [
        {"type": ["number", "string", "null"]},
        {"type": "array", "items": {"type": "integer"}},
    ]
}
SENT: Schema = {
    "type": "object",
    "description": "A disturbance from a step on; the fields of its kind are further members.",
    "properties": {"kind": {"type": "string"}, "at_step": {"type": "integer", "minimum": 0}},
    "required": ["kind", "at_step"],
    "additionalProperties": _PART,
}
"""JSON schema of a disturbance in answers."""
AnyDisturbance = Annotated[Disturbance, JsonForm(disturbance_from, as_mapping, _any_kind, SENT)]
"""A disturbance of any kind."""


SHORT_NAMES = MappingProxyType({"at": "at_step", "until": "until_step"})
"""Names of fields in a text, where they are others: name in a text → field."""


def as_text(value: Disturbance) -> str:
    """Return a disturbance as on a command line, the inverse of `parse_disturbance`."""
    values = as_mapping(value)
    name = values.pop("kind")
    times = [(short, values.pop(field)) for short, field in SHORT_NAMES.items() if field in values]
    parts = [
        f"{field}={','.join(map(str, value_)) if isinstance(value_, list) else value_}"
        for field, value_ in [*values.items(), *times]
    ]
    return ":".join([name, *parts])


def parse_disturbance(text: str) -> Disturbance:
    """Parse a disturbance from a command line, such as `limp:legs=1,4:at=25`.

    Raises:
        UnknownName, InvalidInput: if it is not valid.
    """
    name, *parts = text.split(":")
    if name not in KINDS:
        raise UnknownName("disturbance", name, KINDS)
    settings = declared_fields(KINDS[name])  # type: ignore[arg-type]
    values: dict[str, Any] = {}
    for part in parts:
        field, equals, value = part.partition("=")
        field = SHORT_NAMES.get(field, field)
        if not equals or field in values or field == "kind":
            raise InvalidInput(
                f"{text!r}: give each field once, as in limp:legs=1,4:at=25; {part!r} is not"
            )
        if field in settings:
            values[field] = settings[field].parse(value)
        elif field == "legs" and all(leg.isdecimal() and len(leg) < 4 for leg in value.split(",")):
            values[field] = [int(leg) for leg in value.split(",")]
        else:
            values[field] = value
    return disturbance_from({"kind": name, **values})
