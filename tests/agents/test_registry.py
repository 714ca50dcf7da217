"""Agents by name: ours, those of installed packages, and a class in any module."""

from pathlib import Path

import numpy as np
import pytest

from app.agents import registry
from app.agents.lookahead import Greedy, TwoStep
from app.agents.protocol import Problem
from app.agents.q_learning import QLearning
from app.domain.errors import InvalidInput, UnknownName
from tests import own_agents

PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), np.zeros((5, 2)))


def test_ours_go_by_their_names() -> None:
    assert registry.find("q-learning") is QLearning
    assert registry.find("greedy") is Greedy
    assert registry.find("two-step") is TwoStep


def test_a_class_in_any_module() -> None:
    assert registry.find("tests.own_agents:Restless") is own_agents.Restless


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package in the environment that offers two agents, one under a name of ours."""
    about = tmp_path / "roaming-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: roaming\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[hexapods.agents]\n"
        "roaming = tests.own_agents:Restless\n"
        "greedy = tests.own_agents:Restless\n"
    )
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.usefixtures("installed")
def test_an_installed_package_offers_its_agents() -> None:
    assert registry.find("roaming") is own_agents.Restless
    assert set(registry.registered()) == {*registry.OURS, "roaming"}


@pytest.mark.usefixtures("installed")
def test_but_cannot_take_a_name_of_ours() -> None:
    assert registry.find("greedy") is Greedy


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "dijkstra",
            "unknown agent 'dijkstra'; .*sarsa-lambda, greedy, two-step.*my.module:Agent",
        ),
        ("", "unknown agent ''"),
        ("tests.own_agents:", "unknown agent"),
        ("tests.own_agents.Restless", "unknown agent"),
    ],
)
def test_an_unknown_name_names_the_known_ones(name: str, message: str) -> None:
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
def test_what_cannot_be_had_says_why(name: str, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        registry.find(name)


def test_a_module_that_breaks_on_import_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken_agent.py").write_text("1 / 0\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InvalidInput, match="cannot import broken_agent: division by zero"):
        registry.find("broken_agent:Agent")


def test_an_agent_gets_what_it_asks_for_and_no_more() -> None:
    rng = np.random.default_rng(0)
    offered = {"rng": rng, "problem": PROBLEM, "alpha": 0.1, "steps": 7, "robot": "stiff"}
    agent = registry.build(own_agents.Restless, offered)
    learner = registry.build(QLearning, offered)

    assert isinstance(agent, own_agents.Restless)
    assert agent.problem is PROBLEM
    assert learner.state()["rates"][0] == 0.1
    assert registry.asks_for(own_agents.Restless) == {"rng", "problem"}
    assert registry.asks_for(Greedy) == {"expand"}


def test_asking_for_what_is_not_offered_names_what_is() -> None:
    with pytest.raises(InvalidInput, match="asks for crystal_ball; on offer: problem, rng"):
        registry.build(own_agents.Needy, {"rng": np.random.default_rng(0), "problem": PROBLEM})


def test_look_ahead_does_not_learn_and_others_do() -> None:
    names = ("q-learning", "greedy", "tests.own_agents:ThreeStep", "tests.own_agents:Restless")
    assert [registry.learns(name) for name in names] == [True, False, False, True]


def test_a_factory_may_stand_for_a_class(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "OURS", {"made": lambda rng: own_agents.Plain(rng, PROBLEM)})
    assert registry.learns("made")
    agent = registry.build(registry.find("made"), {"rng": np.random.default_rng(0)})
    assert isinstance(agent, own_agents.Plain)
