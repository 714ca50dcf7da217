"""The kinematic law of a step, against values computed by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.domain.feet import Feet

FRONT_RIGHT = (0.02, 0.02)


def test_the_first_pair_to_the_front_moves_the_body_by_a_third_of_h() -> None:
    landed = Feet.at_home(3).landed(1, 2, FRONT_RIGHT)
    assert landed.forward_m == (0.0, 0.02, 0.0)

    after, advance = landed.centred()

    assert advance == pytest.approx(0.02 / 3)
    assert after.commanded == (0, 2, 0)
    assert after.lateral_m == (0.0, 0.02, 0.0)
    assert after.forward_m == pytest.approx((-0.02 / 3, 0.04 / 3, -0.02 / 3))


def test_pairs_stepping_to_the_front_in_turn_settle_at_half_of_h_per_step() -> None:
    feet, advance = Feet.at_home(3), 0.0
    for step in range(60):
        feet, advance = feet.landed(step % 3, 2, FRONT_RIGHT).centred()

    assert advance == pytest.approx(0.02 / 2)


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 4)), max_size=60))
def test_offsets_sum_to_zero_and_stay_bounded(steps: list[tuple[int, int]]) -> None:
    """With three pairs an offset stays within twice the half side; `check_reach` relies on it."""
    places = [(0.0, 0.0), (-0.02, 0.02), (0.02, 0.02), (-0.02, -0.02), (0.02, -0.02)]
    feet = Feet.at_home(3)
    for pair, cell in steps:
        feet, _ = feet.landed(pair, cell, places[cell]).centred()

    assert sum(feet.forward_m) == pytest.approx(0, abs=1e-12)
    assert all(abs(y) < 2 * 0.02 for y in feet.forward_m)


def test_feet_round_trip_through_an_array() -> None:
    feet, _ = Feet.at_home(4).landed(3, 4, (0.02, -0.02)).centred()

    assert feet.as_array().shape == (3, 4)
    assert Feet.from_array(feet.as_array()) == feet
