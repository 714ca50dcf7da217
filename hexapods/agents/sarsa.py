"""Tabular Sarsa (Sutton and Barto, 2nd edition, §6.4)."""

from hexapods.agents.protocol import Transition
from hexapods.agents.tabular import TabularLearner


class Sarsa(TabularLearner):
    """On-policy learner: the update uses the value of the next action, random or not."""

    title = "Sarsa"
    description = "Learns by trying what its steps are worth, its own random steps included."
    color = "#8073C9"
    is_on_policy = True

    next_meaning = "value of the next action, which is chosen already"

    def _next_value(self, transition: Transition) -> float:
        """Q(s, a) ← (1 − α) Q(s, a) + α (r + γ Q(s′, a′))."""
        return self._chosen_next(transition)
