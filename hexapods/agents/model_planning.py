"""Planning with a tabular model by value iteration, and the base class of agents that do so."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np

from hexapods.agents.explanation import (
    Belief,
    ChoiceExplanation,
    Term,
    UpdateExplanation,
    ValueUpdate,
)
from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.agents.tabular import Gamma, TabularAgent
from hexapods.agents.tabular_model import TabularModel, check_problem
from hexapods.agents.value_table import ValueTable
from hexapods.domain.settings import declare
from hexapods.domain.types import Action, Cells, FloatArray, IntArray

TOLERANCE_M = 1e-6
"""Value iteration ends when no state's value changes by more [m]."""
MAX_SWEEPS = 2000


class ValueIterationResult(NamedTuple):
    """Outcome of value iteration.

    Attributes:
        pair_values: value of each pair of the model [m].
        later: expected value of the state after each pair [m], undiscounted.
        mean_value: mean value of all states of the problem [m]; 0 unless it was needed.
    """

    pair_values: FloatArray
    mean_value: float
    later: FloatArray


@dataclass(frozen=True)
class UniformTransitions:
    """Transitions to any state of the problem with the same probability, also to unseen states.

    Attributes:
        probabilities: probability of such a transition for each pair of the model.
        unseen_reward_m: the best reward in a state that was never seen [m].
        states: number of states of the problem.
    """

    probabilities: FloatArray
    unseen_reward_m: float
    states: int


class ModelArrays:
    """A model as arrays, for sums over all of its pairs at once.

    Attributes:
        states: indices of the model's states, ascending; "place" is a position in this array.
        places: place of each pair's state.
        columns: column of each pair.
        tries: number of tries of each pair.
        rewards_m: mean reward of each pair [m].
        outcome_pairs, outcome_places, outcome_counts: number of the pair, place of the next state
            and count of each outcome.
        untried: number of legal actions of each state that were never tried.
    """

    def __init__(self, model: TabularModel, groups: int, cells: int) -> None:
        pairs = model.pairs
        outcomes = [pair.outcomes for pair in pairs]
        pair_states = np.array([pair.state for pair in pairs], np.int64)
        next_states = np.fromiter(chain.from_iterable(outcomes), np.int64)
        self.states: IntArray = np.unique(np.concatenate([pair_states, next_states]))
        self.places = np.searchsorted(self.states, pair_states)
        self.columns = np.array([pair.column for pair in pairs], np.int64)
        self.tries = np.array([pair.tries for pair in pairs], np.int64)
        self.rewards_m = np.array([pair.mean_reward_m for pair in pairs], float)
        # NumPy takes counts of its index type alone, which has 32 bits on some machines.
        outcomes_of_pairs = np.array([len(successors) for successors in outcomes], np.intp)
        self.outcome_pairs = np.repeat(np.arange(len(pairs)), outcomes_of_pairs)
        self.outcome_places = np.searchsorted(self.states, next_states)
        counts = chain.from_iterable(successors.values() for successors in outcomes)
        self.outcome_counts = np.fromiter(counts, np.int64)
        tried = np.bincount(self.places, minlength=len(self.states))
        self.untried = groups * (cells - 1) - tried
        # Pairs ordered by their states, so that the maximum of each state is one of a slice.
        self._order = np.argsort(self.places, kind="stable")
        self._with_pairs, self._starts = np.unique(self.places[self._order], return_index=True)

    def best_of_states(self, values: FloatArray, untried_m: FloatArray) -> FloatArray:
        """Return the value of the best action of each state, tried or not [m]."""
        best = untried_m.copy()
        if len(values):
            tried = np.maximum.reduceat(values[self._order], self._starts)
            best[self._with_pairs] = np.maximum(best[self._with_pairs], tried)
        return best

    def solve(
        self,
        rewards_m: FloatArray,
        shares: FloatArray,
        untried_m: FloatArray,
        gamma: float,
        uniform: UniformTransitions | None = None,
    ) -> ValueIterationResult:
        """Return the optimal values by value iteration, to within `TOLERANCE_M`, from zero.

        Args:
            rewards_m: expected reward of each pair [m].
            shares: probability of each outcome.
            untried_m: value of the best untried action of each state [m], −inf without one; with
                `uniform` its reward, since it leads there.
            gamma: discount factor γ.
            uniform: further transitions of the pairs.
        """
        pairs, mean, unseen = len(rewards_m), 0.0, 0.0
        values, states = rewards_m, np.zeros(len(self.states))
        later: FloatArray = np.zeros(pairs)
        for _ in range(MAX_SWEEPS):
            weights = shares * states[self.outcome_places]
            later = np.bincount(self.outcome_pairs, weights, pairs).astype(np.float64)
            untried_values = untried_m
            if uniform is not None:
                mean = _mean(states, unseen, uniform.states)
                later = later + uniform.probabilities * mean
                untried_values = untried_m + gamma * mean
                unseen = uniform.unseen_reward_m + gamma * mean
            values = rewards_m + gamma * later
            before, states = states, self.best_of_states(values, untried_values)
            if np.abs(states - before).max(initial=0.0) <= TOLERANCE_M:
                break
        return ValueIterationResult(values, mean, later)


def _mean(states: FloatArray, unseen: float, count: int) -> float:
    """Return the mean value of all `count` states, of which those without a place are `unseen`."""
    return (float(states.sum()) + (count - len(states)) * unseen) / count


class ModelAgent(TabularAgent):
    """Learner that explores by planning in a learned model, without random steps.

    `table` holds the values of the best plan in the mean of the steps so far; evaluations and races
    follow it. Untried actions are worth 0 in it, as in a new table. A subclass explores by another
    plan.

    Args:
        rng: random generator, the only source of chance.
        problem: determines the size of the table.
        explore: if False, the policy is greedy in the table.
        gamma: discount factor γ.

    Raises:
        InvalidInput: if the problem is too large for a model.
    """

    check_problem = staticmethod(check_problem)

    def __init__(
        self,
        rng: np.random.Generator,
        problem: Problem,
        *,
        explore: bool = True,
        gamma: Gamma = 0.9,
    ) -> None:
        self._is_table_due = False
        self.check_problem(problem)
        super().__init__(rng, problem, explore=explore)
        self._model, self._gamma = TabularModel(), gamma

    @property
    def table(self) -> ValueTable:
        """Visits, and the values of the best plan in the mean of the steps so far."""
        if self._is_table_due:
            self._plan_for_mean()
        return self._table

    @table.setter
    def table(self, table: ValueTable) -> None:
        self._table = table

    def _plan_for_mean(self) -> None:
        self._is_table_due = False
        arrays = self._arrays()
        shares = arrays.outcome_counts / arrays.tries[arrays.outcome_pairs]
        untried = np.where(arrays.untried > 0, 0.0, -np.inf)
        values = arrays.solve(arrays.rewards_m, shares, untried, self._gamma).pair_values.tolist()
        for pair, value in zip(self._model.pairs, values, strict=True):
            self._table.set_value(pair.state, pair.column, value)

    def _arrays(self) -> ModelArrays:
        """Return the model as arrays, for planning."""
        return ModelArrays(self._model, self._table.groups, self._table.cells)

    def learn(self, transition: Transition) -> None:
        """Add the transition to the model, and count the visit."""
        table = self._table
        state, column = self._entry_of(transition.observation, transition.action)
        self._learn(state, column, transition.reward_m, table.index(transition.next_observation))
        table.count_visit(state, column)
        self._is_table_due = True

    def _entry_of(self, observation: Cells, action: Action) -> tuple[int, int]:
        """Return the entry of the table, and so the pair of the model, of an action in a state."""
        return self._table.entry(self._table.index(observation), self._table.column(action))

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        scores = self.values(observation)
        action = self.act(observation, legal)
        return ChoiceExplanation(action, "exploited", "value in the table", scores)

    @abstractmethod
    def _learn(self, state: int, column: int, reward_m: float, next_state: int) -> None:
        """Add a transition to the model, and plan anew if that is due."""

    def explain_update(self, transition: Transition) -> UpdateExplanation:
        """Learn as `learn` does, and explain how model and values change."""
        observation, action = transition.observation, transition.action
        state, column = self._entry_of(observation, action)
        before, model = float(self.values(observation)[action]), self._beliefs(state, column)
        self.learn(transition)
        after = float(self.values(observation)[action])
        rule, terms, summary = self._explain_value(state, column, before)
        beliefs = [
            Belief(old.name, old.before, new.before, old.unit, *deviations)
            for old, new in zip(model, self._beliefs(state, column), strict=True)
            for deviations in [(old.deviation_before, new.deviation_before)]
        ]
        update = ValueUpdate(observation, action, rule, tuple(terms), before, after)
        return UpdateExplanation(summary, update, (), beliefs)

    @abstractmethod
    def _explain_value(
        self, state: int, column: int, before: float
    ) -> tuple[str, Sequence[Term], str]:
        """Return the rule of the present value of a pair, with its terms, and a summary.

        Args:
            state: row of the table.
            column: column of the table.
            before: the value before the last step [m].
        """

    def _beliefs(self, state: int, column: int) -> list[Belief]:
        """Return the model's estimates of a pair, as they are now, for before and after."""
        number = self._model.number(state, column)
        pair = None if number is None else self._model.pairs[number]
        tries, mean = (0, 0.0) if pair is None else (pair.tries, pair.mean_reward_m)
        return [
            Belief("mean reward of its tries", mean, mean),
            Belief("tries that count", tries, tries, "tries"),
        ]

    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts in this state, (pairs, cells), NaN where illegal."""
        return self._table.visits(observation)

    def tune(self, *, gamma: Gamma | None = None) -> None:
        """Change the discount from the next step on."""
        if gamma is not None and gamma != self._gamma:
            self._gamma, self._is_table_due = gamma, True

    def state(self) -> AgentState:
        """Return the values of the plan, the visits, γ and the model."""
        return {**self.table.dump(), "rates": np.array([self._gamma]), **self._model.dump()}

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        self._load_learned(state)
        self._is_table_due = False
        (self._gamma,) = state["rates"].tolist()

    def _load_learned(self, state: AgentState) -> None:
        self._table.load(state)
        self._model.load(state)
        # The values were planned with the discount of another run.
        self._is_table_due = True

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check the discount and the model of a saved state; the table is not checked here.

        Raises:
            InvalidInput: for a discount out of its limits.
            KeyError, TypeError, ValueError: if `state` is not a state of this agent.
        """
        declare("gamma", Gamma).check(*state["rates"].tolist())
        TabularModel.check(state)
        if (state["model_pairs"][:, 2] < 1).any():
            raise ValueError("its model has steps that were never tried")
