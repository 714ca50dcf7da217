"""What learners with a Q-table and an ε-greedy policy have in common."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le, Lt

from app.agents.protocol import AgentState, Problem, Transition
from app.agents.q_table import QTable
from app.domain.settings import Setting, declare
from app.domain.types import Action, Cells, FloatArray

Share = Annotated[float, Ge(0), Le(1)]
Alpha = Annotated[
    float,
    Gt(0),
    Le(1),
    Setting(
        title="Learning rate",
        symbol="α",
        help="How much one experience counts against all before.",
        live=True,
        examples=(0.1, 0.3, 0.6),
    ),
]
Gamma = Annotated[
    float,
    Ge(0),
    Lt(1),
    Setting(
        title="Discount",
        symbol="γ",
        help="How much the steps to come count against the next one.",
        live=True,
        examples=(0.5, 0.9),
    ),
]
Epsilon = Annotated[
    Share,
    Setting(
        title="Exploration now",
        symbol="ε",
        help="Share of random steps from now on, in place of the falling schedule.",
        live=True,
    ),
]
EpsilonStart = Annotated[
    Share,
    Setting(
        title="Exploration, first episode",
        symbol="ε",
        phrase="ε\u00a0from\u00a0{}",
        help="Share of random steps at the beginning of practice.",
        examples=(0.5, 1),
    ),
]
EpsilonEnd = Annotated[
    Share,
    Setting(
        title="Exploration, last episode",
        symbol="ε",
        phrase="ε\u00a0to\u00a0{}",
        help="Share of random steps at the end of practice.",
        examples=(0, 0.1),
    ),
]


@dataclass(frozen=True)
class EpsilonSchedule:
    """ε falls linearly over the episodes: start + (end − start) · e / max(1, n − 1)."""

    start: float = 1.0
    end: float = 0.0
    episodes: int = 1

    def __call__(self, episode: int) -> float:
        """The ε of an episode, counted from 0; episodes past the last keep its ε."""
        last = self.episodes - 1
        return self.start + (self.end - self.start) * min(episode, last) / max(1, last)


class TabularLearner(ABC):
    """Learns the value of each action in each state from nothing but what it sees.

    A learner adds its update rule, `_update`, and its settings.

    Args:
        rng: decides when to explore, where to, and between equals.
        problem: sizes the table.
        explore: if False the policy is greedy in the table, whatever the schedule says.
        alpha: learning rate.
        gamma: discount.
        epsilon_start, epsilon_end: of the schedule over the episodes.
        steps: how many steps it will learn, which gives the number of episodes.
        steps_per_episode: ε stays the same so long.
    """

    needs_practice = True

    def __init__(
        self,
        rng: np.random.Generator,
        problem: Problem,
        *,
        explore: bool = True,
        alpha: Alpha = 0.3,
        gamma: Gamma = 0.9,
        epsilon_start: EpsilonStart = 1.0,
        epsilon_end: EpsilonEnd = 0.0,
        steps: int = 500,
        steps_per_episode: int = 50,
    ) -> None:
        self.table = QTable(len(problem.pairs), len(problem.cells_m))
        self._rng, self._explore = rng, explore
        self._alpha, self._gamma = alpha, gamma
        self._schedule = EpsilonSchedule(epsilon_start, epsilon_end, -(-steps // steps_per_episode))
        self._steps_per_episode = steps_per_episode
        self._learned = 0
        self._fixed_epsilon: float | None = None

    @property
    def epsilon(self) -> float:
        """The probability of a random action at the next step."""
        if not self._explore:
            return 0.0
        if self._fixed_epsilon is not None:
            return self._fixed_epsilon
        return self._schedule(self._learned // self._steps_per_episode)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """ε-greedy; ties are broken at random."""
        epsilon = self.epsilon
        if epsilon > 0 and self._rng.random() < epsilon:
            return legal[int(self._rng.integers(len(legal)))]
        values = self.table.values_of(observation, legal)
        highest = max(values)
        best = [action for action, value in zip(legal, values, strict=True) if value == highest]
        return best[0] if len(best) == 1 else best[int(self._rng.integers(len(best)))]

    def learn(self, transition: Transition) -> None:
        """Update the table, and count the visit of the state and action."""
        table = self.table
        state, column = table.index(transition.observation), table.column(transition.action)
        self._update(transition, state, column)
        table.row(state)[1][column] += 1
        self._learned += 1

    @abstractmethod
    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Update the values of the table, where the step began in `state` by action `column`."""

    def tune(
        self,
        *,
        alpha: Alpha | None = None,
        gamma: Gamma | None = None,
        epsilon: Epsilon | None = None,
    ) -> None:
        """Change rates from the next step on; a given epsilon replaces the schedule."""
        self._alpha = self._alpha if alpha is None else alpha
        self._gamma = self._gamma if gamma is None else gamma
        self._fixed_epsilon = self._fixed_epsilon if epsilon is None else epsilon

    def values(self, observation: Cells) -> FloatArray:
        """(pairs, cells) values of the actions in this state, NaN where illegal."""
        return self.table.values(observation)

    def visits(self, observation: Cells) -> FloatArray:
        """(pairs, cells) visits of the actions in this state, NaN where illegal."""
        return self.table.visits(observation)

    def state(self) -> AgentState:
        """Values, visits, rates and the place in the schedule."""
        fixed = np.nan if self._fixed_epsilon is None else self._fixed_epsilon
        progress = np.array([self._learned], np.int64)
        rates = np.array([self._alpha, self._gamma, fixed])
        return {**self.table.dump(), "learned": progress, "rates": rates}

    def load(self, state: AgentState) -> None:
        """Go on exactly where `state` was taken; the generator is the caller's."""
        self.table.load(state)
        self._learned = int(state["learned"][0])
        self._alpha, self._gamma, fixed = state["rates"].tolist()
        self._fixed_epsilon = None if np.isnan(fixed) else fixed

    def share_table(self, other: "TabularLearner") -> None:
        """Use the table that another learner writes; for a policy that learns nothing."""
        self.table = other.table

    def continue_from(self, state: AgentState) -> None:
        """Take over values and visits only: the rates are the new run's, ε restarts."""
        self.table.load(state)

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check what `load` relies on beyond the table.

        Raises:
            InvalidInput: for a rate out of its limits.
            KeyError, TypeError, ValueError: if `state` is none of this agent.
        """
        alpha, gamma, epsilon = state["rates"].tolist()
        declare("alpha", Alpha).check(alpha)
        declare("gamma", Gamma).check(gamma)
        # NaN as long as the schedule is in force.
        if not np.isnan(epsilon):
            declare("epsilon", Epsilon).check(epsilon)
        if state["learned"].dtype.kind != "i" or state["learned"][0] < 0:
            raise ValueError("it has learned for less than no step")
