"""Conformance tests of the agent protocol, on built-in and user-supplied agents."""

import pytest

from hexapods.agents.protocol import Agent, Transition
from hexapods.agents.registry import BUILT_IN
from hexapods.assembly import build_learner
from hexapods.domain.observation import OBSERVATIONS, Observation, observe
from hexapods.domain.types import Action
from hexapods.runs import seeding
from hexapods.runs.config import training_config
from hexapods.runs.training import Learner

AGENTS = [
    *BUILT_IN,
    "tests.own_agents:ThreeStep",
    "tests.own_agents:Restless",
    "tests.own_agents:Plain",
]


def learner(agent: str, seed: int = 0, observation: Observation = "measured") -> Learner:
    return build_learner(
        training_config(
            gait="left-right-origin",
            simulator="kinematic",
            agent=agent,
            seed=seed,
            observation=observation,
            steps=60,
            steps_per_episode=10,
        )
    )


def walk(learner: Learner, steps: int) -> list[tuple[Action, float]]:
    """Take and learn some steps; return the actions and rewards."""
    walker, done = learner.walker, []
    is_on_policy = getattr(walker.agent, "is_on_policy", False)
    chosen = None
    for _ in range(steps):
        observed, action = walker.observed, chosen or walker.decide()
        reward = walker.carry_out(action).reward_m
        chosen = walker.decide() if is_on_policy else None
        walker.agent.learn(
            Transition(observed, action, reward, walker.observed, walker.legal, chosen)
        )
        done.append((action, reward))
    return done


def written(learner: Learner) -> dict[str, bytes]:
    return {name: array.tobytes() for name, array in learner.walker.agent.state().items()}


@pytest.fixture(params=AGENTS)
def agent(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


def steps_for(agent: str) -> int:
    return 6 if agent.endswith("ThreeStep") else 25


def test_agent_implements_the_protocol(agent: str) -> None:
    assert isinstance(learner(agent).walker.agent, Agent)


@pytest.mark.test
@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_agent_chooses_legal_actions_in_each_observation_mode(
    agent: str, observation: Observation
) -> None:
    walker = learner(agent, observation=observation).walker
    for _ in range(steps_for(agent)):
        observed = observe(walker.simulator, walker.state, observation)
        action = walker.decide()
        assert action in walker.legal
        assert observed[action.group] != action.cell
        assert [type(number) for number in action] == [int, int]
        walker.carry_out(action)


@pytest.mark.test
def test_agent_is_deterministic_for_a_seed(agent: str) -> None:
    first, second = learner(agent, seed=5), learner(agent, seed=5)

    assert walk(first, steps_for(agent)) == walk(second, steps_for(agent))
    assert written(first) == written(second)


@pytest.mark.test
def test_agent_continues_identically_from_a_loaded_state(agent: str) -> None:
    original, copy = learner(agent, seed=1), learner(agent, seed=2)
    walk(original, steps_for(agent))
    copy.walker.agent.load(original.walker.agent.state())
    copy.walker.set_state(original.walker.state)
    seeding.load(copy.rng, seeding.dump(original.rng))
    assert written(copy) == written(original)

    assert walk(copy, steps_for(agent)) == walk(original, steps_for(agent))
    assert written(copy) == written(original)


def test_state_is_a_copy(agent: str) -> None:
    original = learner(agent)
    walk(original, 5)
    before = written(original)
    for array in original.walker.agent.state().values():
        array.fill(1)

    assert written(original) == before


def test_only_agents_with_an_expand_parameter_simulate_transitions() -> None:
    blind, seeing = learner("q-learning"), learner("two-step")
    walk(blind, 10)
    walk(seeing, 2)

    assert blind.walker.transitions == 0
    assert seeing.walker.transitions == 2 * 156


def test_different_seeds_give_different_actions() -> None:
    assert walk(learner("q-learning", seed=1), 10) != walk(learner("q-learning", seed=2), 10)
