"""Schemas that many bodies of the OpenAPI document have: each stands there once, and has a name.

Pydantic describes a type with a JSON form of its own where it is used. The bodies of all agents
have the same robots, gaits and disturbances: repeated, these would be two thirds of the document,
and a generator of clients would make as many classes of each as there are bodies.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import JsonSchemaMode

from app.api.agent_bodies import camel_case
from app.api.descriptions import VALID
from app.api.fields import Name
from hexapods.domain.disturbance_documents import any_kind_schema, json_schema
from hexapods.domain.disturbances import KINDS
from hexapods.domain.gait import GAIT_SCHEMA, AnyGait
from hexapods.domain.robot import LEG_SCHEMA, ROBOT_SCHEMA, STORED_ROBOT_SCHEMA, AnyRobot
from hexapods.domain.settings import Value

Schema = dict[str, Any]

_VALUE = TypeAdapter(Value).json_schema()
_VALUE_TYPES = {"type": ["number", "string", "boolean", "null"]}
"""What `_VALUE` says in alternatives, among them null, which OpenAPI Generator does not read."""

_DESCRIPTIONS: Mapping[str, Schema] = {
    "AnyGait": {"description": VALID["gait"]},
    "AnyRobot": {"description": VALID["robot"]},
}
"""Of components: what else fields say that have them."""


@cache
def shared_schemas() -> Mapping[str, Schema]:
    """Return the schemas by the name of their component, as they are where they are repeated."""
    kinds = {f"{camel_case(name)}Disturbance": json_schema(kind) for name, kind in KINDS.items()}
    return {
        "Disturbance": any_kind_schema(),
        **kinds,
        "AnyGait": _described(AnyGait),
        "GaitOfLegs": GAIT_SCHEMA,
        "LegParts": LEG_SCHEMA,
        "AnyRobot": _described(AnyRobot),
        "RobotParts": ROBOT_SCHEMA,
        "StoredRobotParts": STORED_ROBOT_SCHEMA,
        "DisplayName": _described(Name),
        "GaitInAnswers": _described(AnyGait, "serialization"),
        "RobotInAnswers": _described(AnyRobot, "serialization"),
    }


def _described(kind: Any, mode: JsonSchemaMode = "validation") -> Schema:
    return TypeAdapter(kind).json_schema(mode=mode)


def share(document: Schema, shared: Mapping[str, Schema]) -> None:
    """Replace each schema that is a shared one by a reference to a component with that.

    What a field has beside it, such as a title and a default, stays there. The value of a setting
    is described by the list of its types, where it stands.

    Args:
        document: the OpenAPI document, which is changed.
        shared: schemas by the name of their component.
    """
    schemas = document["components"]["schemas"]
    for member in (document["paths"], schemas):
        for key in member:
            member[key] = _with_references(member[key], shared)
    for name, schema in shared.items():
        # Of itself the parts alone are looked at.
        parts = {key: _with_references(value, shared) for key, value in schema.items()}
        schemas[name] = _DESCRIPTIONS.get(name, {}) | parts


def _with_references(part: Any, shared: Mapping[str, Schema]) -> Any:
    if isinstance(part, list):
        return [_with_references(item, shared) for item in part]
    if not isinstance(part, dict):
        return part
    if part.items() >= _VALUE.items():
        return _VALUE_TYPES | {key: value for key, value in part.items() if key not in _VALUE}
    for name, schema in shared.items():
        reference = {"$ref": f"#/components/schemas/{name}"}
        if part.items() >= schema.items():
            members = {**schema, **_DESCRIPTIONS.get(name, {})}
            return reference | {k: v for k, v in part.items() if members.get(k) != v}
        if _is_nullable(part, schema):
            nullable = {**part, "anyOf": [reference, {"type": "null"}]}
            about = _DESCRIPTIONS.get(name, {})
            return {k: v for k, v in nullable.items() if k not in about or about[k] != v}
    return {key: _with_references(value, shared) for key, value in part.items()}


def _is_nullable(part: Schema, schema: Schema) -> bool:
    """Whether a schema is another one, of several choices, or null, which is one more of these."""
    choices = schema.get("anyOf", ())
    return bool(choices) and part.get("anyOf") == [*choices, {"type": "null"}]


def name_schemas(schemas: dict[str, Schema]) -> None:
    """Make the title of each component its name, unless it has another that no other has.

    A model of which requests and answers have different forms gives both its title, and generators
    name classes by titles.
    """
    titles = [schema.get("title") for schema in schemas.values()]
    for name, schema in schemas.items():
        if titles.count(schema.get("title")) > 1 or "title" not in schema:
            schema["title"] = name.replace("-", "")


def name_body(operation: Schema) -> None:
    """Make the title of a request's body that is no component one that no other has."""
    for form in operation.get("requestBody", {}).get("content", {}).values():
        if form["schema"].get("title") == "Body":
            form["schema"]["title"] = f"{camel_case(operation['operationId'])}Body"
