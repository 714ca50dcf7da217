"""Q-table, sparse by rows: one row per state, one column per action (group, cell)."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.table_rows import NOT_RISING, Chunk, TableRows
from hexapods.agents.value_table import ValueTable, legal_columns
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.types import Action, Cells, FloatArray

MAX_VALUES = 64_000_000
"""Maximum number of values; a table of six legs at eight divisions has 53,551,875."""
_ROWS_AT_ONCE = 1_000
_VALUES_AT_ONCE = 100_000
_NO_SLOT = -1


class QTable(ValueTable):
    """Values and visit counts of all states of `groups` groups of legs over `cells` cells.

    Moving a group to its current cell is illegal: those entries are never read, and are NaN in all
    output.

    Sparse by rows: only states that were written to take memory, 12 bytes per value. Rows are
    stored in the order of their first write, in arrays of the full size, of which the operating
    system commits used pages only.

    Raises:
        InvalidInput: if the table would be larger than `MAX_VALUES`.
    """

    def __init__(self, groups: int, cells: int) -> None:
        check_size(groups, cells)
        super().__init__(groups, cells)
        self._clear()

    def _clear(self) -> None:
        self._q: FloatArray = np.zeros((self.states, self.actions))
        self._n: NDArray[np.uint32] = np.zeros((self.states, self.actions), np.uint32)
        self._slots = np.full(self.states, _NO_SLOT, np.int32)
        """Row of each state in the arrays; `_NO_SLOT` if it was never written to."""
        self._used = 0

    def values_of(self, observation: Cells, actions: Sequence[Action]) -> list[float]:
        """Return the values of some actions in a state, as plain floats."""
        slot = self._slots[self.index(observation)]
        if slot == _NO_SLOT:
            return [0.0] * len(actions)
        row: list[float] = self._q[slot].tolist()
        cells = self.cells
        return [row[group * cells + cell] for group, cell in actions]

    def best(self, state: int) -> float:
        """Return the highest value of a legal action in a state given by its index."""
        slot = self._slots[state]
        if slot == _NO_SLOT:
            return 0.0
        row: list[float] = self._q[slot].tolist()
        return max([row[column] for column in legal_columns(state, self.groups, self.cells)])

    def values(self, observation: Cells) -> FloatArray:
        """Return the action values in a state, (groups, cells), NaN where illegal."""
        return self._row(self._q, observation)

    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts in a state, (groups, cells), NaN where illegal."""
        return self._row(self._n, observation)

    def row(self, state: int) -> tuple[FloatArray, NDArray[np.uint32]]:
        """Return writable views of a state's values and visits by its index, (actions,) each."""
        slot = self._slots[state]
        if slot == _NO_SLOT:
            slot = self._slots[state] = self._used
            self._used += 1
        return self._q[slot], self._n[slot]

    def entry(self, state: int, column: int) -> tuple[int, int]:
        """Return the state and column unchanged: each pair has its own entry."""
        return state, column

    def value(self, state: int, column: int) -> float:
        """Return the value of an entry."""
        slot = self._slots[state]
        return 0.0 if slot == _NO_SLOT else float(self._q[slot, column])

    def set_value(self, state: int, column: int, value: float) -> None:
        """Replace the value of an entry."""
        self.row(state)[0][column] = value

    def count_visit(self, state: int, column: int) -> None:
        """Count a visit of an entry."""
        self.row(state)[1][column] += 1

    def rows(self) -> Iterator[tuple[Cells, FloatArray, FloatArray]]:
        """Yield all states in order, with values and visits, (groups, cells), NaN illegal."""
        return TableRows(self.groups, self.cells, self._chunks).rows()

    @property
    def size(self) -> int:
        """Number of legal state-action values: 1,500 at two divisions and three groups."""
        return self.states * (self.actions - self.groups)

    def sha256(self) -> str:
        """Return the SHA-256 of the values as little-endian float64, row-major, NaN if illegal."""
        return TableRows(self.groups, self.cells, self._chunks).sha256()

    def dump(self) -> dict[str, NDArray[Any]]:
        """Return the entries that were visited or have a value, sparse (see `table_rows`)."""
        size, begin = sum(len(where) for where, _, _ in self._chunks()), 0
        where, q, n = np.empty(size, np.int64), np.empty(size), np.empty(size, np.uint32)
        for columns in self._chunks():
            end = begin + len(columns[0])
            where[begin:end], q[begin:end], n[begin:end] = columns
            begin = end
        return {"shape": np.array([self.groups, self.cells]), "where": where, "q": q, "n": n}

    def _chunks(self) -> Iterator[Chunk]:
        """Yield the entries that were visited or have a value, some rows at once."""
        states = np.flatnonzero(self._slots != _NO_SLOT)
        for first in range(0, len(states), _ROWS_AT_ONCE):
            chunk = states[first : first + _ROWS_AT_ONCE]
            slots = self._slots[chunk]
            row, column = np.nonzero((self._n[slots] > 0) | (self._q[slots] != 0))
            if len(row):
                where = chunk[row] * self.actions + column
                yield where, self._q[slots[row], column], self._n[slots[row], column]

    def values_at(self, where: NDArray[np.int64]) -> FloatArray:
        """Return the values of entries given by their flat indices, as in `dump`."""
        states, columns = np.divmod(where, self.actions)
        slots = self._slots[states]
        values: FloatArray = np.where(slots == _NO_SLOT, 0.0, self._q[slots, columns])
        return values

    def load(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Replace all values and visits by the output of `dump`.

        Raises:
            TableMismatch: if the arrays are inconsistent, or of a table of another shape.
        """
        check_arrays(arrays, self.groups, self.cells)
        where, q, n = (arrays[name] for name in ("where", "q", "n"))
        self._clear()
        for first in range(0, len(where), _VALUES_AT_ONCE):
            rows = slice(first, first + _VALUES_AT_ONCE)
            states, columns = np.divmod(where[rows].astype(np.int64), self.actions)
            slots = self._slots_of(states)
            self._q[slots, columns], self._n[slots, columns] = q[rows], n[rows]

    def _slots_of(self, states: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the rows of states in the arrays; allocate missing ones."""
        new = np.unique(states[self._slots[states] == _NO_SLOT])
        self._slots[new] = np.arange(self._used, self._used + len(new), dtype=np.int32)
        self._used += len(new)
        return self._slots[states]

    def _row(self, table: NDArray[Any], observation: Cells) -> FloatArray:
        slot = self._slots[self.index(observation)]
        row = np.zeros(self.actions) if slot == _NO_SLOT else table[slot].astype(float)
        row = row.reshape(self.groups, self.cells)
        row[range(self.groups), observation] = np.nan
        return row


def table_size(groups: int, cells: int) -> int:
    """Return the number of values of a table: cells^groups states times groups · cells actions."""
    size: int = cells**groups * groups * cells
    return size


def check_size(groups: int, cells: int) -> None:
    """Check that a table of this shape has at most `MAX_VALUES` values.

    Raises:
        InvalidInput: if it is larger.
    """
    values = table_size(groups, cells)
    if values > MAX_VALUES:
        raise InvalidInput(
            f"{groups} groups of legs on {cells} cells have {cells**groups:,} states, and "
            f"{values:,} values; the most is {MAX_VALUES:,}: choose larger groups, fewer "
            "divisions, or an agent without a table"
        )


def check_arrays(arrays: Mapping[str, NDArray[np.generic]], groups: int, cells: int) -> None:
    """Check that arrays are a valid output of `QTable.dump` for a table of this shape.

    Raises:
        TableMismatch: if they are inconsistent, or of a table of another shape.
    """
    if missing := {"shape", "where", "q", "n"} - set(arrays):
        raise TableMismatch(f"this is no Q-table: it lacks {', '.join(sorted(missing))}")
    shape, where, q, n = (arrays[name] for name in ("shape", "where", "q", "n"))
    if shape.tolist() != [groups, cells]:
        raise TableMismatch(
            f"the table's groups of legs and cells are {shape.tolist()}, this problem's "
            f"{[groups, cells]}"
        )
    kinds = where.dtype.kind + q.dtype.kind + n.dtype.kind
    has_equal_shapes = where.ndim == 1 and where.shape == q.shape == n.shape
    if kinds != "ifu" or not has_equal_shapes or not np.isfinite(q).all():
        raise TableMismatch("the table's values, visits and places do not fit together")
    if where.size and not (where.min() >= 0 and where.max() < table_size(groups, cells)):
        raise TableMismatch("the table has values for states that do not exist")
    if not np.all(np.diff(where) > 0):
        raise TableMismatch(NOT_RISING)


def check_entries(places: NDArray[Any], count: int, shape: NDArray[Any]) -> None:
    """Check that places are the (state, column) of `count` entries of a table, (count, 2).

    Raises:
        ValueError: if they are not.
    """
    groups, cells = shape.tolist()
    if places.shape != (count, 2) or places.dtype.kind != "i":
        raise ValueError("its steps are no list of states and actions")
    if (places < 0).any() or (places >= [cells**groups, groups * cells]).any():
        raise ValueError("it has steps from states that do not exist")
