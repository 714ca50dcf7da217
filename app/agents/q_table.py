"""The table of state-action values: one row per state, one column per (pair, cell)."""

import hashlib
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from app.domain.errors import InvalidInput, TableMismatch
from app.domain.types import Action, Cells, FloatArray

MAX_VALUES = 64_000_000
"""A table of six legs at eight divisions has 53,551,875."""
_ROWS_AT_ONCE = 10_000


class QTable:
    """Values and visit counts of all states of `pairs` leg pairs over `cells` cells.

    A state's index reads its cells as digits, the first pair the highest; an action's column is
    pair · cells + cell. A pair may not be sent to the cell that it is on: those columns are never
    read, and are NaN in what leaves the table.

    Raises:
        InvalidInput: if the table would be larger than `MAX_VALUES`.
    """

    def __init__(self, pairs: int, cells: int) -> None:
        self.pairs, self.cells = pairs, cells
        self.states: int = cells**pairs
        self.actions = pairs * cells
        if self.states * self.actions > MAX_VALUES:
            raise InvalidInput(
                f"a table of {pairs} leg pairs and {cells} cells has "
                f"{self.states * self.actions:,} values; the most is {MAX_VALUES:,}: "
                "choose fewer divisions or fewer legs"
            )
        self.q: FloatArray = np.zeros((self.states, self.actions))
        self.n: NDArray[np.uint32] = np.zeros((self.states, self.actions), np.uint32)

    def index(self, observation: Cells) -> int:
        """The row of a state."""
        row: int = 0
        for cell in observation:
            row = row * self.cells + cell
        return row

    def column(self, action: Action) -> int:
        """The column of an action."""
        return action.pair * self.cells + action.cell

    def values_of(self, observation: Cells, actions: Sequence[Action]) -> list[float]:
        """The values of some actions in this state, as plain floats."""
        row: list[float] = self.q[self.index(observation)].tolist()
        cells = self.cells
        return [row[pair * cells + cell] for pair, cell in actions]

    def values(self, observation: Cells) -> FloatArray:
        """(pairs, cells) values of the actions in this state, NaN where illegal."""
        return self._row(self.q, observation)

    def visits(self, observation: Cells) -> FloatArray:
        """(pairs, cells) visits of the actions in this state, NaN where illegal."""
        return self._row(self.n, observation)

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Every state in order with its values and visits, (pairs, cells), NaN where illegal."""
        for state in product(range(self.cells), repeat=self.pairs):
            yield state, self.values(state), self.visits(state)

    @property
    def size(self) -> int:
        """How many state-action values there are: 1,500 at two divisions and three pairs."""
        return self.states * (self.actions - self.pairs)

    def sha256(self) -> str:
        """Hash of the values as little-endian float64, states then actions, illegal ones NaN."""
        digest = hashlib.sha256()
        for first in range(0, self.states, _ROWS_AT_ONCE):
            rows = self.q[first : first + _ROWS_AT_ONCE].astype("<f8")
            rows = rows.reshape(-1, self.pairs, self.cells)
            places = np.arange(len(rows))
            at = np.unravel_index(first + places, (self.cells,) * self.pairs)
            for pair in range(self.pairs):
                rows[places, pair, at[pair]] = np.nan
            digest.update(rows.tobytes())
        return digest.hexdigest()

    def dump(self) -> dict[str, NDArray[np.generic]]:
        """Only what was ever visited, so that a large table is a small file."""
        where = np.flatnonzero(self.n)
        return {
            "shape": np.array([self.pairs, self.cells]),
            "where": where,
            "q": self.q.ravel()[where],
            "n": self.n.ravel()[where],
        }

    def load(self, arrays: dict[str, NDArray[np.generic]]) -> None:
        """Replace all values and visits by those that `dump` returned.

        Raises:
            TableMismatch: if they are of a table of another shape, or do not fit together.
        """
        if missing := {"shape", "where", "q", "n"} - set(arrays):
            raise TableMismatch(f"this is no Q-table: it lacks {', '.join(sorted(missing))}")
        shape, where, q, n = (arrays[name] for name in ("shape", "where", "q", "n"))
        if shape.tolist() != [self.pairs, self.cells]:
            raise TableMismatch(
                f"the table's leg pairs and cells are {shape.tolist()}, "
                f"this problem's {[self.pairs, self.cells]}"
            )
        kinds = where.dtype.kind + q.dtype.kind + n.dtype.kind
        if kinds != "ifu" or not (where.shape == q.shape == n.shape) or not np.isfinite(q).all():
            raise TableMismatch("the table's values, visits and places do not fit together")
        if where.size and not (where.min() >= 0 and where.max() < self.q.size):
            raise TableMismatch("the table has values for states that do not exist")
        self.q[:], self.n[:] = 0, 0
        self.q.ravel()[where], self.n.ravel()[where] = q, n

    def _row(self, table: NDArray[np.generic], observation: Cells) -> FloatArray:
        row: FloatArray = table[self.index(observation)].astype(float)
        row = row.reshape(self.pairs, self.cells)
        row[range(self.pairs), observation] = np.nan
        return row
