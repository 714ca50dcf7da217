"""Table of landings: one value for all steps that end with the feet alike."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from hexapods.agents.landing_table import (
    MAX_LANDINGS,
    LandingRows,
    LandingTable,
    check_landing_arrays,
)
from hexapods.agents.q_table import QTable
from hexapods.domain.errors import InvalidInput, TableMismatch
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells


def test_actions_that_land_alike_share_a_value() -> None:
    table = LandingTable(3, 5)
    table.set_value(table.index((1, 4, 3)), table.column(Action(0, 2)), 0.25)  # lands on 2, 4, 3

    assert table.values_of((2, 0, 3), [Action(1, 4)]) == [0.25]
    assert table.values_of((2, 4, 1), [Action(2, 3), Action(2, 0)]) == [0.25, 0]
    assert table.values((2, 4, 1))[2, 3] == 0.25


def test_each_landing_ends_twelve_of_the_1500_pairs() -> None:
    pairs, table = QTable(3, 5), LandingTable(3, 5)
    landings = [
        table.landing(state, table.column(action))
        for state in range(table.states)
        for action in legal_actions(table.cells_at(state), 5)
    ]

    assert len(landings) == pairs.size == 1500
    assert np.bincount(landings).tolist() == [12] * 125
    assert table.size == 125


def test_entry_of_a_landing_is_the_same_from_everywhere() -> None:
    table = LandingTable(3, 5)
    entries: dict[int, set[tuple[int, int]]] = {}
    for state in range(table.states):
        for column in range(table.actions):
            entry = table.entry(state, column)
            entries.setdefault(table.landing(state, column), set()).add(entry)
            assert table.entry(*entry) == entry

    assert all(len(names) == 1 for names in entries.values())


def test_values_and_visits_of_a_state_are_those_of_its_landings() -> None:
    table, chance = LandingTable(2, 3), np.random.default_rng(0)
    for state in range(table.states):
        column = table.column(Action(0, table.cells_at(state)[0]))
        table.set_value(state, column, chance.normal())
        for _ in range(int(chance.integers(4))):
            table.count_visit(state, column)
    stored = {landing: (value, count) for landing, value, count in table.rows()}
    values, visits = table.values((1, 2)), table.visits((1, 2))

    for group, cell in np.ndindex(2, 3):
        landing: Cells = (cell, 2) if group == 0 else (1, cell)
        if landing == (1, 2):
            assert np.isnan([values[group, cell], visits[group, cell]]).all()
        else:
            value, count = stored[landing]
            assert (value, count) == (float(values[group, cell]), int(visits[group, cell]))
    assert table.best(table.index((1, 2))) == np.nanmax(values)


def filled() -> LandingTable:
    table = LandingTable(3, 5)
    table.set_value(7, table.column(Action(0, 3)), -0.25)
    table.count_visit(7, table.column(Action(0, 3)))
    table.count_visit(124, table.column(Action(2, 0)))
    return table


def test_dump_has_what_was_visited_or_has_a_value_and_is_loaded_again() -> None:
    table, copy = filled(), LandingTable(3, 5)
    copy.set_value(3, 4, 1.0)
    copy.load(table.dump())

    assert table.dump()["landings"].tolist() == [82, 120]
    assert list(copy.rows()) == list(table.rows())
    assert copy.sha256() == table.sha256() != LandingTable(3, 5).sha256()


def test_rows_are_read_in_chunks() -> None:
    arrays = filled().dump()
    places, values, visits = (arrays[name] for name in ("landings", "values", "visits"))
    chunks = [(places[n : n + 1], values[n : n + 1], visits[n : n + 1]) for n in range(2)]

    assert list(LandingRows(3, 5, lambda: iter(chunks)).rows()) == list(filled().rows())
    with pytest.raises(TableMismatch, match="rising order"):
        list(LandingRows(3, 5, lambda: iter(chunks[::-1])).rows())


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"visits": None}, "it lacks visits"),
        ({"shape": np.array([2, 5])}, r"are \[2, 5\], this problem's \[3, 5\]"),
        ({"values": np.array([np.inf, 0.0])}, "do not fit together"),
        ({"values": np.array([0.5])}, "do not fit together"),
        ({"landings": np.array([7, 125])}, "landings that do not exist"),
        ({"landings": np.array([9, 9])}, "rising order"),
    ],
)
def test_inconsistent_arrays_are_refused(changed: Mapping[str, Any], message: str) -> None:
    arrays = {**filled().dump(), **changed}
    arrays = {name: array for name, array in arrays.items() if array is not None}

    with pytest.raises(TableMismatch, match=message):
        check_landing_arrays(arrays, 3, 5)


def test_a_table_that_would_be_too_large_is_refused() -> None:
    with pytest.raises(InvalidInput, match="17 cells have 24,137,569 landings"):
        LandingTable(6, 17)
    assert LandingTable(6, 10).size < MAX_LANDINGS
