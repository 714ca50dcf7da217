"""Base class of the tables of values, and the numbers of states and actions that index them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from numpy.typing import NDArray

from hexapods.domain.types import Action, Cells, FloatArray


class ValueTable(ABC):
    """Values and visit counts of the actions of `groups` groups of legs over `cells` cells.

    The index of a state is the number whose base-`cells` digits are its cells, the first group the
    most significant; the column of an action is group · cells + cell. An entry is what is stored
    for a state and an action, and is named by one such pair.

    Attributes:
        groups, cells: number of groups of legs, and of cells of the foot grid.
        states: number of states.
        actions: number of columns, of which those to a group's present cell are illegal.
    """

    def __init__(self, groups: int, cells: int) -> None:
        self.groups, self.cells = groups, cells
        self.states: int = cells**groups
        self.actions = groups * cells

    def index(self, observation: Cells) -> int:
        """Return the index of a state."""
        row: int = 0
        for cell in observation:
            row = row * self.cells + cell
        return row

    def column(self, action: Action) -> int:
        """Return the column of an action."""
        return action.group * self.cells + action.cell

    def cells_at(self, state: int) -> Cells:
        """Return the observation of a state given by its index."""
        cells = []
        for _ in range(self.groups):
            state, cell = divmod(state, self.cells)
            cells.append(cell)
        return tuple(reversed(cells))

    def action_at(self, column: int) -> Action:
        """Return the action of a column."""
        return Action(*divmod(column, self.cells))

    @property
    @abstractmethod
    def size(self) -> int:
        """Number of values."""

    @abstractmethod
    def entry(self, state: int, column: int) -> tuple[int, int]:
        """Return the state and column by which the entry of a state and an action is stored."""

    @abstractmethod
    def value(self, state: int, column: int) -> float:
        """Return the value of an entry."""

    @abstractmethod
    def set_value(self, state: int, column: int, value: float) -> None:
        """Replace the value of an entry."""

    @abstractmethod
    def count_visit(self, state: int, column: int) -> None:
        """Count a visit of an entry."""

    @abstractmethod
    def values_of(self, observation: Cells, actions: Sequence[Action]) -> list[float]:
        """Return the values of some actions in a state, as plain floats."""

    @abstractmethod
    def best(self, state: int) -> float:
        """Return the highest value of a legal action in a state given by its index."""

    @abstractmethod
    def values(self, observation: Cells) -> FloatArray:
        """Return the action values in a state, (groups, cells), NaN where illegal."""

    @abstractmethod
    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts in a state, (groups, cells), NaN where illegal."""

    @abstractmethod
    def sha256(self) -> str:
        """Return the SHA-256 of all values as little-endian float64, in order."""

    @abstractmethod
    def dump(self) -> dict[str, NDArray[Any]]:
        """Return the entries that were visited or have a value, sparse."""

    @abstractmethod
    def load(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Replace all values and visits by the output of `dump`.

        Raises:
            TableMismatch: if the arrays are inconsistent, or of a table of another shape.
        """


@lru_cache(maxsize=1 << 12)
def legal_columns(state: int, groups: int, cells: int) -> tuple[int, ...]:
    """Return the columns of the legal actions in a state given by its index, in order."""
    columns = []
    for group in range(groups):
        present = state // cells ** (groups - 1 - group) % cells
        columns += [group * cells + cell for cell in range(cells) if cell != present]
    return tuple(columns)
