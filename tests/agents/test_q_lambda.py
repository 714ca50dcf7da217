"""Watkins's Q(λ): its update by hand."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.q_lambda import QLambda
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, THIRD, A, B, C, set_value, step, value


def learner(**settings: Any) -> QLambda:
    return QLambda(np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9, **settings)


def test_reward_of_a_greedy_step_is_credited_to_the_step_before() -> None:
    agent = learner(trace_decay=0.8)
    set_value(agent, B, SECOND, 0.2)
    agent.learn(step(A, FIRST, 0.0, B))
    agent.learn(step(B, SECOND, 1.0, C))

    first = 0.5 * 0.9 * 0.2
    error = 1.0 - 0.2
    assert value(agent, B, SECOND) == pytest.approx(0.2 + 0.5 * error)
    assert value(agent, A, FIRST) == pytest.approx(first + 0.5 * error * 0.9 * 0.8)


def test_exploratory_step_ends_the_traces() -> None:
    agent = learner(trace_decay=0.8)
    set_value(agent, B, SECOND, 0.2)
    agent.learn(step(A, FIRST, 0.0, B))
    agent.learn(step(B, THIRD, 1.0, C))

    assert value(agent, B, THIRD) == pytest.approx(0.5 * 1.0)
    assert value(agent, A, FIRST) == pytest.approx(0.5 * 0.9 * 0.2)


def test_update_uses_the_best_next_action() -> None:
    agent = learner(trace_decay=0.0)
    set_value(agent, B, SECOND, 0.2)
    set_value(agent, B, THIRD, 0.1)
    agent.learn(step(A, FIRST, 0.3, B))

    assert value(agent, A, FIRST) == pytest.approx(0.5 * (0.3 + 0.9 * 0.2))
