"""A shorter OpenAPI document, for the gate: few of the bodies that the same functions build."""

from typing import Any

AGENTS = ("QLearning", "Beam")
"""The default one, which learns, and a search with settings of its own."""
KINDS = ("Training", "Lane", "Entry")
"""Ends of the names of bodies that are others for each agent."""
OWN = ("agent", "settings")
"""Fields that are others for each agent."""
DISTURBANCES = ("Limp", "Patch")
"""One of the robot, with a list, and one of the ground."""
STORES_ROBOTS = "/api/v1/robots"


def shortened(contract: dict[str, Any]) -> dict[str, Any]:
    """Return an OpenAPI document whose bodies have few agents, disturbances and parts of robots.

    The fields that all agents have stand in the body of the first one, and those of a walk in that
    of a training, not in the rules of a tournament.
    The operation that disturbs a running training keeps all kinds of disturbances, and that which
    stores a robot its parts, where others have the name of a robot.
    """
    short: dict[str, Any] = _with_few_choices(contract)
    short["paths"][STORES_ROBOTS]["post"] = contract["paths"][STORES_ROBOTS]["post"]
    schemas = short["components"]["schemas"]
    settings = {
        name: set(one["properties"]) for name, one in schemas.items() if name.endswith("Training")
    }
    kept = set().union(*(names for name, names in settings.items() if name.startswith(AGENTS)))
    for name in set().union(*settings.values()) - kept:
        schemas["ExperimentBody"]["properties"].pop(name, None)
    for kind in KINDS:
        first, *others = (schemas[agent + kind] for agent in AGENTS)
        for one in others:
            _leave_out_what_has(first, one)
    _leave_out_what_has(schemas[f"{AGENTS[0]}Training"], schemas["TournamentRulesBody"])
    return short


def _leave_out_what_has(first: dict[str, Any], other: dict[str, Any]) -> None:
    """Leave out the fields of a body that those of another show, but those that it needs."""
    shown = [name for name, field in first["properties"].items() if name not in OWN]
    for name in set(shown) - set(other.get("required", ())):
        if other["properties"].get(name) == first["properties"][name]:
            del other["properties"][name]


def _with_few_choices(part: Any) -> Any:
    if isinstance(part, list):
        return [_with_few_choices(one) for one in part]
    if not isinstance(part, dict):
        return part
    short = {name: _with_few_choices(one) for name, one in part.items()}
    if any(_is_choice_of(AGENTS[0] + kind, short) for kind in KINDS):
        short["oneOf"] = [one for one in short["oneOf"] if _name_of(one).startswith(AGENTS)]
    if any("preset" in one.get("properties", ()) for one in short.get("anyOf", ())):
        short["anyOf"] = [
            one for one in short["anyOf"] if "preset" not in one.get("properties", ())
        ]
    disturbances = short.get("disturbances", {}).get("items", {})
    if _is_choice_of("LimpDisturbance", disturbances):
        few = [one for one in disturbances["oneOf"] if _name_of(one).startswith(DISTURBANCES)]
        short["disturbances"]["items"] = {"oneOf": few}
    return short


def _is_choice_of(name: str, schema: dict[str, Any]) -> bool:
    """Tell whether a schema is a choice of several, of which one has this name."""
    return name in {_name_of(one) for one in schema.get("oneOf", ())}


def _name_of(reference: dict[str, str]) -> str:
    return reference.get("$ref", "").rpartition("/")[2]
