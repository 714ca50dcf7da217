"""The foot grid: its cells, their order, and the nearest cell to an offset."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.domain.errors import InvalidInput
from hexapods.domain.grid import MAX_DIVISIONS, MIN_DIVISIONS, FootGrid

every_division = pytest.mark.parametrize("divisions", range(MIN_DIVISIONS, MAX_DIVISIONS + 1))


@pytest.mark.parametrize(("divisions", "cells"), [(2, 5), (3, 9), (4, 17)])
def test_a_grid_with_even_divisions_has_home_as_an_additional_cell(
    divisions: int, cells: int
) -> None:
    assert len(FootGrid(divisions=divisions)) == cells


@every_division
def test_home_is_cell_0_and_cells_are_unique(divisions: int) -> None:
    grid = FootGrid(divisions=divisions)

    assert grid.places_m[0] == (0.0, 0.0)
    assert len(set(grid.places_m)) == len(grid.places_m) == len(grid)
    assert grid.cells.shape == (len(grid), 2)
    assert [tuple(cell) for cell in grid.cells.tolist()] == list(grid.places_m)


def test_two_divisions_are_home_and_the_corners() -> None:
    grid = FootGrid(side_m=0.04, divisions=2)

    assert grid.half_side_m == 0.02
    assert grid.places_m == ((0.0, 0.0), (-0.02, 0.02), (0.02, 0.02), (-0.02, -0.02), (0.02, -0.02))
    names = ["home", "front left", "front right", "back left", "back right"]
    assert [grid.name(cell) for cell in range(5)] == names


def test_cells_are_ordered_row_by_row_from_the_front() -> None:
    grid = FootGrid(side_m=0.04, divisions=3)

    assert grid.places_m[1:4] == ((-0.02, 0.02), (0, 0.02), (0.02, 0.02))
    assert grid.name(2) == "+0 mm right, +20 mm forward"


@every_division
def test_the_grid_is_closed_under_mirroring(divisions: int) -> None:
    grid = FootGrid(divisions=divisions)

    for cell, mirrored in enumerate(grid.mirror):
        x, y = grid.places_m[cell]
        assert grid.places_m[mirrored] == (-x, y)
        assert grid.mirror[mirrored] == cell


@every_division
def test_each_cell_is_nearest_to_itself(divisions: int) -> None:
    grid = FootGrid(divisions=divisions)

    assert [grid.nearest(x, y) for x, y in grid.places_m] == list(range(len(grid)))


@pytest.mark.parametrize(
    ("x", "y", "name"),
    [
        (0.5, 0.5, "home"),  # half way to a corner
        (1.0, 0.0, "home"),  # as far from home as from two corners
        (0.0, -1.0, "home"),
        (1.5, 0.0, "front right"),  # between two corners: the lower index
        (-1.5, 0.0, "front left"),
        (0.0, 1.5, "front left"),
        (0.0, -1.5, "back left"),
        (0.51, 0.5, "front right"),
        (-9.0, -9.0, "back left"),  # outside the square
    ],
)
def test_a_tie_goes_to_home_then_to_the_lower_index(x: float, y: float, name: str) -> None:
    grid = FootGrid(side_m=0.04)

    assert grid.name(grid.nearest(x * 0.02, y * 0.02)) == name


@given(st.floats(-1e-15, 1e-15), st.floats(-1e-15, 1e-15))
def test_a_tie_up_to_rounding_errors_is_a_tie(dx: float, dy: float) -> None:
    """Re-centring over three pairs gives multiples of 1/3, which floats cannot represent."""
    grid = FootGrid(side_m=0.04)

    assert grid.nearest(0.01 + dx, 0.01 + dy) == 0
    assert grid.nearest(0.03 + dx, dy) == 2


@given(
    divisions=st.integers(MIN_DIVISIONS, MAX_DIVISIONS),
    x=st.floats(-0.06, 0.06),
    y=st.floats(-0.06, 0.06),
)
def test_nearest_returns_the_cell_with_the_least_distance(
    divisions: int, x: float, y: float
) -> None:
    grid = FootGrid(divisions=divisions)
    distances = [math.dist((x, y), place) for place in grid.places_m]

    assert distances[grid.nearest(x, y)] <= min(distances) + 1e-6


@pytest.mark.parametrize("divisions", [1, 9, 0, -2, 2.5, math.nan])
def test_divisions_out_of_range_name_the_range(divisions: int) -> None:
    with pytest.raises(InvalidInput, match="divisions must be a whole number from 2 to 8"):
        FootGrid(divisions=divisions)


@pytest.mark.parametrize("side_m", [0, 0.0049, -1, 10.1, 1e308, math.nan, math.inf])
def test_a_side_out_of_range_names_the_range(side_m: float) -> None:
    with pytest.raises(InvalidInput, match=r"grid_side_m must be from 0\.005 to 10 m"):
        FootGrid(side_m=side_m)
