"""Tabular Q-learning (paper, Algorithm 1)."""

from app.agents.protocol import Transition
from app.agents.tabular import TabularLearner


class QLearning(TabularLearner):
    """Off-policy learner: the update uses the maximum action value of the next state."""

    title = "Q-learning"
    description = "Learns by trying, knows nothing beforehand, and then decides without thinking."
    color = "#E69F00"

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Q(s, a) ← (1 − α) Q(s, a) + α (r + γ max Q(s′, ·)). No state is terminal."""
        target = transition.reward_m + self._gamma * self._best_next(transition)
        self._move_towards(state, column, target)
