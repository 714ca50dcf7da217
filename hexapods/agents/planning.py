"""Base class of learners that also update from a model (Sutton & Barto 2018, chapter 8)."""

from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Le

from hexapods.agents.protocol import AgentState, Problem
from hexapods.agents.tabular import TabularLearner
from hexapods.agents.tabular_model import TabularModel, check_problem
from hexapods.domain.settings import Setting

PlanningSteps = Annotated[
    int,
    Ge(0),
    Le(1000),
    Setting(
        title="Planning steps",
        symbol="n",
        help="How many remembered steps it goes over again after each real one.",
        examples=(5, 20, 50),
    ),
]


class PlanningLearner(TabularLearner):
    """Learner in a Q-table that keeps a model, from which `_update` updates the table too.

    Args:
        planning_steps: n, updates from the model after each step.
        settings: as for `TabularLearner`.

    Raises:
        InvalidInput: if the problem is too large for a model.
    """

    check_problem = staticmethod(check_problem)

    def __init__(
        self,
        rng: np.random.Generator,
        problem: Problem,
        *,
        planning_steps: PlanningSteps = 20,
        **settings: Any,
    ) -> None:
        self.check_problem(problem)
        super().__init__(rng, problem, **settings)
        self._planning_steps = planning_steps
        self._model = TabularModel()

    def state(self) -> AgentState:
        """Return the state of `TabularLearner`, and the model."""
        return super().state() | self._model.dump()

    def _load_learned(self, state: AgentState) -> None:
        super()._load_learned(state)
        self._model.load(state)

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `TabularLearner` does, and the model."""
        TabularLearner.check_state(state)
        TabularModel.check(state)
