"""Tabular Q-learning (paper, Algorithm 1)."""

from hexapods.agents.protocol import Transition
from hexapods.agents.tabular import TabularLearner


class QLearning(TabularLearner):
    """Off-policy learner: the update uses the maximum action value of the next state."""

    title = "Q-learning"
    description = "Learns by trying, knows nothing beforehand, and then decides without thinking."
    color = "#E69F00"

    next_meaning = "highest value in the next state"

    def _next_value(self, transition: Transition) -> float:
        """Q(s, a) ← (1 − α) Q(s, a) + α (r + γ max Q(s′, ·))."""
        return self._best_next(transition)
