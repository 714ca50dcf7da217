"""The rows of a Q-table out of its sparse form, a few at a time: no table is in memory as a whole.

The sparse form is three arrays of one length: `where`, the rising places (state · actions + column)
of the values that were ever visited, and their values `q` and visits `n`.
"""

import hashlib
from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.domain.errors import TableMismatch
from app.domain.types import Cells, FloatArray

VALUES_AT_ONCE = 4096
Part = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]
"""Some of `where`, `q` and `n`."""


class TableRows:
    """The rows of a table of `pairs` leg pairs over `cells` cells, as those of a `QTable`."""

    def __init__(self, pairs: int, cells: int, parts: Callable[[], Iterator[Part]]) -> None:
        """Read nothing yet.

        Args:
            pairs: of legs.
            cells: of the foot grid.
            parts: begins to read the sparse form, in order.
        """
        self.pairs, self.cells = pairs, cells
        self._parts = parts

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Every state in order with its values and visits, (pairs, cells), NaN where illegal.

        Raises:
            TableMismatch: once the places do not rise.
        """
        pairs = range(self.pairs)
        states = product(range(self.cells), repeat=self.pairs)
        for q, n in self._dense(max(1, VALUES_AT_ONCE // (self.pairs * self.cells))):
            for values, visits in zip(q, n, strict=True):
                state = next(states)
                values[pairs, state] = visits[pairs, state] = np.nan
                yield state, values, visits

    def sha256(self) -> str:
        """As of `QTable.sha256`.

        Raises:
            TableMismatch: if the places do not rise.
        """
        digest, first = hashlib.sha256(), 0
        for q, _ in self._dense(1000):
            places = np.arange(len(q))
            at = np.unravel_index(first + places, (self.cells,) * self.pairs)
            for pair in range(self.pairs):
                q[places, pair, at[pair]] = np.nan
            digest.update(q.astype("<f8", copy=False).data)
            first += len(q)
        return digest.hexdigest()

    def _dense(self, at_once: int) -> Iterator[tuple[FloatArray, FloatArray]]:
        """The values and visits of some rows at a time, (rows, pairs, cells) each."""
        parts, actions = self._parts(), self.pairs * self.cells
        where, q, n = next(parts, _NOTHING)
        states: int = self.cells**self.pairs
        for first in range(0, states, at_once):
            rows = min(at_once, states - first)
            values, visits = np.zeros(rows * actions), np.zeros(rows * actions)
            begin, end = first * actions, (first + rows) * actions
            while where.size:
                here = int(np.searchsorted(where, end))
                if (where[:here] < begin).any():
                    raise TableMismatch(NOT_RISING)
                values[where[:here] - begin], visits[where[:here] - begin] = q[:here], n[:here]
                where, q, n = where[here:], q[here:], n[here:]
                if where.size:
                    break
                where, q, n = next(parts, _NOTHING)
            shape = (rows, self.pairs, self.cells)
            yield values.reshape(shape), visits.reshape(shape)


NOT_RISING = "the table's values are not in rising order of their states"
_NOTHING: Part = (np.empty(0, np.int64), np.empty(0), np.empty(0))
