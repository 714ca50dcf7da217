"""Watkins's Q(λ) with replacing traces (Sutton and Barto 1998, §7.6; 2nd edition, §12.10)."""

from hexapods.agents.protocol import Transition
from hexapods.agents.traces import TraceLearner


class QLambda(TraceLearner):
    """Off-policy learner with eligibility traces, which end where the learner explores.

    A reward is credited to earlier steps as long as greedy actions led to it: with an exploratory
    action in between it does not belong to the greedy policy.
    """

    title = "Q(λ)"
    description = (
        "Q-learning whose rewards also count for the steps before, back to the last random one."
    )
    color = "#B4466F"

    next_meaning = "highest value in the next state"

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Credit δ = r + γ max Q(s′, ·) − Q(s, a); a step that was not greedy ends all traces."""
        if self.table.value(state, column) < self.table.best(state):
            self._traces.clear()
        super()._update(transition, state, column)

    def _next_value(self, transition: Transition) -> float:
        return self._best_next(transition)
