"""Streaming reader of a Q-table's sparse form: converts it to dense rows in constant memory.

The sparse form is three arrays of equal length: `where`, the flat indices (state · actions +
column) of the visited entries in ascending order, and their values `q` and visits `n`.
"""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.errors import TableMismatch
from hexapods.domain.types import Cells, FloatArray

VALUES_AT_ONCE = 4096
TABLE_ARRAYS = ("where", "q", "n")
"""Names of the arrays of the sparse form, without `shape`."""
Chunk = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]
"""A chunk of `where`, `q` and `n`."""


class TableRows:
    """Iterates over the dense rows of a `QTable`'s sparse form."""

    def __init__(self, groups: int, cells: int, chunks: Callable[[], Iterator[Chunk]]) -> None:
        """Store the source; reading starts with the iteration.

        Args:
            groups: number of groups of legs.
            cells: number of cells of the foot grid.
            chunks: starts an iteration over the chunks of the sparse form, in order.
        """
        self.groups, self.cells = groups, cells
        self._chunks = chunks

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Iterate over all states in order, with values and visits, (groups, cells), NaN illegal.

        Raises:
            TableMismatch: if the indices are not ascending.
        """
        groups = range(self.groups)
        states = product(range(self.cells), repeat=self.groups)
        for q, n in self._dense(max(1, VALUES_AT_ONCE // (self.groups * self.cells))):
            for values, visits in zip(q, n, strict=True):
                state = next(states)
                values[groups, state] = visits[groups, state] = np.nan
                yield state, values, visits

    def entries(self) -> Iterator[Mapping[str, Any]]:
        """Yield the values of all legal actions in order: state, action, value [m], visits."""
        for state, values, counts in self.rows():
            for group, cell in np.argwhere(~np.isnan(values)).tolist():
                value, visits = float(values[group, cell]), int(counts[group, cell])
                yield {"state": state, "action": (group, cell), "value": value, "visits": visits}

    def sha256(self) -> str:
        """Return the SHA-256 of the values as little-endian float64, row-major, NaN if illegal.

        Raises:
            TableMismatch: if the indices are not ascending.
        """
        digest, first = hashlib.sha256(), 0
        for q, _ in self._dense(1000):
            places = np.arange(len(q))
            at = np.unravel_index(first + places, (self.cells,) * self.groups)
            for group in range(self.groups):
                q[places, group, at[group]] = np.nan
            digest.update(q.astype("<f8", copy=False).data)
            first += len(q)
        return digest.hexdigest()

    def _dense(self, at_once: int) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Iterate over blocks of rows: values and visits, (rows, groups, cells) each."""
        chunks, actions = self._chunks(), self.groups * self.cells
        where, q, n = next(chunks, _EMPTY_CHUNK)
        states: int = self.cells**self.groups
        for first in range(0, states, at_once):
            rows = min(at_once, states - first)
            values, visits = np.zeros(rows * actions), np.zeros(rows * actions)
            begin, end = first * actions, (first + rows) * actions
            while where.size:
                count = int(np.searchsorted(where, end))
                if (where[:count] < begin).any():
                    raise TableMismatch(NOT_RISING)
                values[where[:count] - begin], visits[where[:count] - begin] = q[:count], n[:count]
                where, q, n = where[count:], q[count:], n[count:]
                if where.size:
                    break
                where, q, n = next(chunks, _EMPTY_CHUNK)
            shape = (rows, self.groups, self.cells)
            yield values.reshape(shape), visits.reshape(shape)


def flat_entry(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return an entry of a table with a column for each number, by the names of the files."""
    columns: dict[str, Any] = {}
    for name, value in entry.items():
        if name == "action":
            columns["action_pair"], columns["action_cell"] = value
        elif isinstance(value, tuple):
            columns |= {f"{name}_{group}": cell for group, cell in enumerate(value)}
        else:
            columns[name] = value
    return columns


NOT_RISING = "the table's values are not in rising order of their states"
_EMPTY_CHUNK: Chunk = (np.empty(0, np.int64), np.empty(0), np.empty(0))
