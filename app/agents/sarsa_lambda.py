"""Tabular Sarsa(λ) with replacing traces (Sutton and Barto 1998, §7.5 and §7.8)."""

from app.agents.protocol import Transition
from app.agents.traces import TraceLearner


class SarsaLambda(TraceLearner):
    """On-policy learner with eligibility traces, which credit a reward to earlier steps as well."""

    title = "Sarsa(λ)"
    description = "Learns by trying; each reward also counts for the steps that led to it."
    color = "#0072B2"
    is_on_policy = True

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Credit δ = r + γ Q(s′, a′) − Q(s, a) to every step with a trace."""
        value = self.table.row(state)[0][column]
        target = transition.reward_m + self._gamma * self._chosen_next(transition)
        self._credit(state, column, target - value)
