"""Base classes: agents that act greedily in a Q-table, and learners with an ε-greedy policy."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Gt, Le, Lt

from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.agents.q_table import QTable, check_size
from hexapods.agents.value_table import ValueTable
from hexapods.domain.settings import Setting, declare
from hexapods.domain.types import Action, Cells, FloatArray

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
Objective = Annotated[
    Literal["discounted", "average"],
    Setting(
        title="Objective",
        help="What a value adds up: all later rewards, discounted by γ; or what they are above the "
        "average, since walking never ends.",
    ),
]
AverageRate = Annotated[
    float,
    Gt(0),
    Le(1),
    Setting(
        title="Rate of the average",
        symbol="η",
        help="How fast the average reward is learned, as a share of the learning rate; used by the "
        "objective average alone.",
        examples=(0.1, 0.3),
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
        title="Initial exploration",
        symbol="ε",
        quantity="exploration",
        phrase="ε\u00a0from\u00a0{}",
        help="Share of random steps at the beginning of practice.",
        examples=(0.5, 1),
    ),
]
EpsilonEnd = Annotated[
    Share,
    Setting(
        title="Final exploration",
        symbol="ε",
        quantity="exploration",
        phrase="ε\u00a0to\u00a0{}",
        help="Share of random steps at the end of practice.",
        examples=(0, 0.1),
    ),
]


@dataclass(frozen=True)
class EpsilonSchedule:
    """Linear decay of ε over the episodes: start + (end − start) · e / max(1, n − 1)."""

    start: float = 1.0
    end: float = 0.0
    episodes: int = 1

    def __call__(self, episode: int) -> float:
        """Return the ε of an episode, counted from 0; constant after the last episode."""
        last = self.episodes - 1
        return self.start + (self.end - self.start) * min(episode, last) / max(1, last)


class TabularAgent(ABC):
    """Learner whose greedy actions follow from a Q-table; ties are broken at random.

    A subclass implements `learn`, `state` and `load`.

    Args:
        rng: random generator, the only source of chance.
        problem: determines the size of the table.
        explore: if False, the policy is greedy in the table.
    """

    needs_practice = True

    table: ValueTable

    def __init__(self, rng: np.random.Generator, problem: Problem, *, explore: bool = True) -> None:
        self.table = self._new_table(len(problem.groups), len(problem.cells_m))
        self._rng, self._explore = rng, explore

    @staticmethod
    def _new_table(groups: int, cells: int) -> ValueTable:
        """Return an empty table of the kind that this agent keeps."""
        return QTable(groups, cells)

    @staticmethod
    def check_problem(problem: Problem, **_settings: Any) -> None:
        """Check that the table of a problem would fit into memory.

        Raises:
            InvalidInput: if it would not; the message names the number of states.
        """
        check_size(len(problem.groups), len(problem.cells_m))

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the action with the highest value in the table."""
        return self._highest(legal, self.table.values_of(observation, legal))

    def _highest(self, legal: Sequence[Action], values: Sequence[float]) -> Action:
        """Return the action with the highest of some values; ties are broken at random."""
        highest = max(values)
        best = [action for action, value in zip(legal, values, strict=True) if value == highest]
        return best[0] if len(best) == 1 else self._any(best)

    def _any(self, actions: Sequence[Action]) -> Action:
        """Draw one of these actions, each with the same probability."""
        return actions[int(self._rng.integers(len(actions)))]

    @abstractmethod
    def learn(self, transition: Transition) -> None:
        """Learn from the transition of the last action."""

    def values(self, observation: Cells) -> FloatArray:
        """Return the action values in this state, (groups, cells), NaN where illegal."""
        return self.table.values(observation)

    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts in this state, (groups, cells), NaN where illegal."""
        return self.table.visits(observation)

    @abstractmethod
    def state(self) -> AgentState:
        """Return the complete state; `where`, `q`, `n` and `shape` are those of the table."""

    @abstractmethod
    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""

    def share_table(self, other: "TabularAgent") -> None:
        """Share the table of another learner, without a copy; for evaluation only."""
        self.table = other.table

    def continue_from(self, state: AgentState) -> None:
        """Load the learned values; the rates are those of this run, and the ε schedule restarts."""
        self._load_learned(state)

    def _load_learned(self, state: AgentState) -> None:
        """Load values and visits, in subclasses also the model or average reward; no settings."""
        self.table.load(state)


class TabularLearner(TabularAgent):
    """Learner of action values in a Q-table, with an ε-greedy policy.

    A subclass implements the value of the next state, `_next_value`, or another update rule,
    `_update`, and may add settings.

    Args:
        rng: random generator for exploration and for breaking ties.
        problem: determines the size of the table.
        explore: if False, the policy is greedy in the table (ε = 0).
        alpha: learning rate α.
        gamma: discount factor γ; not used by the objective `average`.
        objective: `discounted`: a value is a sum of discounted rewards. `average`: a value is the
            sum of the rewards' differences from the average reward (differential Q-learning and
            Sarsa: Wan, Naik and Sutton 2021; Sutton and Barto, 2nd edition, §10.3).
        average_rate: η; the average reward moves by η · α times each error.
        epsilon_start, epsilon_end: ε of the first and the last episode.
        steps: planned number of steps, which gives the number of episodes.
        steps_per_episode: number of steps for which ε is constant.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        problem: Problem,
        *,
        explore: bool = True,
        alpha: Alpha = 0.3,
        gamma: Gamma = 0.9,
        objective: Objective = "discounted",
        average_rate: AverageRate = 0.3,
        epsilon_start: EpsilonStart = 1.0,
        epsilon_end: EpsilonEnd = 0.0,
        steps: int = 500,
        steps_per_episode: int = 50,
    ) -> None:
        super().__init__(rng, problem, explore=explore)
        self._alpha, self._gamma = alpha, gamma
        self._is_average, self._average_rate = objective == "average", average_rate
        self._average_m = 0.0
        """Average reward of a step, as learned so far [m]; used by the objective `average`."""
        self._schedule = EpsilonSchedule(epsilon_start, epsilon_end, -(-steps // steps_per_episode))
        self._steps_per_episode = steps_per_episode
        self._learned = 0
        self._fixed_epsilon: float | None = None

    next_meaning = "value of the next state"
    """Meaning of `_next_value`, for explanations."""

    @property
    def epsilon(self) -> float:
        """The probability of a random action at the next step."""
        if not self._explore:
            return 0.0
        if self._fixed_epsilon is not None:
            return self._fixed_epsilon
        return self._schedule(self._learned // self._steps_per_episode)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return an ε-greedy action; ties are broken at random."""
        epsilon = self.epsilon
        if epsilon > 0 and self._rng.random() < epsilon:
            return self._any(legal)
        return super().act(observation, legal)

    def learn(self, transition: Transition) -> None:
        """Update the table, and the visit count of the state and action."""
        table = self.table
        state, column = table.index(transition.observation), table.column(transition.action)
        self._update(transition, state, column)
        table.count_visit(state, column)
        self._learned += 1

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Apply the update rule for a transition from row `state` by the action in `column`.

        Q(s, a) ← (1 − α) Q(s, a) + α (r + γ Q′), Q′ being the value of the next state (paper,
        Algorithm 1).
        """
        self._move_towards(state, column, self._target(transition))

    def _target(self, transition: Transition) -> float:
        return self._return_m(transition.reward_m, self._next_value(transition))

    def _return_m(self, reward_m: float, later: float, tries: int = 1) -> float:
        """Return a reward plus the mean value of the next states, by the objective [m].

        Args:
            reward_m: the reward [m].
            later: sum of the values of the next states of some tries [m].
            tries: number of these.
        """
        if self._is_average:
            return reward_m - self._average_m + later / tries
        return reward_m + self._gamma * later / tries

    def _learn_average(self, error: float) -> None:
        """R̄ ← R̄ + η α δ, for the error δ of a value, if the objective is `average`."""
        if self._is_average:
            self._average_m += self._average_rate * self._alpha * error

    def _next_value(self, transition: Transition) -> float:
        """Return the value of the next state, by the rule of this learner. No state is terminal."""
        raise NotImplementedError

    def _move_towards(self, state: int, column: int, target: float) -> None:
        """Q(s, a) ← (1 − α) Q(s, a) + α target."""
        before = self.table.value(state, column)
        self.table.set_value(state, column, (1 - self._alpha) * before + self._alpha * target)
        self._learn_average(target - before)

    def _best_next(self, transition: Transition) -> float:
        """Return max Q(s′, ·)."""
        return max(self.table.values_of(transition.next_observation, transition.next_legal))

    def _chosen_next(self, transition: Transition) -> float:
        """Return Q(s′, a′) of the next action that an on-policy learner has chosen."""
        assert transition.next_action is not None  # noqa: S101 - is_on_policy
        return self.table.values_of(transition.next_observation, [transition.next_action])[0]

    def tune(
        self,
        *,
        alpha: Alpha | None = None,
        gamma: Gamma | None = None,
        epsilon: Epsilon | None = None,
    ) -> None:
        """Change rates from the next step on; an epsilon replaces the schedule."""
        self._alpha = self._alpha if alpha is None else alpha
        self._gamma = self._gamma if gamma is None else gamma
        self._fixed_epsilon = self._fixed_epsilon if epsilon is None else epsilon

    def _load_learned(self, state: AgentState) -> None:
        super()._load_learned(state)
        # Missing in a table of the objective `discounted`.
        (self._average_m,) = state.get("average", np.zeros(1)).tolist()

    def state(self) -> AgentState:
        """Return values, visits, rates and the position in the ε schedule."""
        fixed = np.nan if self._fixed_epsilon is None else self._fixed_epsilon
        progress = np.array([self._learned], np.int64)
        rates = np.array([self._alpha, self._gamma, fixed])
        average = {"average": np.array([self._average_m])} if self._is_average else {}
        return {**self.table.dump(), "learned": progress, "rates": rates, **average}

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        self._load_learned(state)
        self._learned = int(state["learned"][0])
        self._alpha, self._gamma, fixed = state["rates"].tolist()
        self._fixed_epsilon = None if np.isnan(fixed) else fixed

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check the rates, average reward and step count of a saved state; not the table.

        Raises:
            InvalidInput: for a rate out of its limits.
            KeyError, TypeError, ValueError: if `state` is not a state of this agent.
        """
        alpha, gamma, epsilon = state["rates"].tolist()
        declare("alpha", Alpha).check(alpha)
        declare("gamma", Gamma).check(gamma)
        # Missing with the objective `discounted`.
        (average,) = state.get("average", np.zeros(1)).tolist()
        if not isinstance(average, float) or not np.isfinite(average):
            raise ValueError("its average reward is no finite number")
        # NaN while the schedule is in use.
        if not np.isnan(epsilon):
            declare("epsilon", Epsilon).check(epsilon)
        (learned,) = state["learned"].tolist()
        if not isinstance(learned, int) or learned < 0:
            raise ValueError("its step count is negative or not whole")
