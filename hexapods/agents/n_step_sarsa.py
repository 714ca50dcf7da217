"""Tabular n-step Sarsa (Sutton and Barto, 2nd edition, §7.2)."""

from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Le

from hexapods.agents.protocol import AgentState, Transition
from hexapods.agents.q_table import check_entries
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.settings import Setting

MAX_RETURN_STEPS = 100
ReturnSteps = Annotated[
    int,
    Ge(1),
    Le(MAX_RETURN_STEPS),
    Setting(
        title="Steps of the return",
        symbol="n",
        help="How many rewards are added up before a step is judged; 1 is plain Sarsa.",
        examples=(1, 2, 4),
    ),
]


class NStepSarsa(TabularLearner):
    """On-policy learner whose target is the sum of n rewards and the value after them.

    An action value is updated n − 1 steps late, when its n rewards are known.

    Args:
        return_steps: n.
        settings: as for `TabularLearner`.
    """

    title = "n-step Sarsa"
    description = "Sarsa that waits for a few rewards in a row before it judges a step."
    color = "#44AA99"
    is_on_policy = True

    def __init__(self, *args: Any, return_steps: ReturnSteps = 2, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._return_steps = return_steps
        self._waiting: list[tuple[int, int, float]] = []
        """State, column and reward [m] of the steps without an update yet, the newest last."""

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Q(s, a) ← (1 − α) Q(s, a) + α (Σ γᵏ r + γⁿ Q(s′, a′)), for the pair n − 1 steps ago."""
        self._waiting.append((state, column, transition.reward_m))
        if len(self._waiting) < self._return_steps:
            return
        rewards = [reward for *_, reward in self._waiting]
        target = self._chosen_next(transition)
        for reward in reversed(rewards):
            target = self._return_m(reward, target)
        first_state, first_column, _ = self._waiting.pop(0)
        self._move_towards(first_state, first_column, target)

    def state(self) -> AgentState:
        """Return the state of `TabularLearner`, and the steps without an update yet."""
        places = [(state, column) for state, column, _ in self._waiting]
        rewards = [reward for *_, reward in self._waiting]
        arrays = {"places": np.array(places, np.int64).reshape(-1, 2), "rewards": np.array(rewards)}
        return super().state() | arrays

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        super().load(state)
        rewards = state["rewards"].tolist()
        pairs = zip(state["places"].tolist(), rewards, strict=True)
        self._waiting = [(row, column, reward) for (row, column), reward in pairs]

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `TabularLearner` does, and the steps without an update yet."""
        TabularLearner.check_state(state)
        rewards = state["rewards"]
        if rewards.ndim != 1 or rewards.dtype.kind != "f" or not np.isfinite(rewards).all():
            raise ValueError("its rewards are no list of numbers")
        if len(rewards) >= MAX_RETURN_STEPS:
            raise ValueError("it has more steps to judge than there can be")
        check_entries(state["places"], len(rewards), state["shape"])
