"""Sarsa, Expected Sarsa and n-step Sarsa: their updates by hand."""

import numpy as np
import pytest

from hexapods.agents.expected_sarsa import ExpectedSarsa
from hexapods.agents.n_step_sarsa import NStepSarsa
from hexapods.agents.sarsa import Sarsa
from hexapods.domain.types import Action
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, THIRD, A, B, C, set_value, step, value


def test_sarsa_uses_the_next_action_and_not_the_best() -> None:
    agent = Sarsa(np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9)
    set_value(agent, B, SECOND, 2.0)
    set_value(agent, B, THIRD, 1.0)
    agent.learn(step(A, FIRST, 0.1, B, THIRD))

    assert value(agent, A, FIRST) == pytest.approx(0.5 * (0.1 + 0.9 * 1.0))


@pytest.mark.parametrize(
    ("epsilon", "expected"),
    [(0.0, 2.4), (1.0, (2.4 + 1.2) / 12), (0.5, 0.5 * 2.4 + 0.5 * (2.4 + 1.2) / 12)],
)
def test_expected_sarsa_uses_the_mean_under_its_policy(epsilon: float, expected: float) -> None:
    agent = ExpectedSarsa(
        np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9, epsilon_start=epsilon
    )
    set_value(agent, B, SECOND, 2.4)
    set_value(agent, B, THIRD, 1.2)
    agent.learn(step(A, FIRST, 0.1, B))

    assert value(agent, A, FIRST) == pytest.approx(0.5 * (0.1 + 0.9 * expected))


def test_n_step_sarsa_adds_up_n_rewards_and_the_value_after_them() -> None:
    agent = NStepSarsa(np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9, return_steps=2)
    set_value(agent, C, THIRD, 4.0)
    agent.learn(step(A, FIRST, 1.0, B, SECOND))
    assert value(agent, A, FIRST) == 0

    agent.learn(step(B, SECOND, 2.0, C, THIRD))
    assert value(agent, A, FIRST) == pytest.approx(0.5 * (1.0 + 0.9 * 2.0 + 0.81 * 4.0))
    assert value(agent, B, SECOND) == 0
    agent.learn(step(C, THIRD, 3.0, A, Action(2, 4)))
    assert value(agent, B, SECOND) == pytest.approx(0.5 * (2.0 + 0.9 * 3.0))


def test_one_step_sarsa_is_sarsa() -> None:
    one_step = NStepSarsa(np.random.default_rng(0), PROBLEM, return_steps=1)
    plain = Sarsa(np.random.default_rng(0), PROBLEM)
    for agent in (one_step, plain):
        agent.learn(step(A, FIRST, 1.0, B, SECOND))
        agent.learn(step(B, SECOND, 2.0, C, THIRD))
        agent.learn(step(A, FIRST, 1.0, B, SECOND))

    assert one_step.table.sha256() == plain.table.sha256()
