"""Dyna-Q (Sutton 1990; Sutton and Barto, 2nd edition, §8.2)."""

from hexapods.agents.planning import PlanningLearner
from hexapods.agents.protocol import Transition
from hexapods.agents.tabular_model import TriedPair


class DynaQ(PlanningLearner):
    """Q-learning that repeats remembered steps: each real step is followed by n imagined ones.

    Imagined steps are pairs of the model, drawn at random, with the outcome of their newest try:
    the world is assumed to be deterministic.
    """

    title = "Dyna-Q"
    description = "Q-learning that goes over remembered steps again after each new one."
    color = "#4C9A3F"

    next_meaning = "highest value in the next state"

    def _next_value(self, transition: Transition) -> float:
        return self._best_next(transition)

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Update as in Q-learning, add the step to the model, and plan."""
        super()._update(transition, state, column)
        after = self.table.index(transition.next_observation)
        self._model.learn(state, column, transition.reward_m, after)
        self._plan()

    def _plan(self) -> None:
        """Apply the update of Q-learning to n pairs of the model, drawn with replacement."""
        pairs = self._model.pairs
        for number in self._rng.integers(len(pairs), size=self._planning_steps).tolist():
            pair = pairs[number]
            reward, best = self._imagined_reward_m(pair), self.table.best(pair.last_next)
            self._move_towards(pair.state, pair.column, self._return_m(reward, best))

    def _imagined_reward_m(self, pair: TriedPair) -> float:
        """Return the reward [m] of an imagined step."""
        return pair.last_reward_m
