"""Tabular Expected Sarsa (Sutton and Barto, 2nd edition, §6.6)."""

from hexapods.agents.protocol import Transition
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.sums import ordered_sum


class ExpectedSarsa(TabularLearner):
    """On-policy learner: the update uses the mean value of the next action under its policy.

    The mean over all actions of the ε-greedy policy has less variance than the value of the action
    that is drawn, as in Sarsa.
    """

    title = "Expected Sarsa"
    description = "Sarsa that reckons with the average of its next steps, not with the one it drew."
    color = "#BF6FC4"

    def _next_value(self, transition: Transition) -> float:
        """Q(s, a) ← (1 − α) Q(s, a) + α (r + γ Σ π(a′|s′) Q(s′, a′)), π being ε-greedy."""
        values = self.table.values_of(transition.next_observation, transition.next_legal)
        epsilon = self.epsilon
        return (1 - epsilon) * max(values) + epsilon * ordered_sum(values) / len(values)
