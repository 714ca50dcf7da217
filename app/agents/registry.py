"""Agents by name: ours, those of installed packages, and a class in any importable module."""

import importlib
import inspect
import re
from collections.abc import Callable, Mapping
from importlib.metadata import entry_points
from typing import Any

from app.agents.lookahead import Greedy, TwoStep
from app.agents.protocol import Agent
from app.agents.q_learning import QLearning
from app.agents.sarsa_lambda import SarsaLambda
from app.domain.errors import InvalidInput, UnknownName
from app.domain.settings import DeclaredSetting, declared_parameters, parameters_of, required

ENTRY_POINT_GROUP = "hexapods.agents"
AgentClass = Callable[..., Agent]

_OFFERED = frozenset({"rng", "problem", "expand", "explore"})
"""What every run offers to an agent's constructor; no settings."""

OURS: Mapping[str, AgentClass] = {
    "q-learning": QLearning,
    "sarsa-lambda": SarsaLambda,
    "greedy": Greedy,
    "two-step": TwoStep,
}
_BY_HAND = re.compile(r"[\w.]+:\w+")


def registered() -> dict[str, AgentClass]:
    """Ours, and those that installed packages offer under the group `hexapods.agents`.

    A package cannot take the name of one of ours.
    """
    found = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
    return {name: point.load() for name, point in found.items() if name not in OURS} | dict(OURS)


def find(name: str) -> AgentClass:
    """The class behind a registered name or `my.module:Agent`.

    Raises:
        UnknownName: if it is neither.
        InvalidInput: if the module cannot be imported, or has no such agent.
    """
    if name in OURS:  # before looking through the installed packages, which takes milliseconds
        return OURS[name]
    known = registered()
    if name in known:
        return known[name]
    if not _BY_HAND.fullmatch(name):
        raise UnknownName("agent", name, [*known, "my.module:Agent"])
    module_name, _, class_name = name.partition(":")
    try:
        module = importlib.import_module(module_name)
    except Exception as error:
        raise InvalidInput(f"agent {name!r}: cannot import {module_name}: {error}") from error
    agent = getattr(module, class_name, None)
    if agent is None:
        offers = ", ".join(n for n, _ in inspect.getmembers(module, inspect.isclass)) or "none"
        raise InvalidInput(
            f"agent {name!r}: {module_name} has no {class_name}; its classes: {offers}"
        )
    missing = [verb for verb in ("act", "learn", "state", "load") if not hasattr(agent, verb)]
    if missing:
        raise InvalidInput(f"agent {name!r} lacks {', '.join(missing)} of the agent protocol")
    return agent  # type: ignore[no-any-return]


def learns(name: str) -> bool:
    """Whether practice changes an agent; false only if it says so by `learns = False`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return bool(getattr(find(name), "learns", True))


def needs_practice(name: str) -> bool:
    """Whether an agent races with what it has learned only: it says so by `needs_practice`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return bool(getattr(find(name), "needs_practice", False))


def settings_of(agent: AgentClass) -> Mapping[str, DeclaredSetting]:
    """The parameters of an agent's constructor that a person may choose."""
    declared = declared_parameters(agent)
    return {name: one for name, one in declared.items() if name not in _OFFERED}


def live_settings_of(agent: AgentClass) -> Mapping[str, DeclaredSetting]:
    """The settings that an agent's `tune` takes while it learns; none without a `tune`.

    They are those of its constructor that are declared `live`, and the parameters of `tune`.
    """
    if not hasattr(agent, "tune"):
        return {}
    own = settings_of(agent)
    live = {name: one for name, one in own.items() if one.about.live}
    for name, one in declared_parameters(agent, "tune").items():
        live.setdefault(name, own[name] if name in own else required(one))
    return live


def asks_for(agent: AgentClass) -> set[str]:
    """The names of what an agent's constructor asks for."""
    return set(parameters_of(agent))


def build(agent: AgentClass, offered: Mapping[str, Any]) -> Agent:
    """An agent, given whatever of `offered` it asks for by name.

    Raises:
        InvalidInput: if it needs something that is not offered.
    """
    parameters = parameters_of(agent).values()
    needs = {p.name for p in parameters if p.default is p.empty}
    if needs - set(offered):
        raise InvalidInput(
            f"an agent asks for {', '.join(sorted(needs - set(offered)))}; "
            f"on offer: {', '.join(sorted(offered))}"
        )
    return agent(**{p.name: offered[p.name] for p in parameters if p.name in offered})
