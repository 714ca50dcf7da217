"""Generalising learner for bodies that tip: a multilevel model of the reward, and a plan with it.

Where a body tips onto the feet that swing, what a step earns depends on which group moved and where
it came from, not only on where the feet stand after landing. The model has a level for each, and
learns from every step about all pairs with the same landing. Sources: partial pooling (Gelman and
Hill 2007), optimism by posterior deviations (Li et al. 2010), value iteration (Sutton & Barto 2018,
§4.4).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.explanation import (
    Belief,
    ChoiceExplanation,
    Term,
    UpdateExplanation,
    ValueUpdate,
    in_millimetres,
)
from hexapods.agents.linear_model import Optimism
from hexapods.agents.multilevel_regression import Level, MultilevelRegression, PairLayout
from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.agents.q_table import table_size
from hexapods.agents.tabular import Gamma
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import declare
from hexapods.domain.types import Action, Cells, FloatArray, IntArray

MAX_PAIRS = 30_000
"""Maximum of state-action pairs: after each step the model plans for all of them."""
_LAW_TRIES = 0.3
"""Weight, in tries, of the next state by the law of a step without slip."""
_TOLERANCE = 1e-3
"""Value iteration ends when no state's value changes by more, as a share of half the side."""
_MAX_SWEEPS = 300


class _Plan(NamedTuple):
    """Values by value iteration, and their components [m].

    Attributes:
        levels: posterior of the rewards.
        later: expected value of the state after each pair, (pairs,).
        values: mean + β · deviation + γ · later, (pairs,).
        state_values: the highest value of each state, (states,).
    """

    levels: tuple[Level, ...]
    later: FloatArray
    values: FloatArray
    state_values: FloatArray


class MultilevelModel:
    """Learner with a multilevel regression of the reward, and counts of the states that followed.

    It takes the step with the highest value in a plan by value iteration, in which a step earns its
    expected reward plus β standard deviations. The states that follow are counted by landing and
    mover; where there are few, the law of a step without slip predicts them. It makes no random
    choices: ties go to the first action in `legal`. No evidence is discounted.

    Args:
        problem: number of groups, and the cells' displacements.
        explore: if False, the plan has expected rewards alone.
        optimism: β, the weight of the posterior's standard deviation.
        gamma: discount factor γ.

    Raises:
        InvalidInput: if there are more than `MAX_PAIRS` state-action pairs.
    """

    title = "Multilevel model"
    description = "Learns what each landing is worth, and by which legs, and plans ahead."
    color = "#0F7B6C"
    needs_practice = True
    keeps_learning = True

    def __init__(
        self,
        problem: Problem,
        *,
        explore: bool = True,
        optimism: Optimism = 0.5,
        gamma: Gamma = 0.9,
    ) -> None:
        self.check_problem(problem)
        self._explore, self._optimism, self._gamma = explore, optimism, gamma
        self._tuned = np.full(2, np.nan)
        """Optimism and discount that replace those of the constructor; NaN where none does."""
        self._layout = PairLayout(problem)
        self._regression = MultilevelRegression(problem, self._layout)
        self._tolerance_m = _TOLERANCE * (float(np.abs(problem.cells_m).max()) or 1.0)
        self._law_next = self._layout.next_by_law(problem)
        self._tries: IntArray = np.zeros(self._layout.pairs, np.int64)
        self._reward_sums_m: FloatArray = np.zeros(self._layout.pairs)
        self._next: dict[tuple[int, int], int] = {}
        """Number of times that each state followed, by (landing with mover, state)."""
        self._first_values: FloatArray = np.zeros(self._layout.states)
        """Values of the states with which the next value iteration begins [m]: those of the plan
        for the last step. A plan follows from them and the evidence alone."""
        self._planned: _Plan | None = None
        """The plan; None if it is out of date."""

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the action with the highest value in the plan."""
        values = self._plan.values[[self._pair(observation, action) for action in legal]]
        return legal[int(values.argmax())]

    def explain_choice(self, observation: Cells, legal: Sequence[Action]) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        criterion = "expected reward of the step"
        if self._beta:
            criterion += f", plus {self._beta:g} standard deviations"
        criterion += ", and the value of what follows by its plan"
        scores = np.full((self._layout.groups, self._layout.cells), np.nan)
        for action in legal:
            scores[action] = self._plan.values[self._pair(observation, action)]
        return ChoiceExplanation(self.act(observation, legal), "exploited", criterion, scores)

    def learn(self, transition: Transition) -> None:
        """Add the transition to the evidence."""
        self._first_values = self._plan.state_values
        pair = self._pair(transition.observation, transition.action)
        self._tries[pair] += 1
        self._reward_sums_m[pair] += transition.reward_m
        followed = int(self._layout.movers[pair]), self._layout.index(transition.next_observation)
        self._next[followed] = self._next.get(followed, 0) + 1
        self._planned = None

    def explain_update(self, transition: Transition) -> UpdateExplanation:
        """Learn as `learn` does, and explain how the expected rewards change, level by level.

        The rule is the value of the step in the plan after it.
        """
        pair, old = self._pair(transition.observation, transition.action), self._plan
        self.learn(transition)
        new = self._plan
        members = self._layout.members(pair)
        beliefs = [
            Belief(
                f"reward by {before.name}",
                float(before.mean[member]),
                float(after.mean[member]),
                "m",
                float(before.deviation[member]),
                float(after.deviation[member]),
            )
            for before, after, member in zip(old.levels, new.levels, members, strict=True)
        ]
        expected = float(old.levels[-1].mean[pair])
        error = transition.reward_m - expected
        compared = "more" if error > 0 else "less"
        summary = (
            f"It expected {in_millimetres(expected)} and got "
            f"{in_millimetres(transition.reward_m)}: {in_millimetres(abs(error))} {compared}. It "
            f"now expects {compared} of this step, and of steps that land alike."
        )
        update = ValueUpdate(
            transition.observation,
            transition.action,
            *self._rule(pair),
            float(old.values[pair]),
            float(new.values[pair]),
        )
        return UpdateExplanation(summary, update, (), beliefs)

    def _rule(self, pair: int) -> tuple[str, tuple[Term, ...]]:
        """Return the rule of a pair's value in the present plan, with its terms."""
        expected, later = self._plan.levels[-1], self._plan.later
        reward = Term("r̂", float(expected.mean[pair]), "expected reward [m]")
        follows = (
            Term("γ", self._gamma, "discount"),
            Term("V′", float(later[pair]), "expected value of what follows, by its plan [m]"),
        )
        if not self._beta:
            return "r̂ + γ · V′", (reward, *follows)
        hope = (
            Term("β", self._beta, "optimism"),
            Term("σ", float(expected.deviation[pair]), "its standard deviation [m]"),
        )
        return "r̂ + β · σ + γ · V′", (reward, *hope, *follows)

    @property
    def _beta(self) -> float:
        return self._optimism if self._explore else 0.0

    @property
    def _plan(self) -> _Plan:
        if self._planned is None:
            self._planned = self._value_iteration()
        return self._planned

    def _value_iteration(self) -> _Plan:
        layout, gamma = self._layout, self._gamma
        levels = self._regression.levels(self._tries, self._reward_sums_m)
        rewards = levels[-1].mean
        if self._beta:
            rewards = rewards + self._beta * levels[-1].deviation
        rewards = np.where(layout.is_legal, rewards, -np.inf)
        movers = layout.states * layout.groups
        at, after, counts = self._outcomes().T
        total = _LAW_TRIES + np.bincount(at, counts, movers)
        states = self._first_values
        for _ in range(_MAX_SWEEPS):
            # `bincount` adds in order, so that the last bits are the same on all machines.
            seen = np.bincount(at, counts * states[after], movers)
            later = ((_LAW_TRIES * states[self._law_next] + seen) / total)[layout.movers]
            values = rewards + gamma * later
            before, states = states, values.reshape(layout.states, -1).max(1)
            if np.abs(states - before).max() <= self._tolerance_m:
                break
        return _Plan(levels, later, values, states)

    def _outcomes(self) -> IntArray:
        """Return landing with mover, next state and count of each outcome, (outcomes, 3)."""
        rows = [(*followed, count) for followed, count in self._next.items()]
        # NumPy indexes and counts by its index type alone, which has 32 bits on some machines.
        return np.array(rows, np.intp).reshape(-1, 3)

    def _pair(self, observation: Cells, action: Action) -> int:
        """Return the index of a pair."""
        layout = self._layout
        return (
            layout.index(observation) * layout.groups + action.group
        ) * layout.cells + action.cell

    def tune(self, *, optimism: Optimism | None = None, gamma: Gamma | None = None) -> None:
        """Change optimism and discount from the next step on."""
        tuned = (optimism, gamma)
        self._tuned = np.array(
            [old if new is None else new for old, new in zip(self._tuned, tuned, strict=True)]
        )
        self._apply_tuned()

    def _apply_tuned(self) -> None:
        optimism, gamma = self._tuned.tolist()
        if not np.isnan(optimism):
            self._optimism = optimism
        if not np.isnan(gamma):
            self._gamma = gamma
        self._planned = None

    def values(self, observation: Cells) -> FloatArray:
        """Return the values of the plan in a state [m], (groups, cells), NaN where illegal."""
        return self._of_state(self._plan.values, observation)

    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts of the actions in a state, (groups, cells), NaN where illegal."""
        return self._of_state(self._tries, observation)

    def _of_state(self, of_pairs: NDArray[Any], observation: Cells) -> FloatArray:
        layout = self._layout
        rows = of_pairs.reshape(layout.states, layout.groups, layout.cells)
        row: FloatArray = rows[layout.index(observation)].astype(float)
        row[range(layout.groups), observation] = np.nan
        return row

    def state(self) -> AgentState:
        """Return the evidence, the first values of the next plan, and tuned settings."""
        return {
            "shape": np.array([self._layout.groups, self._layout.cells], np.int64),
            "tries": self._tries.copy(),
            "reward_sums": self._reward_sums_m.copy(),
            "outcomes": self._outcomes(),
            "first_values": self._first_values.copy(),
            "tuned": self._tuned.copy(),
        }

    def continue_from(self, state: AgentState) -> None:
        """Load a saved state without its tuned settings.

        Raises:
            ValueError: if the state is of another number of groups or cells.
        """
        self.load({**state, "tuned": np.full(2, np.nan)})

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned.

        Raises:
            ValueError: if the state is of another number of groups or cells.
        """
        shape = [self._layout.groups, self._layout.cells]
        if state["shape"].tolist() != shape:
            raise ValueError(f"its groups and cells are {state['shape'].tolist()}, not {shape}")
        self._tries, self._reward_sums_m = state["tries"].copy(), state["reward_sums"].copy()
        self._next = {(at, after): count for at, after, count in state["outcomes"].tolist()}
        self._first_values = state["first_values"].copy()
        self._tuned = state["tuned"].copy()
        self._apply_tuned()

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check the arrays of a saved state: tuned settings, evidence, outcomes and values.

        Raises:
            InvalidInput: for an optimism or a discount out of its limits.
            KeyError, TypeError, ValueError: if `state` is not a state of this agent.
        """
        optimism, gamma = state["tuned"].tolist()
        for name, kind, value in (("optimism", Optimism, optimism), ("gamma", Gamma, gamma)):
            if not np.isnan(value):
                declare(name, kind).check(value)
        groups, cells = state["shape"].tolist()
        tries, sums, outcomes, values = (
            state[name] for name in ("tries", "reward_sums", "outcomes", "first_values")
        )
        kinds = state["shape"].dtype.kind + tries.dtype.kind + outcomes.dtype.kind
        if kinds != "iii" or sums.dtype.kind + values.dtype.kind != "ff":
            raise ValueError("its evidence has numbers of another kind")
        if not 1 <= groups * cells <= len(tries) or groups > np.log2(MAX_PAIRS):
            raise ValueError("its shape is that of no table")
        states = cells**groups
        pairs = table_size(groups, cells)
        if pairs > MAX_PAIRS or tries.shape != (pairs,) or sums.shape != (pairs,):
            raise ValueError("its evidence is not of its state-action pairs")
        if values.shape != (states,) or outcomes.ndim != 2 or outcomes.shape[1] != 3:
            raise ValueError("its values or outcomes are not of its states")
        if not (np.isfinite(sums).all() and np.isfinite(values).all()) or (tries < 0).any():
            raise ValueError("its evidence has numbers that are not possible")
        at, after, counts = outcomes.T
        in_range = (at >= 0) & (at < states * groups) & (after >= 0) & (after < states)
        if not in_range.all() or len(np.unique(outcomes[:, :2], axis=0)) < len(outcomes):
            raise ValueError("its outcomes are of states that do not exist, or there twice")
        if (counts < 1).any() or int(counts.sum()) != int(tries.sum()):
            raise ValueError("its outcomes are not as many as its tries")

    @staticmethod
    def check_problem(problem: Problem, **settings: Any) -> None:  # noqa: ARG004  # whatever they are
        """Check that a plan for the problem is quick enough.

        Raises:
            InvalidInput: if it has more than `MAX_PAIRS` state-action pairs.
        """
        groups, cells = len(problem.groups), len(problem.cells_m)
        if (pairs := table_size(groups, cells)) > MAX_PAIRS:
            raise InvalidInput(
                f"multilevel-model plans for at most {MAX_PAIRS:,} state-action pairs, and "
                f"{groups} groups of legs on {cells} cells have {pairs:,}: choose fewer "
                "divisions, larger groups, or linear-model, which has no plan"
            )
