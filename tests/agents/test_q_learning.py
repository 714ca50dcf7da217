"""Q-learning: the update by hand, ε-greedy, its schedule and its rates."""

from collections import Counter
from typing import Any

import numpy as np
import pytest

from hexapods.agents.protocol import Problem, Transition, Tunable, Valuing
from hexapods.agents.q_learning import QLearning
from hexapods.agents.tabular import EpsilonSchedule
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells

PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells)


def learner(seed: int = 0, **settings: Any) -> QLearning:
    return QLearning(np.random.default_rng(seed), PROBLEM, **settings)


def transition(
    before: Cells = (0, 0, 0),
    action: tuple[int, int] = (1, 2),
    reward_m: float = 0.01,
    after: Cells = (0, 2, 0),
) -> Transition:
    return Transition(before, Action(*action), reward_m, after, legal_actions(after, 5))


def test_the_defaults_are_the_papers() -> None:
    rates = learner().state()["rates"]

    assert rates[:2].tolist() == [0.3, 0.9]
    assert learner().epsilon == 1
    assert not learner().table.dump()["where"].size


def test_update_equals_algorithm_1_by_hand() -> None:
    agent = learner(alpha=0.3, gamma=0.9)
    agent.learn(transition())  # 0.7 · 0 + 0.3 · (0.01 + 0.9 · 0)
    assert agent.values((0, 0, 0))[1, 2] == pytest.approx(0.003)

    agent.learn(transition(before=(0, 2, 0), action=(0, 1), reward_m=0.02, after=(1, 2, 0)))
    agent.learn(transition(reward_m=-0.01))  # 0.7 · 0.003 + 0.3 · (−0.01 + 0.9 · 0.006)
    assert agent.values((0, 0, 0))[1, 2] == pytest.approx(0.00072)

    visits = agent.visits((0, 0, 0))
    assert visits[1, 2] == 2
    assert np.nansum(visits) == 2
    assert np.isnan(visits[range(3), 0]).all()


def test_illegal_next_actions_are_not_in_the_maximum() -> None:
    agent = learner(alpha=1, gamma=0.9)
    agent.table.set_value(agent.table.index((0, 2, 0)), agent.table.column(Action(1, 2)), 9)
    agent.learn(transition())

    assert agent.values((0, 0, 0))[1, 2] == 0.01


def test_without_exploration_the_best_action_is_chosen() -> None:
    agent = learner(explore=False)
    agent.table.set_value(0, agent.table.column(Action(2, 3)), 0.1)
    legal = legal_actions((0, 0, 0), 5)

    assert agent.epsilon == 0
    assert {agent.act((0, 0, 0), legal) for _ in range(50)} == {Action(2, 3)}


def test_ties_are_broken_at_random() -> None:
    agent = learner(explore=False)
    best = [Action(0, 4), Action(1, 1), Action(2, 3)]
    for action in best:
        agent.table.set_value(0, agent.table.column(action), 0.1)
    chosen = Counter(agent.act((0, 0, 0), legal_actions((0, 0, 0), 5)) for _ in range(3000))

    assert set(chosen) == set(best)
    assert all(count == pytest.approx(1000, rel=0.1) for count in chosen.values())


def test_epsilon_is_the_share_of_random_actions() -> None:
    agent = learner(epsilon_start=0.24, epsilon_end=0.24)
    agent.table.set_value(0, agent.table.column(Action(2, 3)), 0.1)
    legal = legal_actions((0, 0, 0), 5)
    chosen = Counter(agent.act((0, 0, 0), legal) for _ in range(12_000))

    assert set(chosen) == set(legal)
    other_counts = [count for action, count in chosen.items() if action != (2, 3)]
    assert sum(other_counts) == pytest.approx(12_000 * 0.24 * 11 / 12, rel=0.05)
    assert all(count == pytest.approx(240, rel=0.3) for count in other_counts)


@pytest.mark.parametrize(
    ("episodes", "epsilons"),
    [
        (1, [1, 1]),
        (2, [1, 0, 0]),
        (5, [1, 0.75, 0.5, 0.25, 0, 0]),
        (10, [1 - e / 9 for e in range(10)]),
    ],
)
def test_epsilon_falls_linearly_over_the_episodes_and_stays(
    episodes: int, epsilons: list[float]
) -> None:
    schedule = EpsilonSchedule(1.0, 0.0, episodes)

    assert [schedule(e) for e in range(len(epsilons))] == pytest.approx(epsilons)


def test_epsilon_schedule_has_configurable_ends() -> None:
    schedule = EpsilonSchedule(0.2, 0.8, 4)

    assert [schedule(e) for e in range(4)] == pytest.approx([0.2, 0.4, 0.6, 0.8])


def test_last_partial_episode_counts() -> None:
    agent = learner(steps=120, steps_per_episode=50)
    epsilons = []
    for _ in range(120):
        epsilons.append(agent.epsilon)
        agent.learn(transition())

    assert epsilons == [1] * 50 + [0.5] * 50 + [0] * 20


def test_rates_can_be_changed_between_two_steps() -> None:
    agent = learner(steps=100)
    agent.tune(alpha=1.0, gamma=0.0)
    agent.learn(transition(reward_m=0.02))
    assert agent.values((0, 0, 0))[1, 2] == 0.02
    assert agent.epsilon == 1

    agent.tune(epsilon=0.3)
    for _ in range(60):
        agent.learn(transition())
    assert agent.epsilon == 0.3


def test_state_has_the_rates_and_the_position_in_the_schedule() -> None:
    agent, copy = learner(steps=100), learner(steps=100)
    agent.tune(alpha=0.5)
    for _ in range(70):
        agent.learn(transition())
    copy.load(agent.state())
    assert copy.epsilon == agent.epsilon == 0
    assert copy.state()["rates"][0] == 0.5

    agent.tune(epsilon=0.1)
    copy.load(agent.state())
    assert copy.epsilon == 0.1


def test_continue_from_restarts_the_schedule_and_does_not_load_rates() -> None:
    agent, successor = learner(), learner(alpha=0.1)
    for _ in range(500):
        agent.learn(transition())
    successor.continue_from(agent.state())

    assert successor.table.sha256() == agent.table.sha256()
    assert np.array_equal(successor.table.dump()["n"], agent.table.dump()["n"])
    assert successor.epsilon == 1
    assert successor.state()["rates"][0] == 0.1


def test_q_learning_is_tunable_and_valuing() -> None:
    assert isinstance(learner(), Tunable)
    assert isinstance(learner(), Valuing)
