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


def disturbance(data: Mapping[str, Any] | Disturbance) -> Disturbance:
    """Build a disturbance from user input: its kind and its fields by name, or itself.

    Raises:
        UnknownName: for an unknown kind or field.
        InvalidInput: for a missing field, or a value out of its limits.
    """
    if isinstance(data, Disturbance):
        return data
    if not isinstance(data, Mapping):
        raise InvalidInput(f"a disturbance is an object of a kind, {', '.join(KINDS)}, and fields")
    given = dict(data)
    name = given.pop("kind", None)
    if not isinstance(name, str) or name not in KINDS:
        raise UnknownName("kind of disturbance", name, KINDS)
    kind = KINDS[name]
    known = fields(kind)
    for field in given:
        if field not in {one.name for one in known}:
            raise UnknownName(f"field of {name}", field, [one.name for one in known])
    missing = [one.name for one in known if one.default is MISSING and one.name not in given]
    if missing:
        raise InvalidInput(f"{name} needs {', '.join(missing)}")
    return kind(**given)


def as_mapping(value: Disturbance) -> dict[str, Any]:
    """Return a disturbance in plain types, the inverse of `disturbance`."""
    given = {one.name: getattr(value, one.name) for one in fields(value)}
    plain = {k: list(v) if isinstance(v, tuple) else v for k, v in given.items() if v is not None}
    return {"kind": value.kind, **plain}


def json_schema(kind: type[Disturbance]) -> Schema:
    """Return the JSON schema of a kind of disturbance."""
    # As in `hexapods.domain.records`.
    from pydantic import TypeAdapter  # noqa: PLC0415

    declared = declared_fields(kind)  # type: ignore[arg-type]  # of a class, not of an instance
    leg = {"type": "integer", "minimum": 1, "maximum": MAX_LEGS}
    legs = {"type": "array", "items": leg, "minItems": 1, "maxItems": MAX_LEGS}
    properties: Schema = {"kind": {"const": kind.kind, "type": "string"}}
    for one in fields(kind):
        setting = declared.get(one.name)
        properties[one.name] = (
            {**legs, "title": LEGS.title, "description": LEGS.help}
            if setting is None
            else TypeAdapter(setting.annotation).json_schema()
        )
    return {
        "type": "object",
        "title": kind.title,
        "description": kind.help,
        "properties": properties,
        "required": ["kind", *(one.name for one in fields(kind) if one.default is MISSING)],
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
AnyDisturbance = Annotated[Disturbance, JsonForm(disturbance, as_mapping, _any_kind, SENT)]
"""A disturbance of any kind."""


SHORT = MappingProxyType({"at": "at_step", "until": "until_step"})
"""Names of fields in a text, where they are others: name in a text → field."""


def as_text(value: Disturbance) -> str:
    """Return a disturbance as on a command line, the inverse of `parse_disturbance`."""
    given = as_mapping(value)
    name = given.pop("kind")
    times = [(short, given.pop(field)) for short, field in SHORT.items() if field in given]
    parts = [
        f"{field}={','.join(map(str, one)) if isinstance(one, list) else one}"
        for field, one in [*given.items(), *times]
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
    given: dict[str, Any] = {}
    for part in parts:
        field, equals, value = part.partition("=")
        field = SHORT.get(field, field)
        if not equals or field in given or field == "kind":
            raise InvalidInput(
                f"{text!r}: give each field once, as in limp:legs=1,4:at=25; {part!r} is not"
            )
        if field in settings:
            given[field] = settings[field].parse(value)
        elif field == "legs" and all(leg.isdecimal() and len(leg) < 4 for leg in value.split(",")):
            given[field] = [int(leg) for leg in value.split(",")]
        else:
            given[field] = value
    return disturbance({"kind": name, **given})
