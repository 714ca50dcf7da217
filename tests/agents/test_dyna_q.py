"""Dyna-Q and Dyna-Q+: planning by hand."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.dyna_q import DynaQ
from hexapods.agents.dyna_q_plus import DynaQPlus
from hexapods.domain.types import Action
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, A, B, C, step, value


def learner(**settings: Any) -> DynaQ:
    return DynaQ(np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9, **settings)


def curious(**settings: Any) -> DynaQPlus:
    return DynaQPlus(np.random.default_rng(0), PROBLEM, gamma=0.9, **settings)


def test_planning_repeats_the_only_remembered_step() -> None:
    agent = learner(planning_steps=2)
    agent.learn(step(A, FIRST, 1.0, B))

    assert value(agent, A, FIRST) == pytest.approx(1 - 0.5**3)
    assert agent.visits(A)[FIRST] == 1


def test_planning_carries_a_reward_to_the_steps_before() -> None:
    agent = learner(planning_steps=100)
    agent.learn(step(A, FIRST, 0.0, B))
    agent.learn(step(B, SECOND, 1.0, C))

    assert value(agent, B, SECOND) == pytest.approx(1, abs=1e-6)
    assert value(agent, A, FIRST) == pytest.approx(0.9, abs=1e-6)


def test_without_planning_it_is_q_learning() -> None:
    agent = learner(planning_steps=0)
    agent.learn(step(A, FIRST, 0.0, B))
    agent.learn(step(B, SECOND, 1.0, C))

    assert value(agent, B, SECOND) == 0.5
    assert value(agent, A, FIRST) == 0


def test_the_newest_outcome_is_the_one_remembered() -> None:
    agent = learner(planning_steps=60)
    agent.learn(step(A, FIRST, 1.0, B))
    agent.learn(step(A, FIRST, -1.0, C))

    assert value(agent, A, FIRST) == pytest.approx(-1, abs=1e-6)


def test_bonus_grows_with_the_root_of_the_steps_since_the_last_try() -> None:
    agent = curious(alpha=1.0, bonus_m=0.01, planning_steps=500)
    agent.learn(step(A, FIRST, 0.5, B))
    # One step ago; B has not been left, so nothing is known of it.
    assert value(agent, A, FIRST) == pytest.approx(0.5 + 0.01)

    for _ in range(3):
        agent.learn(step(C, SECOND, 0.0, C))
    assert value(agent, A, FIRST) == pytest.approx(0.5 + 0.01 * 2)


def test_untried_actions_of_a_visited_state_are_imagined() -> None:
    agent = curious(alpha=1.0, bonus_m=0.01, planning_steps=2000)
    agent.learn(step(A, FIRST, 0.0, B))

    # It leads back to A and earns the bonus of one step, for ever: 0.01 / (1 − 0.9).
    untried = Action(2, 3)
    assert value(agent, A, untried) == pytest.approx(0.1, abs=1e-6)
    assert agent.visits(A)[untried] == 0
    assert value(agent, B, SECOND) == 0


def test_untried_values_survive_a_checkpoint() -> None:
    agent, copy = curious(bonus_m=0.01), curious(bonus_m=0.01)
    agent.learn(step(A, FIRST, 0.0, B))
    copy.load(agent.state())

    assert copy.table.sha256() == agent.table.sha256()
