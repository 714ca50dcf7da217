"""Prioritized sweeping (Moore and Atkeson 1993; Sutton and Barto, 2nd edition, §8.4)."""

from heapq import heapify, heappop, heappush
from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Le

from hexapods.agents.planning import PlanningLearner
from hexapods.agents.protocol import AgentState, Transition
from hexapods.agents.tabular import Alpha
from hexapods.agents.tabular_model import TriedPair
from hexapods.domain.settings import Setting
from hexapods.domain.sums import ordered_sum

Threshold = Annotated[
    float,
    Ge(0),
    Le(0.1),
    Setting(
        title="Smallest change",
        symbol="θ",
        unit="m",
        help="Values that would change by less are not worked on.",
        examples=(0.00001, 0.0001, 0.001),
    ),
]


class PrioritizedSweeping(PlanningLearner):
    """Learner that plans first for the pair whose value would change the most.

    A change is propagated backwards to the pairs that lead to it. Updates are expectations over all
    outcomes of a pair, so the world may be stochastic.

    Args:
        alpha: share of a planned change that is made; 1 as in the sources.
        threshold_m: θ [m].
        settings: as for `PlanningLearner`.
    """

    title = "Prioritized sweeping"
    description = "Remembers what followed each step; a surprise is passed on to the steps before."
    color = "#CC6677"

    def __init__(
        self, *args: Any, alpha: Alpha = 1.0, threshold_m: Threshold = 0.00001, **settings: Any
    ) -> None:
        super().__init__(*args, alpha=alpha, **settings)
        self._threshold_m = threshold_m
        self._priorities: dict[int, float] = {}
        """Change of value [m] that is due, by the number of the pair."""
        self._heap: list[tuple[float, int]] = []
        """The same as (−priority, number), with entries that are out of date."""

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Add the step to the model, and make the n largest changes of values that are due."""
        after = self.table.index(transition.next_observation)
        self._enqueue(self._model.learn(state, column, transition.reward_m, after))
        for _ in range(self._planning_steps):
            if not self._priorities:
                break
            self._sweep(self._model.pairs[self._dequeue()])
        if len(self._heap) > 2 * len(self._priorities) + 1000:
            self._rebuild_heap()

    def _sweep(self, pair: TriedPair) -> None:
        """Q ← (1 − α) Q + α (r̄ + γ Σ p max Q(s′, ·)); then queue the pairs that led to its s."""
        before = self.table.best(pair.state)
        self._move_towards(pair.state, pair.column, self._planned_target(pair))
        if self.table.best(pair.state) != before:
            for number in self._model.leading_to(pair.state):
                self._enqueue(number)

    def _planned_target(self, pair: TriedPair) -> float:
        return self._return_m(pair.mean_reward_m, self._later(pair), pair.tries)

    def _later(self, pair: TriedPair) -> float:
        """Return the sum of the highest values in all states that followed a pair."""
        best = self.table.best
        return ordered_sum(count * best(state) for state, count in pair.outcomes.items())

    def _enqueue(self, number: int) -> None:
        """Set the priority of a pair; it leaves the queue if its value would hardly change."""
        pair = self._model.pairs[number]
        value = self.table.value(pair.state, pair.column)
        priority = abs(self._planned_target(pair) - value)
        if priority > self._threshold_m:
            self._priorities[number] = priority
            heappush(self._heap, (-priority, number))
        else:
            self._priorities.pop(number, None)

    def _dequeue(self) -> int:
        """Remove the pair with the highest priority; ties go to the one that was tried first."""
        while True:
            priority, number = heappop(self._heap)
            if self._priorities.get(number) == -priority:
                del self._priorities[number]
                return number

    def _rebuild_heap(self) -> None:
        self._heap = [(-priority, number) for number, priority in self._priorities.items()]
        heapify(self._heap)

    def state(self) -> AgentState:
        """Return the state of `PlanningLearner`, and the queue."""
        queue = sorted(self._priorities.items())
        return super().state() | {
            "queued": np.array([number for number, _ in queue], np.int64),
            "priorities": np.array([priority for _, priority in queue]),
        }

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        super().load(state)
        queued = zip(state["queued"].tolist(), state["priorities"].tolist(), strict=True)
        self._priorities = dict(queued)
        self._rebuild_heap()

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `PlanningLearner` does, and the queue."""
        PlanningLearner.check_state(state)
        queued, priorities = state["queued"], state["priorities"]
        if (
            queued.dtype.kind != "i"
            or not np.isin(queued, np.arange(len(state["model_pairs"]))).all()
        ):
            raise ValueError("its queue has steps that were never tried")
        if queued.shape != priorities.shape or not (priorities > 0).all():
            raise ValueError("its queue has steps without a priority")
        if (state["model_pairs"][queued, 2] < 1).any():
            raise ValueError("its queue has steps that were never tried")
