"""Tabular Double Q-learning (van Hasselt 2010; Sutton and Barto, 2nd edition, §6.7)."""

from typing import Any

import numpy as np

from hexapods.agents.protocol import AgentState, Transition
from hexapods.agents.q_table import QTable
from hexapods.agents.tabular import TabularLearner


class DoubleQ(TabularLearner):
    """Off-policy learner with two tables: one chooses the best next action, the other values it.

    A maximum over noisy values is too high on average. Two tables that learned from different steps
    have independent noise, so that the value of the choice is not biased. `table` holds the mean of
    both, in which the policy is ε-greedy.
    """

    title = "Double Q"
    description = "Q-learning with two tables that check each other, against wishful thinking."
    color = "#DDCC77"

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._halves = tuple(QTable(self.table.groups, self.table.cells) for _ in range(2))

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Q₁(s, a) ← (1 − α) Q₁(s, a) + α (r + γ Q₂(s′, argmax Q₁(s′, ·))).

        Which of the two tables is Q₁ is drawn at random; ties of the maximum as well.
        """
        drawn, next_value = self._draw(transition)
        learning, valuing = self._halves[drawn], self._halves[1 - drawn]
        target = self._return_m(transition.reward_m, next_value)
        before = learning.value(state, column)
        after = (1 - self._alpha) * before + self._alpha * target
        learning.set_value(state, column, after)
        self.table.set_value(state, column, (after + valuing.value(state, column)) / 2)
        self._learn_average(target - before)

    def _draw(self, transition: Transition) -> tuple[int, float]:
        """Draw which table is Q₁; return its index, and Q₂(s′, argmax Q₁(s′, ·))."""
        drawn = int(self._rng.integers(2))
        observation, legal = transition.next_observation, transition.next_legal
        best = self._highest(legal, self._halves[drawn].values_of(observation, legal))
        (next_value,) = self._halves[1 - drawn].values_of(observation, [best])
        return drawn, next_value

    def state(self) -> AgentState:
        """Return the state of `TabularLearner`, and the values of both tables at `where`."""
        state = super().state()
        halves = [half.values_at(state["where"]) for half in self._halves]
        return state | {"halves": np.array(halves)}

    def _load_learned(self, state: AgentState) -> None:
        super()._load_learned(state)
        for half, values in zip(self._halves, state["halves"], strict=True):
            half.load({**state, "q": values})

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `TabularLearner` does, and the values of both tables."""
        TabularLearner.check_state(state)
        halves = state["halves"]
        if halves.shape != (2, len(state["q"])) or halves.dtype.kind != "f":
            raise ValueError("its two tables do not fit together")
        if not np.array_equal(halves.sum(axis=0) / 2, state["q"]):
            raise ValueError("its values are not the mean of its two tables")
