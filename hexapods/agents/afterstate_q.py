"""Tabular Q-learning over landings (afterstates: Sutton and Barto, 2nd edition, §6.8)."""

from typing import Any

import numpy as np

from hexapods.agents.landing_table import LandingTable, check_landings
from hexapods.agents.protocol import AgentState, Problem
from hexapods.agents.q_learning import QLearning
from hexapods.agents.tabular import Objective, TabularLearner
from hexapods.agents.value_table import ValueTable


class AfterstateQ(QLearning):
    """The paper's learner with one value a landing, in place of one a state and action.

    The reward of a step depends on the cells of the feet after landing, not on those before it.
    So all actions that land alike share a value, and each step teaches something about all of them.

    Args:
        objective: as for `QLearning`, with another default.
        settings: as for `QLearning`.
    """

    title = "Afterstate Q"
    description = "Q-learning that values where the feet land, not how they came there."
    color = "#6BBF23"

    next_meaning = "highest value of a landing within reach of the next state"

    def __init__(self, *args: Any, objective: Objective = "average", **settings: Any) -> None:
        super().__init__(*args, objective=objective, **settings)

    @staticmethod
    def _new_table(groups: int, cells: int) -> ValueTable:
        return LandingTable(groups, cells)

    @staticmethod
    def check_problem(problem: Problem, **_settings: Any) -> None:
        """Check that the table of a problem would fit into memory.

        Raises:
            InvalidInput: if it would not; the message names the number of landings.
        """
        check_landings(len(problem.groups), len(problem.cells_m))

    def state(self) -> AgentState:
        """Return the state of `TabularLearner`, with the average reward by any objective."""
        return {**super().state(), "average": np.array([self._average_m])}

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check a saved state as `TabularLearner` does, and require its average reward."""
        TabularLearner.check_state({**state, "average": state["average"]})
