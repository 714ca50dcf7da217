"""Eligibility traces, which credit a reward to earlier steps (Sutton and Barto 1998, chapter 7)."""

from typing import Annotated, Any

import numpy as np

from hexapods.agents.protocol import AgentState, Transition
from hexapods.agents.q_table import check_entries
from hexapods.agents.tabular import Share, TabularLearner
from hexapods.domain.settings import Setting, declare

TraceDecay = Annotated[
    Share,
    Setting(
        title="Trace decay",
        symbol="λ",
        help="How far back a reward counts: 0 is the last step only, 1 all steps before it.",
        live=True,
        examples=(0, 0.5, 0.9),
    ),
]
_MIN_TRACE = 1e-3
"""Cut-off: eligibility traces below it are dropped."""


class TraceLearner(TabularLearner):
    """Base class of learners with replacing eligibility traces.

    Args:
        trace_decay: λ; the eligibility of a step is (γλ)^k for a reward k steps later.
        settings: as for `TabularLearner`.
    """

    def __init__(self, *args: Any, trace_decay: TraceDecay = 0.9, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._trace_decay = trace_decay
        self._traces: dict[tuple[int, int], float] = {}
        """Eligibility traces by (row, column) of the table, the newest last."""

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Q ← Q + α δ e for every trace e, that of this step being 1; then e ← γ λ e.

        δ = r + γ Q′ − Q(s, a), Q′ being the value of the next state. In e, γ is 1 where the
        objective is `average`.
        """
        error = self._target(transition) - self.table.value(state, column)
        self._traces.pop((state, column), None)
        self._traces[state, column] = 1.0
        discount = 1.0 if self._is_average else self._gamma
        decay, traces = discount * self._trace_decay, {}
        for pair, trace in self._traces.items():
            value = self.table.value(*pair)
            self.table.set_value(*pair, value + self._alpha * error * trace)
            if trace * decay >= _MIN_TRACE:
                traces[pair] = trace * decay
        self._traces = traces
        self._learn_average(error)

    def tune(self, *, trace_decay: TraceDecay | None = None, **changes: Any) -> None:
        """Change rates from the next step on, as in `TabularLearner`."""
        super().tune(**changes)
        self._trace_decay = self._trace_decay if trace_decay is None else trace_decay

    def state(self) -> AgentState:
        """Return the state of `TabularLearner`, λ and the eligibility traces."""
        places = np.array(list(self._traces), np.int64).reshape(-1, 2)
        traces = np.array(list(self._traces.values()))
        arrays = {"trace_decay": np.array([self._trace_decay]), "places": places, "traces": traces}
        return super().state() | arrays

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned; the caller restores the generator."""
        super().load(state)
        (self._trace_decay,) = state["trace_decay"].tolist()
        places = ((row, column) for row, column in state["places"].tolist())
        self._traces = dict(zip(places, state["traces"].tolist(), strict=True))

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `TabularLearner` does, and λ and the traces."""
        TabularLearner.check_state(state)
        declare("trace_decay", TraceDecay).check(*state["trace_decay"].tolist())
        traces = state["traces"]
        if traces.ndim != 1 or traces.dtype.kind != "f":
            raise ValueError("its traces are no list of numbers")
        check_entries(state["places"], len(traces), state["shape"])
        if not ((traces > 0) & (traces <= 1)).all():
            raise ValueError("its traces are not from 0 to 1")
