"""A shorter OpenAPI document, for the gate: few of the bodies that the same functions build."""

import copy
from typing import Any

from app.api.shared_schemas import shared_schemas

AGENTS = ("QLearning", "Beam")
"""The default one, which learns, and a search with settings of its own."""
KINDS = ("Training", "Lane", "Entry")
"""Ends of the names of bodies that are others for each agent."""
OWN = ("agent", "settings")
"""Fields that are others for each agent."""
DISTURBANCES = ("limp", "patch")
"""One of the robot, with a list, and one of the ground."""
DISTURBS = "/api/v1/trainings/{run_id}/disturbances"
STORES_ROBOTS, READS_ROBOTS = "/api/v1/robots", "/api/v1/robots/readings"
STORES_LESSONS = "/api/v1/lessons"


def shortened(contract: dict[str, Any]) -> dict[str, Any]:
    """Return an OpenAPI document whose bodies have few agents, disturbances and parts of robots.

    The fields that all agents have stand in the body of the first one, and those of a walk, with
    the parts of a gait, in that of a training.
    The operation that disturbs a running training keeps all kinds of disturbances, and that which
    stores a robot, or looks at one, its parts, where others have the name of a robot. What several
    of these have in common the first one keeps. Of a lesson as YAML only what it needs is left: it
    is read as the JSON is.
    """
    contract = {**contract, "components": copy.deepcopy(contract["components"])}
    for name in shared_schemas():
        del contract["components"]["schemas"][name]
    contract = _without_shared(contract)
    short: dict[str, Any] = _with_few_choices(contract)
    for path in (DISTURBS, STORES_ROBOTS, READS_ROBOTS):
        short["paths"][path]["post"] = copy.deepcopy(contract["paths"][path]["post"])
    _keep_once(_schema_of(short, DISTURBS)["anyOf"])
    bodies = [*_schema_of(short, STORES_ROBOTS)["anyOf"], _schema_of(short, READS_ROBOTS)]
    for body in bodies:
        if (robot := body["properties"].get("robot")) is not None:
            _keep_once([schema for schema in robot["anyOf"] if "properties" in schema])
    schemas = short["components"]["schemas"]
    settings = {
        name: set(schema["properties"])
        for name, schema in schemas.items()
        if name.endswith("Training")
    }
    kept_names = set().union(
        *(names for name, names in settings.items() if name.startswith(AGENTS))
    )
    for name in set().union(*settings.values()) - kept_names:
        schemas["ExperimentBody"]["properties"].pop(name, None)
    for kind in KINDS:
        _keep_once([schemas[agent + kind] for agent in AGENTS])
    walk = schemas[f"{AGENTS[0]}Training"]
    _leave_out_what_has(walk, schemas["TournamentRulesBody"])
    gait = walk["properties"]["gait"]
    parts_of_gait = gait["anyOf"][1]
    for schema in _parts(short):
        if schema is not gait and parts_of_gait in schema.get("anyOf", ()):
            schema["anyOf"].remove(parts_of_gait)
    _shorten_yaml(short)
    return short


def _without_shared(part: Any) -> Any:
    """Return a part of a document with what many bodies share in each of them, not by reference."""
    if isinstance(part, list):
        return [_without_shared(item) for item in part]
    if not isinstance(part, dict):
        return part
    shared = shared_schemas().get(_name_of(part), {})
    whole = {**shared, **{name: part[name] for name in part if not shared or name != "$ref"}}
    if "anyOf" in whole:
        choices = map(_choices, whole["anyOf"])
        whole["anyOf"] = [choice for several in choices for choice in several]
    return {name: _without_shared(member) for name, member in whole.items()}


def _choices(schema: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the choices of a shared schema of several, or a schema itself."""
    choices: list[dict[str, Any]] | None = shared_schemas().get(_name_of(schema), {}).get("anyOf")
    return [schema] if choices is None else choices


def _schema_of(contract: dict[str, Any], path: str, media: str = "application/json") -> Any:
    """Return the schema of what is sent to a path."""
    return contract["paths"][path]["post"]["requestBody"]["content"][media]["schema"]


def _shorten_yaml(short: dict[str, Any]) -> None:
    schemas = short["components"]["schemas"]
    lesson = copy.deepcopy(schemas["GivenLesson"])
    card = schemas["GivenCard"]
    needed = {name: card["properties"][name] for name in ("title", "text")}
    lesson["properties"]["cards"]["items"] = {**card, "properties": needed}
    media = short["paths"][STORES_LESSONS]["post"]["requestBody"]["content"]
    media["application/yaml"] = {**media["application/yaml"], "schema": lesson}


def _keep_once(bodies: list[dict[str, Any]]) -> None:
    """Leave out what the first of some bodies shows of the others."""
    first, *later_bodies = bodies
    for body in later_bodies:
        _leave_out_what_has(first, body)


def _leave_out_what_has(first: dict[str, Any], other: dict[str, Any]) -> None:
    """Leave out the fields of a body that those of another show, but those that it needs."""
    shown = [name for name, field in first["properties"].items() if name not in OWN]
    for name in set(shown) - set(other.get("required", ())):
        if other["properties"].get(name) == first["properties"][name]:
            del other["properties"][name]


def _parts(document: Any) -> list[dict[str, Any]]:
    """Return all objects of a document."""
    if isinstance(document, list):
        return [schema for member in document for schema in _parts(member)]
    if not isinstance(document, dict):
        return []
    return [document, *_parts(list(document.values()))]


def _with_few_choices(document: Any) -> Any:
    if isinstance(document, list):
        return [_with_few_choices(item) for item in document]
    if not isinstance(document, dict):
        return document
    short = {name: _with_few_choices(item) for name, item in document.items()}
    if any(_is_choice_of(AGENTS[0] + kind, short) for kind in KINDS):
        short["oneOf"] = [
            choice for choice in short["oneOf"] if _name_of(choice).startswith(AGENTS)
        ]
    if any(_is_robot(choice) for choice in short.get("anyOf", ())):
        short["anyOf"] = [choice for choice in short["anyOf"] if not _is_robot(choice)]
    if any(_disturbance(choice) for choice in short.get("anyOf", ())):
        short["anyOf"] = [
            choice for choice in short["anyOf"] if _disturbance(choice) in DISTURBANCES
        ]
    return short


def _is_choice_of(name: str, schema: dict[str, Any]) -> bool:
    """Whether a schema is a choice of several, of which one has this name."""
    return name in {_name_of(choice) for choice in schema.get("oneOf", ())}


def _name_of(reference: dict[str, Any]) -> str:
    return str(reference.get("$ref", "")).rpartition("/")[2]


def _is_robot(schema: dict[str, Any]) -> bool:
    """Whether a schema is that of a robot's parts."""
    return "mount_radius_m" in schema.get("properties", ())


def _disturbance(schema: dict[str, Any]) -> str:
    """Return the kind of disturbance that a schema describes, or nothing."""
    properties = schema.get("properties", {})
    return str(properties["kind"].get("const", "")) if "at_step" in properties else ""
