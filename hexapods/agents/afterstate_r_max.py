"""R-max over landings (afterstates: Sutton and Barto, 2nd edition, §6.8)."""

from typing import Any

import numpy as np

from hexapods.agents.landing_table import LandingTable
from hexapods.agents.model_planning import ModelArrays
from hexapods.agents.protocol import Problem
from hexapods.agents.r_max import RMax
from hexapods.agents.tabular_model import TabularModel
from hexapods.agents.value_table import ValueTable
from hexapods.domain.errors import InvalidInput
from hexapods.domain.types import FloatArray

MAX_MODEL_LANDINGS = 300_000
"""Maximum of landings of a model; each takes about 1 kB."""


class LandingArrays(ModelArrays):
    """A model of landings as arrays: its pairs are landings, which many states lead to.

    Attributes:
        states: indices of the states that followed a landing, ascending.
        untried: number of legal actions of each of them whose landing never came.
    """

    def __init__(self, model: TabularModel, table: LandingTable) -> None:
        super().__init__(model, table.groups, table.cells)
        numbers = np.full(table.states, -1)
        numbers[[pair.state for pair in model.pairs]] = np.arange(len(model.pairs))
        landings = [table.legal_landings(state) for state in self.states.tolist()]
        count = table.groups * (table.cells - 1)
        self._within_reach = numbers[np.array(landings, np.int64).reshape(-1, count)]
        """Number of the landing of each legal action of each state; −1 if it never came."""
        self.untried = (self._within_reach < 0).sum(1)
        self._values = np.full(len(model.pairs) + 1, -np.inf)
        """Value of each landing [m]; −∞ at the end, for those that never came."""

    def best_of_states(self, values: FloatArray, untried_m: FloatArray) -> FloatArray:
        """Return the value of the best action of each state, tried or not [m]."""
        self._values[:-1] = values
        return np.asarray(np.maximum(self._values[self._within_reach].max(1), untried_m))


class AfterstateRMax(RMax):
    """R-max with a model of landings, in place of one of states and actions.

    A landing is unknown until it came m times. The estimates of known landings still change: a cell
    stands for all places of the feet near it, so that a mean of many rewards is more exact.

    Args:
        settings: as for `RMax`.
    """

    title = "Afterstate R-max"
    description = "Hopes for the best of every landing it has not seen, until it has seen them all."
    color = "#AA4499"

    @staticmethod
    def _new_table(groups: int, cells: int) -> ValueTable:
        return LandingTable(groups, cells)

    @staticmethod
    def check_problem(problem: Problem, **_settings: Any) -> None:
        """Check that a model of all landings would fit into memory.

        Raises:
            InvalidInput: if it would not; the message names the number of landings.
        """
        groups, cells = len(problem.groups), len(problem.cells_m)
        if cells**groups > MAX_MODEL_LANDINGS:
            raise InvalidInput(
                f"a learner with a model of landings takes at most {MAX_MODEL_LANDINGS:,}, and "
                f"{groups} groups of legs on {cells} cells have {cells**groups:,}: choose fewer "
                "divisions or a learner without a model, such as afterstate-q"
            )

    def _arrays(self) -> LandingArrays:
        assert isinstance(self._table, LandingTable)  # noqa: S101 - of `_new_table`
        return LandingArrays(self._model, self._table)

    def _learn(self, state: int, column: int, reward_m: float, next_state: int) -> None:
        """Add the transition to the model, also of a landing that is known."""
        self._model.learn(state, column, reward_m, next_state)
        self._planned = None
