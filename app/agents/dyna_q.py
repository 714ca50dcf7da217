"""Dyna-Q and Dyna-Q+ (Sutton 1990; Sutton and Barto, 2nd edition, §8.2 and §8.3)."""

from math import sqrt
from typing import Annotated, Any

from annotated_types import Ge, Le

from app.agents.planning import PlanningLearner
from app.agents.protocol import Transition
from app.agents.q_table import legal_columns
from app.agents.tabular_model import TriedPair
from app.domain.settings import Setting

Bonus = Annotated[
    float,
    Ge(0),
    Le(0.01),
    Setting(
        title="Curiosity",
        symbol="κ",
        unit="m",
        help="Imagined reward for what it has not tried for long: κ times the root of the steps.",
        examples=(0.0001, 0.0003, 0.001),
    ),
]


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


class DynaQPlus(DynaQ):
    """Dyna-Q that imagines a bonus of κ√τ for a pair that was not tried for τ steps.

    So it tries again what was no good once, and notices a world that has changed. Untried actions
    of a visited state are imagined too, as ones that earn nothing but the bonus and change nothing.

    Args:
        bonus_m: κ [m].
        settings: as for `DynaQ`.
    """

    title = "Dyna-Q+"
    description = "Dyna-Q that grows curious about steps it has not tried for long."
    color = "#999933"

    def __init__(self, *args: Any, bonus_m: Bonus = 0.0001, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._bonus_m = bonus_m

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Update as in Dyna-Q, with all actions of this state in the model from now on."""
        for other in legal_columns(state, self.table.pairs, self.table.cells):
            self._model.imagine(state, other)
        super()._update(transition, state, column)

    def _imagined_reward_m(self, pair: TriedPair) -> float:
        return pair.last_reward_m + self._bonus_m * sqrt(self._model.steps - pair.last_step)
