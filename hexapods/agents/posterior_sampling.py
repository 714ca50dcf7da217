"""Posterior sampling (Strens 2000; Osband, Russo and Van Roy 2013, PSRL)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Gt, Le

from hexapods.agents.explanation import Belief, ChoiceExplanation, Term
from hexapods.agents.model_planning import ModelAgent, UniformTransitions
from hexapods.agents.protocol import AgentState
from hexapods.agents.value_table import legal_columns
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action, Cells, FloatArray

PlanEvery = Annotated[
    int,
    Ge(1),
    Le(10_000),
    Setting(
        title="Steps per plan",
        help="Steps for which it plans in one sampled model before it draws the next.",
        examples=(5, 10, 25),
    ),
]
PriorDeviation = Annotated[
    float,
    Gt(0),
    Le(1),
    Setting(
        title="Expected spread of rewards",
        unit="m",
        help="How much the rewards of untried steps may differ from 0: higher explores more.",
        examples=(0.002, 0.005, 0.02),
    ),
]
NoiseDeviation = Annotated[
    float,
    Gt(0),
    Le(1),
    Setting(
        title="Expected noise of rewards",
        unit="m",
        help="How much the rewards of the same step may differ from each other.",
        examples=(0.001, 0.003),
    ),
]
PRIOR_WEIGHT = 0.1
"""Weight, in tries, of the belief that a step may end in any state."""


class PosteriorSampling(ModelAgent):
    """Learner that draws a world from the posterior and follows its best plan for some steps.

    Rewards are normally distributed, with a known deviation and a normal prior of mean 0; next
    states have a Dirichlet prior, spread evenly over all states. The more often a pair was tried
    the less it varies between the drawn worlds, so that exploration ends by itself.

    Args:
        plan_every: steps between two draws.
        prior_deviation_m: standard deviation of the prior of expected rewards [m].
        noise_deviation_m: standard deviation of a reward about its expectation [m].
        settings: as for `ModelAgent`.
    """

    title = "Posterior sampling"
    description = "Draws a world that fits what it has seen, and walks as would be best in there."
    color = "#EE3377"

    def __init__(
        self,
        *args: Any,
        plan_every: PlanEvery = 10,
        prior_deviation_m: PriorDeviation = 0.005,
        noise_deviation_m: NoiseDeviation = 0.003,
        **settings: Any,
    ) -> None:
        super().__init__(*args, **settings)
        self._plan_every = plan_every
        self._prior_m, self._noise_m = prior_deviation_m, noise_deviation_m
        self._planned: dict[int, FloatArray] = {}
        """Values in the drawn world [m], (actions,), by state; for states of the model then."""
        self._drawn: tuple[FloatArray, FloatArray] | None = None
        """Rewards and expected later values of the pairs in the newest world that was drawn."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the best action in the drawn world; a random one in a state without a plan."""
        if not self._explore:
            return super().act(observation, legal)
        values = self._planned.get(self._table.index(observation))
        if values is None:
            # All actions of an unseen state have the same prior.
            return self._any(legal)
        row, column = values.tolist(), self._table.column
        return self._highest(legal, [row[column(action)] for action in legal])

    def values(self, observation: Cells) -> FloatArray:
        """Return the values in the drawn world, in evaluations those of the table."""
        planned = self._planned.get(self._table.index(observation))
        if not self._explore:
            return super().values(observation)
        values = np.zeros(self._table.actions) if planned is None else planned.copy()
        values = values.reshape(self._table.groups, self._table.cells)
        values[range(self._table.groups), observation] = np.nan
        return values

    def _learn(self, state: int, column: int, reward_m: float, next_state: int) -> None:
        """Add the transition to the model, and every `plan_every` steps draw a world."""
        self._model.learn(state, column, reward_m, next_state)
        if self._model.steps % self._plan_every == 0:
            self._draw()

    def _draw(self) -> None:
        """Draw a world from the posterior, and plan in it."""
        rng, arrays, table = self._rng, self._arrays(), self._table
        expected, precision = self._posterior(arrays.tries, arrays.rewards_m)
        rewards = expected + rng.standard_normal(len(expected)) / np.sqrt(precision)
        # A Dirichlet distribution is one of independent gamma variables divided by their sum.
        seen = rng.standard_gamma(arrays.outcome_counts)
        unseen = rng.standard_gamma(PRIOR_WEIGHT, len(expected))
        total = np.bincount(arrays.outcome_pairs, seen, len(expected)) + unseen
        untried = self._prior_m * rng.standard_normal((len(arrays.states), table.actions))
        is_open = np.zeros(untried.shape, bool)
        for place, state in enumerate(arrays.states.tolist()):
            is_open[place, list(legal_columns(state, table.groups, table.cells))] = True
        is_open[arrays.places, arrays.columns] = False
        best = np.where(is_open, untried, -np.inf).max(axis=1)
        actions = table.actions - table.groups
        uniform = UniformTransitions(
            unseen / total,
            float(self._prior_m * rng.standard_normal(actions).max()),
            table.states,
        )
        shares = seen / total[arrays.outcome_pairs]
        plan = arrays.solve(rewards, shares, best, self._gamma, uniform)
        values = untried + self._gamma * plan.mean_value
        values[arrays.places, arrays.columns] = plan.pair_values
        self._drawn = rewards, plan.later
        self._planned = dict(zip(arrays.states.tolist(), values, strict=True))

    def _posterior(self, tries: Any, mean_rewards_m: Any) -> tuple[Any, Any]:
        """Return the posterior means of rewards [m], and their precisions [1/m²]."""
        precision = tries / self._noise_m**2 + 1 / self._prior_m**2
        return tries * mean_rewards_m / self._noise_m**2 / precision, precision

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        explained = super().explain_choice(observation, legal)
        if not self._explore:
            return explained
        is_planned = self._table.index(observation) in self._planned
        return replace(
            explained,
            kind="exploited" if is_planned else "unknown",
            criterion="value in the world that it drew",
        )

    def _explain_value(
        self, state: int, column: int, before: float
    ) -> tuple[str, Sequence[Term], str]:
        left = -self._model.steps % self._plan_every
        number = self._model.number(state, column)
        if left or self._drawn is None or number is None or not self._explore:
            count = f"{left} step{'s' * (left != 1)}"
            summary = f"It goes on believing in the world that it drew, for {count} more."
            return "Q", [Term("Q", before, "value before")], summary
        rewards_m, later = self._drawn
        terms = (
            Term("r̂", float(rewards_m[number]), "reward in the world that it drew now [m]"),
            Term("γ", self._gamma, "discount"),
            Term("V′", float(later[number]), "expected value of what follows in that world"),
        )
        return "r̂ + γ · V′", terms, "It drew another world that fits what it has seen, and planned."

    def _beliefs(self, state: int, column: int) -> list[Belief]:
        tried, count = super()._beliefs(state, column)
        mean, precision = self._posterior(count.before, tried.before)
        deviation = float(1 / np.sqrt(precision))
        believed = Belief("expected reward", mean, mean, "m", deviation)
        return [believed, tried, count]

    def state(self) -> AgentState:
        """Return the state of `ModelAgent`, and the plan."""
        rows = list(self._planned.values())
        return super().state() | {
            "plan_states": np.array(list(self._planned), np.int64),
            "plan_values": np.array(rows, float).reshape(-1, self._table.actions),
        }

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        super().load(state)
        rows = zip(state["plan_states"].tolist(), state["plan_values"].copy(), strict=True)
        self._planned = dict(rows)

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `ModelAgent` does, and the plan."""
        ModelAgent.check_state(state)
        groups, cells = state["shape"].tolist()
        states, values = state["plan_states"], state["plan_values"]
        if states.dtype.kind != "i" or values.shape != (len(states), groups * cells):
            raise ValueError("its plan is of another problem")
        if values.dtype.kind != "f" or not np.isfinite(values).all():
            raise ValueError("its plan has values that are no numbers")
