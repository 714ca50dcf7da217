"""Q-table: size, order of states and actions, hash, sparse dump."""

import hashlib
import math
import struct
from itertools import product
from typing import Any

import numpy as np
import psutil
import pytest

from hexapods.agents.q_table import MAX_VALUES, QTable
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action


def legal_values(table: QTable) -> int:
    return sum(int(np.isfinite(values).sum()) for _, values, _ in table.rows())


def test_two_divisions_give_the_papers_1500_values() -> None:
    cells = len(FootGrid(divisions=2))
    table = QTable(groups=3, cells=cells)

    assert table.states == 125
    assert {len(legal_actions(s, cells)) for s in product(range(cells), repeat=3)} == {12}
    assert table.size == legal_values(table) == 1500


def test_three_divisions_give_nine_cells() -> None:
    table = QTable(groups=3, cells=len(FootGrid(divisions=3)))

    assert (table.cells, table.states, legal_values(table)) == (9, 729, 729 * 24)


def test_index_has_the_cells_as_digits_the_first_pair_most_significant() -> None:
    table = QTable(3, 5)

    assert [table.index(s) for s in product(range(5), repeat=3)] == list(range(125))
    assert [table.column(Action(p, c)) for p in range(3) for c in range(5)] == list(range(15))


def test_values_and_visits_are_nan_where_illegal() -> None:
    table = QTable(2, 3)
    (q, n), column = table.row(table.index((1, 2))), table.column(Action(1, 0))
    q[column], n[column] = 0.5, 7

    assert np.array_equal(table.values((1, 2)), [[0, np.nan, 0], [0.5, 0, np.nan]], equal_nan=True)
    assert np.array_equal(table.visits((1, 2)), [[0, np.nan, 0], [7, 0, np.nan]], equal_nan=True)
    assert [state for state, _, _ in table.rows()] == list(product(range(3), repeat=2))


def test_hash_covers_values_in_row_major_order_with_nan_where_illegal() -> None:
    table = QTable(2, 3)
    for state in reversed(range(9)):  # the order in which states are met does not matter
        q, n = table.row(state)
        q[:], n[:] = np.arange(6 * state, 6 * state + 6) / 7, 3
    written = b""
    for first, second in product(range(3), repeat=2):
        for pair, cell in product(range(2), range(3)):
            value = (((first * 3 + second) * 2 + pair) * 3 + cell) / 7
            illegal = cell == (first, second)[pair]
            written += struct.pack("<d", math.nan if illegal else value)

    assert table.sha256() == hashlib.sha256(written).hexdigest()
    table.row(3)[1][:] = 4
    assert table.sha256() == hashlib.sha256(written).hexdigest()
    table.row(0)[0][1] += 1e-16
    assert table.sha256() != hashlib.sha256(written).hexdigest()


def test_hash_of_a_large_table_equals_that_of_its_rows() -> None:
    table = QTable(3, 22)
    chance = np.random.default_rng(1)
    for state in chance.permutation(table.states)[::2]:
        table.row(state)[0][:] = chance.normal(size=table.actions)
    digest = hashlib.sha256()
    for _, values, _ in table.rows():
        digest.update(values.astype("<f8").tobytes())

    assert table.sha256() == digest.hexdigest()


def test_dump_has_visited_entries_and_round_trips() -> None:
    table, copy = QTable(3, 5), QTable(3, 5)
    table.row(124)[1][14] = 1  # visited, and worth nothing
    table.row(7)[0][3], table.row(7)[1][3] = -0.25, 2
    for state in range(0, 125, 3):
        copy.row(state)[0][:], copy.row(state)[1][:] = 1, 1
    copy.load(table.dump())

    assert table.dump()["where"].tolist() == [7 * 15 + 3, 1874]
    again = copy.dump()
    assert all(np.array_equal(again[name], array) for name, array in table.dump().items())
    assert copy.sha256() == table.sha256()


def test_reading_an_unvisited_state_allocates_no_row() -> None:
    table, legal = QTable(3, 5), legal_actions((0, 1, 2), 5)

    assert table.values_of((0, 1, 2), legal) == [0.0] * 12
    assert np.nansum(table.values((0, 1, 2))) == np.nansum(table.visits((0, 1, 2))) == 0
    assert not table.dump()["where"].size


@pytest.mark.test
def test_memory_is_proportional_to_visited_states() -> None:
    table = QTable(3, 65)
    chance = np.random.default_rng(1)
    before = psutil.Process().memory_info().rss
    for state in chance.integers(table.states, size=2000).tolist():
        q, n = table.row(state)
        q[5], n[5] = 0.25, 1
    table.sha256()
    copy = QTable(3, 65)
    copy.load(table.dump())

    # Two tables of 2,000 rows of 2,340 bytes, of 642 MB in all; the rest is the hash's buffers.
    assert psutil.Process().memory_info().rss - before < 40_000_000
    assert copy.sha256() == table.sha256()


def broken(**changes: Any) -> dict[str, Any]:
    table = QTable(3, 5)
    table.row(0)[0][1], table.row(0)[1][1] = 0.5, 1
    return {k: v for k, v in {**table.dump(), **changes}.items() if v is not None}


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (broken(shape=np.array([4, 5])), r"\[4, 5\], this problem's \[3, 5\]"),
        (broken(shape=np.array([3, 9])), r"\[3, 9\], this problem's \[3, 5\]"),
        (broken(shape=np.array(3)), "this problem's"),
        (broken(q=None, n=None), "this is no Q-table: it lacks n, q"),
        (broken(q=np.array([0.5, 1])), "do not fit together"),
        (broken(q=np.array([np.nan])), "do not fit together"),
        (broken(q=np.array(["a lot"])), "do not fit together"),
        (broken(where=np.array([0.0])), "do not fit together"),
        (broken(n=np.array([-1])), "do not fit together"),
        (broken(where=np.array([1875])), "states that do not exist"),
        (broken(where=np.array([-1])), "states that do not exist"),
        (
            broken(where=np.array([2, 1]), q=np.zeros(2), n=np.ones(2, np.uint32)),
            "not in rising order",
        ),
        (
            broken(where=np.array([2, 2]), q=np.zeros(2), n=np.ones(2, np.uint32)),
            "not in rising order",
        ),
    ],
)
def test_invalid_arrays_are_refused(arrays: dict[str, Any], message: str) -> None:
    with pytest.raises(TableMismatch, match=message):
        QTable(3, 5).load(arrays)


def test_too_large_table_is_refused_with_the_maximum() -> None:
    with pytest.raises(InvalidInput, match=f"17,850,625 states, .*is {MAX_VALUES:,}: choose"):
        QTable(groups=4, cells=65)
