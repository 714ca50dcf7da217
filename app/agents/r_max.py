"""R-max (Brafman and Tennenholtz 2002)."""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Gt, Le

from app.agents.model_planning import ModelAgent
from app.agents.protocol import AgentState
from app.agents.q_table import legal_columns
from app.domain.settings import Setting
from app.domain.types import Action, Cells, FloatArray

MaxReward = Annotated[
    float,
    Gt(0),
    Le(10),
    Setting(
        title="Highest reward",
        symbol="R",
        unit="m",
        help="What it hopes for wherever it has not been: more than any one step can earn.",
        examples=(0.01, 0.02),
    ),
]
KnownAfter = Annotated[
    int,
    Ge(1),
    Le(100),
    Setting(
        title="Tries until known",
        symbol="m",
        help="How often it tries a step until it takes what followed as a fact.",
        examples=(1, 2, 4),
    ),
]


class RMax(ModelAgent):
    """Learner that takes everything unknown for the best possible: optimism under uncertainty.

    A pair is unknown until it was tried m times, and is then believed for ever. The learner takes
    the best steps of a plan in which an unknown pair earns the highest reward again and again, and
    so goes where something is unknown, or earns well.

    Args:
        max_reward_m: upper bound of the reward of a step [m]; higher ones are taken for it.
        known_after: m.
        settings: as for `ModelAgent`.
    """

    title = "R-max"
    description = "Hopes for the best wherever it has not been, until it has tried every step."
    color = "#CC3311"

    def __init__(
        self,
        *args: Any,
        max_reward_m: MaxReward = 0.02,
        known_after: KnownAfter = 1,
        **settings: Any,
    ) -> None:
        super().__init__(*args, **settings)
        self._max_reward_m, self._known_after = max_reward_m, known_after
        self._planned: list[float] | None = None
        """Value of each pair of the model in the optimistic plan [m]; None if it is out of date."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the best action of the optimistic plan; ties are broken at random."""
        if not self._explore:
            return super().act(observation, legal)
        state, column = self._table.index(observation), self._table.column
        unknown = [action for action in legal if not self._is_known(state, column(action))]
        # No value is higher than that of an unknown action, so that a plan is not needed.
        if unknown:
            return self._any(unknown)
        return self._highest(legal, [self._value(state, column(action)) for action in legal])

    def values(self, observation: Cells) -> FloatArray:
        """Return the values of the optimistic plan, in evaluations those of the table."""
        if not self._explore:
            return super().values(observation)
        table, state = self._table, self._table.index(observation)
        values = np.full(table.actions, np.nan)
        for column in legal_columns(state, table.pairs, table.cells):
            values[column] = self._value(state, column)
        return values.reshape(table.pairs, table.cells)

    def _learn(self, state: int, column: int, reward_m: float, next_state: int) -> None:
        """Add the transition to the model, unless the pair is known."""
        if not self._is_known(state, column):
            self._model.learn(state, column, reward_m, next_state)
            self._planned = None

    def _is_known(self, state: int, column: int) -> bool:
        number = self._model.number(state, column)
        return number is not None and self._model.pairs[number].tries >= self._known_after

    def _value(self, state: int, column: int) -> float:
        """Return the value of a pair in the optimistic plan [m]."""
        number = self._model.number(state, column)
        if number is None:
            return self._highest_value
        if self._planned is None:
            self._planned = self._optimistic_values()
        return self._planned[number]

    @property
    def _highest_value(self) -> float:
        """Upper bound of all values [m]: the highest reward for ever."""
        return self._max_reward_m / (1 - self._gamma)

    def _optimistic_values(self) -> list[float]:
        """Return the value of each pair of the model, if all that is unknown is the best [m]."""
        arrays, highest = self._arrays(), self._highest_value
        known = arrays.tries >= self._known_after
        rewards = np.where(known, np.minimum(arrays.rewards_m, self._max_reward_m), highest)
        counts = known[arrays.outcome_pairs] * arrays.outcome_counts
        shares = counts / arrays.tries[arrays.outcome_pairs]
        untried = np.where(arrays.untried > 0, highest, -np.inf)
        values: list[float] = arrays.solve(
            rewards, shares, untried, self._gamma
        ).pair_values.tolist()
        return values

    def tune(self, **changes: Any) -> None:
        """Change rates from the next step on, as in `ModelAgent`."""
        super().tune(**changes)
        self._planned = None

    def _load_learned(self, state: AgentState) -> None:
        super()._load_learned(state)
        self._planned = None
