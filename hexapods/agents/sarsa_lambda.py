"""Tabular Sarsa(λ) with replacing traces (Sutton and Barto 1998, §7.5 and §7.8)."""

from hexapods.agents.protocol import Transition
from hexapods.agents.traces import TraceLearner


class SarsaLambda(TraceLearner):
    """On-policy learner with eligibility traces, which credit a reward to earlier steps as well."""

    title = "Sarsa(λ)"
    description = "Learns by trying; each reward also counts for the steps that led to it."
    color = "#0072B2"
    is_on_policy = True

    next_meaning = "value of the next action, which is chosen already"

    def _next_value(self, transition: Transition) -> float:
        """Credit δ = r + γ Q(s′, a′) − Q(s, a) to every step with a trace."""
        return self._chosen_next(transition)
