"""Table of the values of landings: one value for all steps that end with the feet alike.

A landing is where the feet stand when a step ends: the observed cells, with the cell of the group
that moves replaced (an afterstate: Sutton and Barto, 2nd edition, §6.8). It is known before the
step is taken. Three groups on five cells have 1,500 state-action pairs and 125 landings, each of
which twelve pairs end in.
"""

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.table_rows import NOT_RISING, Chunk
from hexapods.agents.value_table import ValueTable, legal_columns
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.types import Action, Cells, FloatArray, IntArray

MAX_LANDINGS = 4_000_000
"""Maximum number of landings; six legs one by one on ten cells have a million."""
LANDING_ARRAYS = ("landings", "values", "visits")
"""Names of the arrays of the sparse form beside `shape`: indices, values and visit counts."""


class LandingTable(ValueTable):
    """Values and visit counts of the landings of `groups` groups of legs over `cells` cells.

    The index of a landing is that of the state whose cells it has. The entry of a landing is named
    by that state and the first group's action that leaves it there.

    Raises:
        InvalidInput: if there are more than `MAX_LANDINGS`.
    """

    def __init__(self, groups: int, cells: int) -> None:
        check_landings(groups, cells)
        super().__init__(groups, cells)
        self._first_place = cells ** (groups - 1)
        self._clear()

    def _clear(self) -> None:
        self._values: FloatArray = np.zeros(self.states)
        self._visits: NDArray[np.uint32] = np.zeros(self.states, np.uint32)

    @property
    def size(self) -> int:
        """Number of landings: 125 at two divisions and three groups."""
        return self.states

    def landing(self, state: int, column: int) -> int:
        """Return the index of the landing of an action in a state."""
        group, cell = divmod(column, self.cells)
        place: int = self.cells ** (self.groups - 1 - group)
        return state + (cell - state // place % self.cells) * place

    def entry(self, state: int, column: int) -> tuple[int, int]:
        """Return the state that a landing is like, and the first group's column of its own cell."""
        landing = self.landing(state, column)
        return landing, landing // self._first_place

    def value(self, state: int, column: int) -> float:
        """Return the value of the landing of an action in a state."""
        return float(self._values[self.landing(state, column)])

    def set_value(self, state: int, column: int, value: float) -> None:
        """Replace the value of the landing of an action in a state."""
        self._values[self.landing(state, column)] = value

    def count_visit(self, state: int, column: int) -> None:
        """Count a visit of the landing of an action in a state."""
        self._visits[self.landing(state, column)] += 1

    def values_of(self, observation: Cells, actions: Sequence[Action]) -> list[float]:
        """Return the values of the landings of some actions in a state, as plain floats."""
        row: list[float] = self._values[self._landings(self.index(observation))].tolist()
        return [row[group * self.cells + cell] for group, cell in actions]

    def best(self, state: int) -> float:
        """Return the highest value of the landings of the legal actions in a state."""
        return float(self._values[self.legal_landings(state)].max())

    def legal_landings(self, state: int) -> IntArray:
        """Return the indices of the landings of the legal actions in a state, in order."""
        return _legal_landings(state, self.groups, self.cells)

    def values(self, observation: Cells) -> FloatArray:
        """Return the values of the landings of the actions, (groups, cells), NaN if illegal."""
        return self._row(self._values, observation)

    def visits(self, observation: Cells) -> FloatArray:
        """Return the visit counts of the actions' landings, (groups, cells), NaN where illegal."""
        return self._row(self._visits, observation)

    def _row(self, table: NDArray[Any], observation: Cells) -> FloatArray:
        row: FloatArray = table[self._landings(self.index(observation))].astype(float)
        row = row.reshape(self.groups, self.cells)
        row[range(self.groups), observation] = np.nan
        return row

    def _landings(self, state: int) -> IntArray:
        """Return the landing of each column in a state, (actions,); that state where illegal."""
        return _landings(state, self.groups, self.cells)

    def rows(self) -> Iterator[tuple[Cells, float, int]]:
        """Yield all landings in order, with value and visits."""
        return LandingRows(self.groups, self.cells, self._chunks).rows()

    def sha256(self) -> str:
        """Return the SHA-256 of the values as little-endian float64."""
        return LandingRows(self.groups, self.cells, self._chunks).sha256()

    def _chunks(self) -> Iterator[Chunk]:
        landings = np.flatnonzero((self._visits > 0) | (self._values != 0))
        yield landings, self._values[landings], self._visits[landings]

    def dump(self) -> dict[str, NDArray[Any]]:
        """Return the landings that were visited or have a value, ascending, and the shape."""
        (columns,) = self._chunks()
        return {
            "shape": np.array([self.groups, self.cells]),
            **dict(zip(LANDING_ARRAYS, columns, strict=True)),
        }

    def load(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Replace all values and visits by the output of `dump`.

        Raises:
            TableMismatch: if the arrays are inconsistent, or of a table of another shape.
        """
        check_landing_arrays(arrays, self.groups, self.cells)
        landings, values, visits = (arrays[name] for name in LANDING_ARRAYS)
        self._clear()
        self._values[landings], self._visits[landings] = values, visits


class LandingRows:
    """Rows of a landing table's sparse form, read in chunks: one a landing, in order."""

    def __init__(self, groups: int, cells: int, chunks: Callable[[], Iterator[Chunk]]) -> None:
        """Store the source; reading starts with the iteration.

        Args:
            groups: number of groups of legs.
            cells: number of cells of the foot grid.
            chunks: starts an iteration over the chunks of the sparse form, in order.
        """
        self.groups, self.cells = groups, cells
        self._chunks = chunks

    def rows(self) -> Iterator[tuple[Cells, float, int]]:
        """Yield all landings in order, with value and visits; 0 of those that are not stored."""
        stored = self._stored()
        index, value, visits = next(stored, _END)
        for landing, cells in enumerate(product(range(self.cells), repeat=self.groups)):
            if landing == index:
                yield cells, value, visits
                index, value, visits = next(stored, _END)
            else:
                yield cells, 0.0, 0

    def entries(self) -> Iterator[Mapping[str, Any]]:
        """Yield the values of all landings in order: landing, value [m], visits."""
        for landing, value, visits in self.rows():
            yield {"landing": landing, "value": value, "visits": visits}

    def _stored(self) -> Iterator[tuple[int, float, int]]:
        before = -1
        for columns in self._chunks():
            for row in zip(*(array.tolist() for array in columns), strict=True):
                if row[0] <= before:
                    raise TableMismatch(NOT_RISING)
                before = row[0]
                yield row

    def sha256(self) -> str:
        """Return the SHA-256 of the values as little-endian float64."""
        values = np.zeros(self.cells**self.groups, "<f8")
        for landings, stored_values, _ in self._chunks():
            values[landings] = stored_values
        return hashlib.sha256(values.data).hexdigest()


_END = (-1, 0.0, 0)


@lru_cache(maxsize=1 << 12)
def _landings(state: int, groups: int, cells: int) -> IntArray:
    places = cells ** np.arange(groups - 1, -1, -1)
    present = state // places % cells
    landings: IntArray = state + (np.arange(cells) - present[:, None]) * places[:, None]
    return landings.ravel()


@lru_cache(maxsize=1 << 12)
def _legal_landings(state: int, groups: int, cells: int) -> IntArray:
    return _landings(state, groups, cells)[[*legal_columns(state, groups, cells)]]


def check_landings(groups: int, cells: int) -> None:
    """Check that there are at most `MAX_LANDINGS` landings.

    Raises:
        InvalidInput: if there are more.
    """
    if cells**groups > MAX_LANDINGS:
        raise InvalidInput(
            f"{groups} groups of legs on {cells} cells have {cells**groups:,} landings; the most "
            f"is {MAX_LANDINGS:,}: choose larger groups, fewer divisions, or an agent without a "
            "table"
        )


def check_landing_arrays(arrays: Mapping[str, NDArray[Any]], groups: int, cells: int) -> None:
    """Check that arrays are a valid output of `LandingTable.dump` for a table of this shape.

    Raises:
        TableMismatch: if they are inconsistent, or of a table of another shape.
    """
    if missing := {"shape", *LANDING_ARRAYS} - set(arrays):
        raise TableMismatch(f"this is no table of landings: it lacks {', '.join(sorted(missing))}")
    shape = arrays["shape"].tolist()
    if shape != [groups, cells]:
        raise TableMismatch(
            f"the table's groups of legs and cells are {shape}, this problem's {[groups, cells]}"
        )
    landings, values, visits = (arrays[name] for name in LANDING_ARRAYS)
    kinds = landings.dtype.kind + values.dtype.kind + visits.dtype.kind
    has_equal_shapes = landings.ndim == 1 and landings.shape == values.shape == visits.shape
    if kinds != "ifu" or not has_equal_shapes or not np.isfinite(values).all():
        raise TableMismatch("the table's values, visits and landings do not fit together")
    if landings.size and not (landings.min() >= 0 and landings.max() < cells**groups):
        raise TableMismatch("the table has values for landings that do not exist")
    if not np.all(np.diff(landings) > 0):
        raise TableMismatch("the table's values are not in rising order of their landings")
