"""Tabular Expected Sarsa (Sutton and Barto, 2nd edition, §6.6)."""

from hexapods.agents.explanation import Rule, Term
from hexapods.agents.protocol import Transition
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.sums import ordered_sum


class ExpectedSarsa(TabularLearner):
    """On-policy learner: the update uses the mean value of the next action under its policy.

    The mean over all actions that the ε-greedy policy may take has less variance than the value of
    the one that it happens to take, as in Sarsa.
    """

    title = "Expected Sarsa"
    description = "Sarsa that reckons with the average of its next steps, not with the one it drew."
    color = "#BF6FC4"

    def _next_value(self, transition: Transition) -> float:
        """Q(s, a) ← (1 − α) Q(s, a) + α (r + γ Σ π(a′|s′) Q(s′, a′)), π being ε-greedy."""
        epsilon, values = self.epsilon, self._next_values(transition)
        return (1 - epsilon) * max(values) + epsilon * ordered_sum(values) / len(values)

    def _next_values(self, transition: Transition) -> list[float]:
        return self.table.values_of(transition.next_observation, transition.next_legal)

    def _explain_next(self, transition: Transition) -> Rule:
        values = self._next_values(transition)
        return "((1 − ε) · Q⁺ + ε · Σ / n)", (
            Term("ε", self.epsilon, "probability that the next action is a random one"),
            Term("Q⁺", max(values), "highest value in the next state"),
            Term("Σ", ordered_sum(values), "sum of all values in the next state"),
            Term("n", len(values), "number of actions there"),
        )
