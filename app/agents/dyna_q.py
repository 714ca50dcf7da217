"""Dyna-Q (Sutton 1990; Sutton and Barto, 2nd edition, §8.2)."""

from app.agents.planning import PlanningLearner
from app.agents.protocol import Transition
from app.agents.tabular_model import TriedPair


class DynaQ(PlanningLearner):
    """Q-learning that repeats remembered steps: each real step is followed by n imagined ones.

    Imagined steps start from tried pairs drawn by lot, and end as the newest try of the pair did:
    the world is assumed to be deterministic.
    """

    title = "Dyna-Q"
    description = "Q-learning that goes over remembered steps again after each new one."
    color = "#4C9A3F"

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Update as in Q-learning, add the step to the model, and plan."""
        target = transition.reward_m + self._gamma * self._best_next(transition)
        self._move_towards(state, column, target)
        after = self.table.index(transition.next_observation)
        self._model.learn(state, column, transition.reward_m, after)
        self._plan()

    def _plan(self) -> None:
        """Apply the update of Q-learning to n pairs of the model, drawn with replacement."""
        pairs = self._model.pairs
        for number in self._rng.integers(len(pairs), size=self._planning_steps).tolist():
            pair = pairs[number]
            target = self._imagined_reward_m(pair) + self._gamma * self.table.best(pair.last_next)
            self._move_towards(pair.state, pair.column, target)

    def _imagined_reward_m(self, pair: TriedPair) -> float:
        """Return the reward [m] of an imagined step."""
        return pair.last_reward_m
