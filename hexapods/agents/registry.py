"""Registry of agents: built-in ones, entry points of packages, and `my.module:Agent`."""

import importlib
import inspect
import logging
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from importlib.metadata import entry_points
from typing import Any

from hexapods.agents.afterstate_q import AfterstateQ
from hexapods.agents.afterstate_r_max import AfterstateRMax
from hexapods.agents.beam import Beam
from hexapods.agents.double_q import DoubleQ
from hexapods.agents.dyna_q import DynaQ
from hexapods.agents.dyna_q_plus import DynaQPlus
from hexapods.agents.expected_sarsa import ExpectedSarsa
from hexapods.agents.fixed_policies import RandomWalk, Wave
from hexapods.agents.informed import Informed
from hexapods.agents.linear_model import LinearModel
from hexapods.agents.lookahead import Greedy, LookAhead, TwoStep
from hexapods.agents.mcts import Mcts
from hexapods.agents.multilevel_model import MultilevelModel
from hexapods.agents.n_step_sarsa import NStepSarsa
from hexapods.agents.posterior_sampling import PosteriorSampling
from hexapods.agents.prioritized_sweeping import PrioritizedSweeping
from hexapods.agents.protocol import Agent, Problem
from hexapods.agents.q_lambda import QLambda
from hexapods.agents.q_learning import QLearning
from hexapods.agents.r_max import RMax
from hexapods.agents.sarsa import Sarsa
from hexapods.agents.sarsa_lambda import SarsaLambda
from hexapods.agents.tabular import TabularLearner
from hexapods.agents.tamer import Tamer
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.settings import (
    DeclaredSetting,
    declared_parameters,
    parameters_of,
    required,
    takes_any,
)

_log = logging.getLogger(__name__)
ENTRY_POINT_GROUP = "hexapods.agents"
AgentClass = Callable[..., Agent]

BUILT_IN: Mapping[str, AgentClass] = {
    "q-learning": QLearning,
    "double-q": DoubleQ,
    "q-lambda": QLambda,
    "sarsa": Sarsa,
    "expected-sarsa": ExpectedSarsa,
    "n-step-sarsa": NStepSarsa,
    "sarsa-lambda": SarsaLambda,
    "dyna-q": DynaQ,
    "dyna-q-plus": DynaQPlus,
    "prioritized-sweeping": PrioritizedSweeping,
    "r-max": RMax,
    "posterior-sampling": PosteriorSampling,
    "afterstate-q": AfterstateQ,
    "afterstate-r-max": AfterstateRMax,
    "multilevel-model": MultilevelModel,
    "linear-model": LinearModel,
    "tamer": Tamer,
    "greedy": Greedy,
    "two-step": TwoStep,
    "look-ahead": LookAhead,
    "beam": Beam,
    "informed": Informed,
    "mcts": Mcts,
    "wave": Wave,
    "random-walk": RandomWalk,
}
_CLASS_PATH = re.compile(r"[\w.]+:\w+")


@cache
def registered() -> Mapping[str, AgentClass]:
    """Return the built-in agents and the entry points of group `hexapods.agents`, by name.

    A package cannot replace a built-in agent. One that cannot be loaded is left out, with a
    warning in the log. Cached, because loading entry points takes milliseconds and more.
    """
    classes = dict(BUILT_IN)
    for point in entry_points(group=ENTRY_POINT_GROUP):
        if point.name not in BUILT_IN:
            try:
                classes[point.name] = point.load()
            except Exception as error:
                _log.warning("agent %s cannot be loaded: %s", point.name, error)
    return classes


def find(name: str) -> AgentClass:
    """Return the class of an agent by its registered name or as `my.module:Agent`.

    Raises:
        UnknownName: if the name is neither.
        InvalidInput: if the module cannot be imported, has no such class, or the class does not
            implement the agent protocol.
    """
    if name in BUILT_IN:  # first, so that no package is loaded for a built-in agent
        return BUILT_IN[name]
    by_name = registered()
    if name in by_name:
        return by_name[name]
    if not _CLASS_PATH.fullmatch(name):
        raise UnknownName("agent", name, [*by_name, "my.module:Agent"])
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
    if (
        agent is TabularLearner
        or inspect.isabstract(agent)
        or getattr(agent, "_is_protocol", False)
    ):
        raise InvalidInput(
            f"agent {name!r} is there to be derived from: give the name or class of a complete one"
        )
    missing = [method for method in ("act", "learn", "state", "load") if not hasattr(agent, method)]
    if missing:
        raise InvalidInput(f"agent {name!r} lacks {', '.join(missing)} of the agent protocol")
    return agent  # type: ignore[no-any-return]


def is_loaded(name: str) -> bool:
    """Whether an agent is registered, or in a module that was imported already."""
    module_name, _, class_name = name.partition(":")
    module = sys.modules.get(module_name)
    return name in registered() or (module is not None and class_name in vars(module))


def learns(name: str) -> bool:
    """Whether practice changes an agent; False only if its class sets `learns = False`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return bool(getattr(find(name), "learns", True))


def needs_practice(name: str) -> bool:
    """Whether an agent can race only after practice: its class sets `needs_practice = True`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return bool(getattr(find(name), "needs_practice", False))


def searches(name: str) -> bool:
    """Whether an agent plans with a simulator: its constructor has the parameter `expand`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return "expand" in parameter_names(find(name))


def compares(name: str) -> str:
    """Return the quantity that a search compares, its class's `compares`; imports no agent."""
    agent_class = None if ":" in name else BUILT_IN.get(name) or registered().get(name)
    return str(getattr(agent_class, "compares", "return of its simulated sequences"))


def keeps_learning(name: str) -> bool:
    """Whether a lane of an agent keeps learning by default: its class sets `keeps_learning = True`.

    Raises:
        UnknownName, InvalidInput: as `find`.
    """
    return bool(getattr(find(name), "keeps_learning", False))


def is_memoryless(agent: Agent) -> bool:
    """Whether an agent's class declares that a decision follows from the present state alone.

    A declaration is not inherited, since a derived class may remember earlier states.
    """
    return bool(vars(type(agent)).get("is_memoryless", False))


def check_problem(name: str, problem: Problem, settings: Mapping[str, Any]) -> None:
    """Check by the agent's `check_problem`, if it has one, that its settings fit a problem.

    Raises:
        UnknownName, InvalidInput: as `find`, or if they do not.
    """
    check = getattr(find(name), "check_problem", None)
    if check is not None:
        check(problem, **settings)


def check_unattended(name: str, settings: Mapping[str, Any]) -> None:
    """Check by the agent's `check_unattended`, if it has one, that it learns by itself.

    An agent that cannot be imported here is not checked: it may be where the trial runs.

    Raises:
        InvalidInput: if it needs people who teach it.
    """
    try:
        agent = find(name)
    except InvalidInput:
        return
    check = getattr(agent, "check_unattended", None)
    if check is not None:
        check(**settings)


def settings_of(agent: AgentClass) -> Mapping[str, DeclaredSetting]:
    """Return the settings that an agent's constructor declares.

    A parameter without a declaration that is named like one of `TabularLearner` is that setting.
    """
    declared, standard = declared_parameters(agent), declared_parameters(TabularLearner)
    settings = {}
    for name, parameter in parameters_of(agent).items():
        if name in declared:
            settings[name] = declared[name]
        elif name in standard:
            has_default = standard[name].allows(parameter.default)
            default = parameter.default if has_default else standard[name].default
            settings[name] = replace(standard[name], default=default)
    return settings


def live_settings_of(agent: AgentClass) -> Mapping[str, DeclaredSetting]:
    """Return the settings that an agent's `tune` can change while it learns; none without `tune`.

    These are the constructor's settings that are parameters of `tune` as well, or are declared
    `live` if `tune` takes any, and what `tune` alone declares, or names like `TabularLearner.tune`.
    """
    if not isinstance(agent, type) or not hasattr(agent, "tune"):
        return {}
    accepted, constructor_settings = parameters_of(agent, "tune"), settings_of(agent)
    declared = {**declared_parameters(TabularLearner, "tune"), **declared_parameters(agent, "tune")}
    live = {
        name: setting
        for name, setting in constructor_settings.items()
        if name in accepted or (setting.about.live and takes_any(agent, "tune"))
    }
    replacing = [name for name in accepted if name not in constructor_settings and name in declared]
    return live | {name: required(declared[name]) for name in replacing}


def parameter_names(agent: AgentClass) -> set[str]:
    """Return the names of the parameters of an agent's constructor."""
    return set(parameters_of(agent))


def build(agent: AgentClass, offered: Mapping[str, Any]) -> Agent:
    """Create an agent, with those arguments of `offered` that its constructor has parameters for.

    Raises:
        InvalidInput: if a required parameter is not in `offered`.
    """
    parameters = parameters_of(agent).values()
    required_names = {p.name for p in parameters if p.default is p.empty}
    if missing := required_names - set(offered):
        raise InvalidInput(
            f"an agent asks for {', '.join(sorted(missing))}; "
            f"on offer: {', '.join(sorted(offered))}"
        )
    return agent(**{p.name: offered[p.name] for p in parameters if p.name in offered})
