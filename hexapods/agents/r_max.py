"""R-max (Brafman and Tennenholtz 2002)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, NamedTuple

import numpy as np
from annotated_types import Ge, Gt, Le

from hexapods.agents.explanation import ChoiceExplanation, Term
from hexapods.agents.model_planning import ModelAgent
from hexapods.agents.protocol import AgentState
from hexapods.agents.value_table import legal_columns
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action, Cells, FloatArray

MaxReward = Annotated[
    float,
    Gt(0),
    Le(10),
    Setting(
        title="Highest reward",
        symbol="R",
        unit="m",
        help="Assumed reward of an untried step; at least the highest possible.",
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
        help="Visits after which a state-action pair counts as known.",
        examples=(1, 2, 4),
    ),
]


class _OptimisticPlan(NamedTuple):
    """Values, rewards and expected later values of the pairs of the model [m]."""

    values: list[float]
    rewards_m: list[float]
    later: list[float]


class RMax(ModelAgent):
    """Learner that takes everything unknown for the best possible: optimism under uncertainty.

    A pair is unknown until it was tried m times; then its estimates no longer change. The learner
    takes the best steps of a plan in which an unknown pair earns the highest reward in every step,
    and so goes where pairs are unknown, or earn well.

    Args:
        max_reward_m: upper bound of the reward of a step [m]; higher rewards are cut to it.
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
        self._planned: _OptimisticPlan | None = None
        """Plan for the pairs of the model; None if it is out of date."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the best action of the optimistic plan; ties are broken at random."""
        if not self._explore:
            return super().act(observation, legal)
        entries = [self._entry_of(observation, action) for action in legal]
        unknown = [
            action
            for action, entry in zip(legal, entries, strict=True)
            if not self._is_known(*entry)
        ]
        # No value is higher than that of an unknown action, so that a plan is not needed.
        if unknown:
            return self._any(unknown)
        return self._highest(legal, [self._value(*entry) for entry in entries])

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        explained = super().explain_choice(observation, legal)
        if not self._explore:
            return explained
        is_known = self._is_known(*self._entry_of(observation, explained.action))
        return replace(
            explained,
            kind="exploited" if is_known else "unknown",
            criterion="value in its plan, in which what is unknown is the best possible",
        )

    def values(self, observation: Cells) -> FloatArray:
        """Return the values of the optimistic plan, in evaluations those of the table."""
        if not self._explore:
            return super().values(observation)
        table, state = self._table, self._table.index(observation)
        values = np.full(table.actions, np.nan)
        for column in legal_columns(state, table.groups, table.cells):
            values[column] = self._value(*table.entry(state, column))
        return values.reshape(table.groups, table.cells)

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
        return self._plan.values[number]

    @property
    def _plan(self) -> "_OptimisticPlan":
        if self._planned is None:
            self._planned = self._optimistic_plan()
        return self._planned

    @property
    def _highest_value(self) -> float:
        """Upper bound of all values [m]: the highest reward in every step."""
        return self._max_reward_m / (1 - self._gamma)

    def _optimistic_plan(self) -> "_OptimisticPlan":
        """Return the plan in which every unknown pair has the highest value."""
        arrays, highest = self._arrays(), self._highest_value
        is_known = arrays.tries >= self._known_after
        rewards = np.where(is_known, np.minimum(arrays.rewards_m, self._max_reward_m), highest)
        counts = is_known[arrays.outcome_pairs] * arrays.outcome_counts
        shares = counts / arrays.tries[arrays.outcome_pairs]
        untried = np.where(arrays.untried > 0, highest, -np.inf)
        plan = arrays.solve(rewards, shares, untried, self._gamma)
        return _OptimisticPlan(plan.pair_values.tolist(), rewards.tolist(), plan.later.tolist())

    def _explain_value(
        self, state: int, column: int, before: float
    ) -> tuple[str, Sequence[Term], str]:
        if not self._explore:
            return "Q", [Term("Q", before, "value before")], "It only follows what it learned."
        number = self._model.number(state, column)
        if number is None or not self._is_known(state, column):
            highest = (
                Term("R", self._max_reward_m, "highest reward, hoped for in every step [m]"),
                Term("γ", self._gamma, "discount"),
            )
            return "R / (1 − γ)", highest, "It is still unknown, so it is hoped to be the best."
        terms = (
            Term("r̂", self._plan.rewards_m[number], "mean reward of its tries, at most R [m]"),
            Term("γ", self._gamma, "discount"),
            Term("V′", self._plan.later[number], "expected value of what follows, by its plan"),
        )
        became = self._value(state, column) != before
        summary = "It is known, and its value stays as it was planned."
        if became:
            summary = "The update changes its plan, in which this step is known now."
        return "r̂ + γ · V′", terms, summary

    def tune(self, **changes: Any) -> None:
        """Change rates from the next step on, as in `ModelAgent`."""
        super().tune(**changes)
        self._planned = None

    def _load_learned(self, state: AgentState) -> None:
        super()._load_learned(state)
        self._planned = None
