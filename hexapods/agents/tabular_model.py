"""Tabular model of the world: rewards and next states of the state-action pairs that were tried."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.protocol import AgentState, Problem
from hexapods.agents.q_table import check_entries, table_size
from hexapods.domain.errors import InvalidInput

MAX_MODEL_VALUES = 300_000
"""Maximum of state-action pairs; six legs at four divisions have 250,563. Each takes about 1 kB."""


@dataclass(slots=True)
class TriedPair:
    """Outcomes of a state-action pair.

    Attributes:
        state, column: row and column of the Q-table.
        tries: how often it was tried; 0 for a pair that is only imagined.
        reward_sum_m: sum of its rewards [m].
        last_reward_m, last_next, last_step: the newest try: reward [m], index of the next state,
            and number of steps that were learned before it.
        outcomes: how often each state came next, by its index.
    """

    state: int
    column: int
    last_next: int
    tries: int = 0
    reward_sum_m: float = 0.0
    last_reward_m: float = 0.0
    last_step: int = 0
    outcomes: dict[int, int] = field(default_factory=dict)

    @property
    def mean_reward_m(self) -> float:
        """Mean of its rewards [m]; 0 for a pair that was never tried."""
        return self.reward_sum_m / max(1, self.tries)


class TabularModel:
    """Rewards and next states of the pairs that were tried, in the order of their first try.

    Sparse: only those pairs take memory.

    Attributes:
        steps: number of steps it learned from.
        pairs: rewards and next states of each pair.
    """

    def __init__(self) -> None:
        self.steps = 0
        self.pairs: list[TriedPair] = []
        self._numbers: dict[tuple[int, int], int] = {}
        self._leading_to: dict[int, dict[int, None]] = {}

    def number(self, state: int, column: int) -> int | None:
        """Return the number of a pair; None if it was never tried."""
        return self._numbers.get((state, column))

    def pair(self, state: int, column: int) -> TriedPair:
        """Return a pair that was tried or imagined.

        Raises:
            KeyError: if it was neither.
        """
        return self.pairs[self._numbers[state, column]]

    def leading_to(self, state: int) -> Iterator[int]:
        """Iterate over the numbers of the pairs that a state has followed, in no fixed order."""
        return iter(self._leading_to.get(state, ()))

    def imagine(self, state: int, column: int) -> None:
        """Add an untried pair without reward that stays in its state, unless the pair is there."""
        if (state, column) not in self._numbers:
            self._add(TriedPair(state, column, last_next=state))

    def learn(self, state: int, column: int, reward_m: float, next_state: int) -> int:
        """Add a transition; return the number of its pair."""
        number = self.number(state, column)
        if number is None:
            number = self._add(TriedPair(state, column, last_next=next_state))
        pair = self.pairs[number]
        pair.tries += 1
        pair.reward_sum_m += reward_m
        pair.last_reward_m, pair.last_next, pair.last_step = reward_m, next_state, self.steps
        pair.outcomes[next_state] = pair.outcomes.get(next_state, 0) + 1
        self._leading_to.setdefault(next_state, {})[number] = None
        self.steps += 1
        return number

    def _add(self, pair: TriedPair) -> int:
        number = self._numbers[pair.state, pair.column] = len(self.pairs)
        self.pairs.append(pair)
        return number

    def dump(self) -> AgentState:
        """Return the model as arrays, with a row for each pair and for each outcome."""
        counts = [(p.state, p.column, p.tries, p.last_next, p.last_step) for p in self.pairs]
        rewards = [(p.reward_sum_m, p.last_reward_m) for p in self.pairs]
        outcomes = [
            (number, next_state, count)
            for number, pair in enumerate(self.pairs)
            for next_state, count in pair.outcomes.items()
        ]
        return {
            "model_steps": np.array([self.steps], np.int64),
            "model_pairs": np.array(counts, np.int64).reshape(-1, 5),
            "model_rewards": np.array(rewards).reshape(-1, 2),
            "model_outcomes": np.array(outcomes, np.int64).reshape(-1, 3),
        }

    def load(self, state: AgentState) -> None:
        """Replace the model by the output of `dump`."""
        (self.steps,) = state["model_steps"].tolist()
        self.pairs, self._numbers, self._leading_to = [], {}, {}
        rows = zip(state["model_pairs"].tolist(), state["model_rewards"].tolist(), strict=True)
        for (row, column, tries, last_next, last_step), (total_m, last_m) in rows:
            self._add(TriedPair(row, column, last_next, tries, total_m, last_m, last_step))
        for number, next_state, count in state["model_outcomes"].tolist():
            self.pairs[number].outcomes[next_state] = count
            self._leading_to.setdefault(next_state, {})[number] = None

    @staticmethod
    def check(state: AgentState) -> None:
        """Check that a state has a valid output of `dump` for the shape of its table.

        Raises:
            KeyError, TypeError, ValueError: if it does not.
        """
        names = ("model_steps", "model_pairs", "model_rewards", "model_outcomes")
        steps, pairs, rewards, outcomes = (state[name] for name in names)
        count = len(pairs)
        kinds = steps.dtype.kind + pairs.dtype.kind + outcomes.dtype.kind
        if kinds != "iii" or steps.shape != (1,) or steps[0] < 0:
            raise ValueError("its model is not of whole numbers")
        if rewards.shape != (count, 2) or not np.isfinite(rewards).all():
            raise ValueError("its model has rewards that are not finite numbers")
        check_entries(pairs[:, :2], count, state["shape"])
        if len(np.unique(pairs[:, :2], axis=0)) < count or len(
            np.unique(outcomes[:, :2], axis=0)
        ) < len(outcomes):
            raise ValueError("its model has duplicate entries")
        groups, cells = state["shape"].tolist()
        tries, last_nexts, last_steps = pairs[:, 2:].T
        if (tries < 0).any() or (last_steps < 0).any() or (last_steps > steps[0]).any():
            raise ValueError("its model has negative counts, or steps beyond its total")
        numbers, next_states, counts = outcomes.T
        _check_below(numbers, count)
        _check_below(np.concatenate([last_nexts, next_states]), cells**groups)
        if (counts < 1).any() or (
            np.bincount(numbers.astype(np.intp), counts, count) != tries
        ).any():
            raise ValueError("its model has tries that differ from its outcomes")


def check_problem(problem: Problem, **settings: Any) -> None:  # noqa: ARG001  # of any learner
    """Check that a model of a problem would fit into memory.

    Raises:
        InvalidInput: if it would not.
    """
    groups, cells = len(problem.groups), len(problem.cells_m)
    values = table_size(groups, cells)
    if values > MAX_MODEL_VALUES:
        raise InvalidInput(
            f"a learner with a model of the world takes at most {MAX_MODEL_VALUES:,} state-action "
            f"pairs, and {groups} groups of legs on {cells} cells have {values:,}: choose fewer "
            "divisions or a learner without a model, such as q-learning"
        )


def _check_below(numbers: NDArray[np.int64], limit: int) -> None:
    if (numbers < 0).any() or (numbers >= limit).any():
        raise ValueError("its model has steps to states that do not exist")
