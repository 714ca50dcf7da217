"""Registry of agents: built-in ones, entry points of packages, classes in any module."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hexapods.agents import registry
from hexapods.agents.lookahead import Greedy, TwoStep
from hexapods.agents.protocol import Problem
from hexapods.agents.q_learning import QLearning
from hexapods.domain.errors import InvalidInput, UnknownName
from tests import own_agents

PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), np.zeros((5, 2)))


def test_built_in_agents_are_found_by_name() -> None:
    assert registry.find("q-learning") is QLearning
    assert registry.find("greedy") is Greedy
    assert registry.find("two-step") is TwoStep


def test_agent_in_any_module_is_found() -> None:
    assert registry.find("tests.own_agents:Restless") is own_agents.Restless


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install a package with two entry points, one of them named as a built-in agent."""
    about = tmp_path / "roaming-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: roaming\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[hexapods.agents]\n"
        "roaming = tests.own_agents:Restless\n"
        "greedy = tests.own_agents:Restless\n"
        "broken = tests.no_such_module:Agent\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    registry.registered.cache_clear()
    yield
    registry.registered.cache_clear()


@pytest.mark.usefixtures("installed")
def test_entry_points_of_packages_are_registered() -> None:
    assert registry.find("roaming") is own_agents.Restless
    assert set(registry.registered()) == {*registry.BUILT_IN, "roaming"}


@pytest.mark.usefixtures("installed")
def test_package_cannot_replace_a_built_in_agent() -> None:
    assert registry.find("greedy") is Greedy


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "dijkstra",
            "unknown agent 'dijkstra'; .*q-learning, .*greedy, two-step.*my.module:Agent",
        ),
        ("", "unknown agent ''"),
        ("tests.own_agents:", "unknown agent"),
        ("tests.own_agents.Restless", "unknown agent"),
    ],
)
def test_unknown_name_is_refused_with_the_valid_names(name: str, message: str) -> None:
    with pytest.raises(UnknownName, match=message):
        registry.find(name)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no_such_module:Agent", "cannot import no_such_module: No module named"),
        ("tests.own_agents:Restles", "has no Restles; its classes: .*Restless"),
        ("tests.own_agents:Forgetful", "lacks state, load of the agent protocol"),
    ],
)
def test_unusable_agent_is_refused_with_the_reason(name: str, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        registry.find(name)


def test_module_that_fails_on_import_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken_agent.py").write_text("1 / 0\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InvalidInput, match="cannot import broken_agent: division by zero"):
        registry.find("broken_agent:Agent")


def test_constructor_gets_only_the_arguments_it_has_parameters_for() -> None:
    rng = np.random.default_rng(0)
    offered = {"rng": rng, "problem": PROBLEM, "alpha": 0.1, "steps": 7, "robot": "stiff"}
    agent = registry.build(own_agents.Restless, offered)
    learner = registry.build(QLearning, offered)

    assert isinstance(agent, own_agents.Restless)
    assert agent.problem is PROBLEM
    assert learner.state()["rates"][0] == 0.1
    assert registry.parameter_names(own_agents.Restless) == {"rng", "problem"}
    assert registry.parameter_names(Greedy) == {"expand"}


def test_unknown_required_parameter_is_refused_with_the_available_ones() -> None:
    with pytest.raises(InvalidInput, match="asks for crystal_ball; on offer: problem, rng"):
        registry.build(own_agents.Needy, {"rng": np.random.default_rng(0), "problem": PROBLEM})


def test_learns_is_false_for_look_ahead_only() -> None:
    names = ("q-learning", "greedy", "tests.own_agents:ThreeStep", "tests.own_agents:Restless")
    assert [registry.learns(name) for name in names] == [True, False, False, True]


def test_factory_function_may_replace_a_class(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "BUILT_IN", {"made": lambda rng: own_agents.Plain(rng, PROBLEM)})
    assert registry.learns("made")
    agent = registry.build(registry.find("made"), {"rng": np.random.default_rng(0)})
    assert isinstance(agent, own_agents.Plain)
