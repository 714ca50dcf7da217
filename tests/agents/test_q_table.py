"""The table of state-action values: its size, its order, its hash."""

import hashlib
import math
import struct
from itertools import product
from typing import Any

import numpy as np
import pytest

from app.agents.q_table import MAX_VALUES, QTable
from app.domain.errors import InvalidInput, TableMismatch
from app.domain.grid import FootGrid
from app.domain.observation import legal_actions
from app.domain.types import Action


def legal_values(table: QTable) -> int:
    return sum(int(np.isfinite(values).sum()) for _, values, _ in table.rows())


def test_two_divisions_make_the_papers_1500_values() -> None:
    cells = len(FootGrid(divisions=2))
    table = QTable(pairs=3, cells=cells)

    assert table.states == 125
    assert {len(legal_actions(s, cells)) for s in product(range(cells), repeat=3)} == {12}
    assert table.size == legal_values(table) == 1500


def test_three_divisions_make_nine_cells() -> None:
    table = QTable(pairs=3, cells=len(FootGrid(divisions=3)))

    assert (table.cells, table.states, legal_values(table)) == (9, 729, 729 * 24)


def test_a_state_reads_its_cells_as_digits_the_first_pair_the_highest() -> None:
    table = QTable(3, 5)

    assert [table.index(s) for s in product(range(5), repeat=3)] == list(range(125))
    assert [table.column(Action(p, c)) for p in range(3) for c in range(5)] == list(range(15))


def test_values_and_visits_of_a_state_are_not_a_number_where_illegal() -> None:
    table = QTable(2, 3)
    table.q[table.index((1, 2)), table.column(Action(1, 0))] = 0.5
    table.n[table.index((1, 2)), table.column(Action(1, 0))] = 7

    assert np.array_equal(table.values((1, 2)), [[0, np.nan, 0], [0.5, 0, np.nan]], equal_nan=True)
    assert np.array_equal(table.visits((1, 2)), [[0, np.nan, 0], [7, 0, np.nan]], equal_nan=True)
    assert [state for state, _, _ in table.rows()] == list(product(range(3), repeat=2))


def test_the_hash_is_of_values_alone_states_then_actions_illegal_ones_nan() -> None:
    table = QTable(2, 3)
    table.q[:] = np.arange(54).reshape(9, 6) / 7
    table.n[:] = 3
    written = b""
    for first, second in product(range(3), repeat=2):
        for pair, cell in product(range(2), range(3)):
            value = (((first * 3 + second) * 2 + pair) * 3 + cell) / 7
            illegal = cell == (first, second)[pair]
            written += struct.pack("<d", math.nan if illegal else value)

    assert table.sha256() == hashlib.sha256(written).hexdigest()
    table.n[:] = 4
    assert table.sha256() == hashlib.sha256(written).hexdigest()
    table.q[0, 1] += 1e-16
    assert table.sha256() != hashlib.sha256(written).hexdigest()


def test_the_hash_of_a_table_of_many_states_is_that_of_its_rows() -> None:
    table = QTable(3, 22)
    table.q[:] = np.random.default_rng(1).normal(size=table.q.shape)
    digest = hashlib.sha256()
    for _, values, _ in table.rows():
        digest.update(values.astype("<f8").tobytes())

    assert table.sha256() == digest.hexdigest()


def test_a_dump_holds_what_was_visited_and_loads_the_same() -> None:
    table, copy = QTable(3, 5), QTable(3, 5)
    table.q[7, 3], table.n[7, 3] = -0.25, 2
    table.n[124, 14] = 1  # visited, and worth nothing
    copy.q[:], copy.n[:] = 1, 1
    copy.load(table.dump())

    assert table.dump()["where"].tolist() == [7 * 15 + 3, 1874]
    assert np.array_equal(copy.q, table.q)
    assert np.array_equal(copy.n, table.n)
    assert copy.sha256() == table.sha256()


def broken(**changes: Any) -> dict[str, Any]:
    table = QTable(3, 5)
    table.q[0, 1], table.n[0, 1] = 0.5, 1
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
    ],
)
def test_what_is_no_table_of_this_shape_is_refused(arrays: dict[str, Any], message: str) -> None:
    with pytest.raises(TableMismatch, match=message):
        QTable(3, 5).load(arrays)


def test_a_table_too_large_says_how_large_it_may_be() -> None:
    with pytest.raises(InvalidInput, match=f"the most is {MAX_VALUES:,}: choose fewer divisions"):
        QTable(pairs=4, cells=65)
