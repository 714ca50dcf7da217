"""Dyna-Q+ (Sutton 1990; Sutton and Barto, 2nd edition, §8.3)."""

from math import sqrt
from typing import Annotated, Any

from annotated_types import Ge, Le

from hexapods.agents.dyna_q import DynaQ
from hexapods.agents.protocol import Transition
from hexapods.agents.tabular_model import TriedPair
from hexapods.agents.value_table import legal_columns
from hexapods.domain.settings import Setting

Bonus = Annotated[
    float,
    Ge(0),
    Le(0.01),
    Setting(
        title="Exploration bonus",
        symbol="κ",
        unit="m",
        help="Imagined reward for what it has not tried for long: κ times the root of the steps.",
        examples=(0.0001, 0.0003, 0.001),
    ),
]


class DynaQPlus(DynaQ):
    """Dyna-Q that imagines a bonus of κ√τ for a pair that was not tried for τ steps.

    So it tries pairs with low values again, and notices a world that has changed. Untried actions
    of a visited state are imagined too, with the bonus as reward, and without a change of state.

    Args:
        bonus_m: κ [m].
        settings: as for `DynaQ`.
    """

    title = "Dyna-Q+"
    description = "Dyna-Q that grows curious about steps it has not tried for long."
    color = "#999933"

    def __init__(self, *args: Any, bonus_m: Bonus = 0.0001, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._bonus_m = bonus_m

    def _update(self, transition: Transition, state: int, column: int) -> None:
        """Update as in Dyna-Q, with all actions of this state in the model from now on."""
        for legal_column in legal_columns(state, self.table.groups, self.table.cells):
            self._model.imagine(state, legal_column)
        super()._update(transition, state, column)

    def _imagined_reward_m(self, pair: TriedPair) -> float:
        return pair.last_reward_m + self._bonus_m * sqrt(self._model.steps - pair.last_step)
