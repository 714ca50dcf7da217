"""Arguments of the public functions: what a person may write for an agent, a robot or a world."""

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from hexapods.agents import registry
from hexapods.agents.registry import AgentClass
from hexapods.domain.disturbances import Disturbance, disturbance, parse_disturbance
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import GaitSpec
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.world import WORLDS, World, parse_world
from hexapods.runs.config import WalkingProblem
from hexapods.runs.config_json import gait_from_json

GAIT = "left-right-origin"
"""The gait where none is given: the first of the paper's."""
WALK = tuple(one.name for one in fields(WalkingProblem))
"""Names of the arguments that describe a walking problem."""


def agent_name(agent: str | AgentClass) -> str:
    """Return the name of an agent: registered, or `my.module:Agent`.

    Args:
        agent: its name, or its class.

    Raises:
        UnknownName: if there is no agent of this name.
        InvalidInput: if the class is not that of an agent, or not found in its module.
    """
    if isinstance(agent, str):
        registry.find(agent)
        return agent
    if not isinstance(agent, type):
        raise InvalidInput(f"an agent is given by its name or its class, not as {agent!r}")
    known = (name for name, its_class in registry.registered().items() if its_class is agent)
    name = next(known, f"{agent.__module__}:{agent.__qualname__}")
    if registry.find(name) is not agent:
        raise InvalidInput(f"{agent!r} is not what {name} imports; define it in a module")
    return name


def read_walk(given: Mapping[str, Any], like: WalkingProblem | None = None) -> dict[str, Any]:
    """Return the fields of a walking problem.

    Args:
        given: those that a person has given, as `hexapods.train` describes.
        like: where the others come from, except for the world and the tolerance; None for the
            defaults.

    Raises:
        UnknownName, InvalidInput: if a value is not valid.
    """
    walk: dict[str, Any] = {"gait": GAIT}
    if like is not None:
        inherited = [name for name in WALK if name not in ("world", "tolerance")]
        walk = {name: getattr(like, name) for name in inherited}
    walk |= given
    if isinstance(walk["gait"], Mapping):
        walk["gait"] = read_gait(walk["gait"])
    if "robot" in walk:
        if not isinstance(walk["robot"], str | Mapping | Robot):
            raise InvalidInput(
                f"robot is {' or '.join(PRESETS)}, a mapping or a Robot, not {walk['robot']!r}"
            )
        walk["robot"] = robot(walk["robot"])
    if "world" in walk:
        walk["world"] = read_world(walk["world"])
    return walk


def read_gait(given: Mapping[str, Any]) -> str | GaitSpec:
    """Return a gait that is given by its legs.

    Raises:
        InvalidInput: if it is none.
    """
    if set(given) - {one.name for one in fields(GaitSpec)} or not {"right_leg", "left_leg"} <= {
        *given
    }:
        raise InvalidInput(
            "a gait needs right_leg and left_leg, and either symmetry or pairs; "
            f"not {', '.join(map(str, sorted(given))) or 'nothing'}"
        )
    try:
        return gait_from_json(given)
    except (TypeError, ValueError) as error:
        raise InvalidInput("a gait's pairs must look like [[1, 4], [2, 5], [3, 6]]") from error


def plain(value: Any) -> Any:
    """Return a scalar of NumPy, such as those of `arange`, as Python's own; all else unchanged."""
    return value.item() if isinstance(value, np.generic) else value


def plain_values(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return arguments with scalars of NumPy as Python's own."""
    return {name: plain(value) for name, value in given.items()}


def read_world(given: World | str | Iterable[Disturbance | Mapping[str, Any] | str]) -> World:
    """Return a world: of a name such as `ice`, of a text or mappings, or the world itself.

    Raises:
        UnknownName, InvalidInput: if a disturbance is not valid, or two contradict each other.
    """
    if isinstance(given, World):
        return given
    if isinstance(given, Mapping) or not isinstance(given, Iterable):
        raise InvalidInput(
            f"world is one of {', '.join(WORLDS)}, a list of disturbances or a World, not {given!r}"
        )
    return (
        parse_world(given) if isinstance(given, str) else World(tuple(map(read_disturbance, given)))
    )


def read_disturbance(given: object) -> Disturbance:
    """Return a disturbance: of a text such as `limp:legs=1,4` or of a mapping, or itself.

    Raises:
        UnknownName, InvalidInput: if it is none.
    """
    if isinstance(given, Disturbance):
        return given
    if isinstance(given, str):
        return parse_disturbance(given)
    if not isinstance(given, Mapping):
        raise InvalidInput(
            f'a disturbance is such as "limp:legs=1,4" or {{"kind": "limp", "legs": [1, 4]}}, '
            f"not {given!r}"
        )
    return disturbance(given)


def check_names(function: str, given: Iterable[str], valid: Iterable[str]) -> None:
    """Check the names of keyword arguments.

    Raises:
        UnknownName: for the first that is not valid; it names those that are.
    """
    known = list(valid)
    for name in given:
        if name not in known:
            raise UnknownName(f"argument of {function}", name, known)
