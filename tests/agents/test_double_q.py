"""Double Q-learning: its update by hand, and what two tables are for."""

from typing import Any

import numpy as np
import pytest

from hexapods.agents.double_q import DoubleQ
from hexapods.agents.q_learning import QLearning
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.observation import legal_actions
from tests.agents.by_hand import FIRST, PROBLEM, SECOND, THIRD, A, B, C, step, value


class Coin:
    """A generator that draws one lot, again and again."""

    def __init__(self, lot: int) -> None:
        self.lot = lot

    def integers(self, high: int) -> int:
        return min(self.lot, high - 1)


def half(agent: DoubleQ, number: int) -> TabularLearner:
    """Return a learner with one of the two tables, to read it."""
    of_half, state = QLearning(np.random.default_rng(0), PROBLEM), agent.state()
    of_half.table.load({**state, "q": state["halves"][number]})
    return of_half


@pytest.mark.parametrize("drawn", [0, 1])
def test_the_drawn_table_names_the_action_and_the_other_values_it(drawn: int) -> None:
    coin: Any = Coin(drawn)
    agent = DoubleQ(coin, PROBLEM, alpha=0.5, gamma=0.9)
    values = {drawn: (2.0, 1.0), 1 - drawn: (0.4, 3.0)}
    for coin.lot, (second, third) in values.items():
        # What follows is worth nothing yet.
        agent.learn(step(B, SECOND, second / 0.5, C))
        agent.learn(step(B, THIRD, third / 0.5, C))
    coin.lot = drawn
    agent.learn(step(A, FIRST, 0.1, B))

    updated = 0.5 * (0.1 + 0.9 * 0.4)
    assert value(half(agent, drawn), B, SECOND) == pytest.approx(2.0)
    assert value(half(agent, drawn), A, FIRST) == pytest.approx(updated)
    assert value(half(agent, 1 - drawn), A, FIRST) == 0
    assert value(agent, A, FIRST) == pytest.approx(updated / 2)
    assert agent.visits(A)[FIRST] == 1


def test_noise_does_not_raise_values_as_in_q_learning() -> None:
    """Rewards of mean 0 in B: the maximum of noisy values is over 0, which A should be worth."""
    rng = np.random.default_rng(1)
    single = QLearning(np.random.default_rng(0), PROBLEM, alpha=0.1)
    double = DoubleQ(np.random.default_rng(0), PROBLEM, alpha=0.1)
    legal = legal_actions(B, 5)
    for number in range(6000):
        action, reward = legal[number % len(legal)], rng.normal()
        for agent in (single, double):
            agent.learn(step(B, action, reward, (4, 4, 4)))
            agent.learn(step(A, FIRST, 0.0, B))

    assert value(single, A, FIRST) > 0.2
    assert value(double, A, FIRST) < 0.1
