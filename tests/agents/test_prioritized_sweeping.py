"""Prioritized sweeping: the order of its updates by hand."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.prioritized_sweeping import PrioritizedSweeping
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, A, B, C, step, value


def learner(**settings: Any) -> PrioritizedSweeping:
    return PrioritizedSweeping(np.random.default_rng(0), PROBLEM, gamma=0.9, **settings)


def test_a_surprise_is_passed_on_to_the_steps_before() -> None:
    agent = learner(planning_steps=2)
    agent.learn(step(A, FIRST, 0.0, B))
    agent.learn(step(B, SECOND, 1.0, C))

    assert value(agent, B, SECOND) == 1
    assert value(agent, A, FIRST) == pytest.approx(0.9)


def test_the_largest_change_comes_first_and_others_wait() -> None:
    agent = learner(planning_steps=0)
    agent.learn(step(A, FIRST, 0.1, B))
    agent.learn(step(B, SECOND, 1.0, C))
    assert agent.state()["queued"].tolist() == [0, 1]
    assert agent.state()["priorities"].tolist() == pytest.approx([0.1, 1.0])

    resumed = learner(planning_steps=1)
    resumed.load(agent.state())
    resumed.learn(step(C, FIRST, 0.0, C))
    assert value(resumed, B, SECOND) == 1
    assert value(resumed, A, FIRST) == 0
    # The pair that leads to B is now worth 0.1 + 0.9 · 1.
    assert resumed.state()["priorities"].tolist() == pytest.approx([1.0])


def test_update_is_the_mean_over_all_that_followed() -> None:
    agent = learner(planning_steps=10)
    agent.learn(step(B, SECOND, 1.0, C))
    for reward, after in ((0.3, B), (0.0, C), (0.0, C)):
        agent.learn(step(A, FIRST, reward, after))

    # Mean reward 0.1; B, worth 1, came next once in three times, C is worth nothing.
    assert value(agent, A, FIRST) == pytest.approx(0.1 + 0.9 / 3)


def test_changes_below_the_threshold_are_not_worked_on() -> None:
    agent = learner(planning_steps=10, threshold_m=0.05)
    agent.learn(step(A, FIRST, 0.04, B))

    assert value(agent, A, FIRST) == 0
    assert not agent.state()["queued"].size
