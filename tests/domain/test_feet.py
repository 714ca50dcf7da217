"""The kinematic law of a step, against values computed by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.domain.feet import Feet, Reach, StepLaw
from hexapods.domain.gait import GaitSpec, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import Robot
from hexapods.domain.types import Action

FRONT_RIGHT = Action(1, 2)
GRID = FootGrid(side_m=0.04)


def law(gait: str | GaitSpec = "left-right-origin", reach: Reach | None = None) -> StepLaw:
    return StepLaw(resolve(gait, Robot().azimuths_deg), GRID, reach)


def test_the_first_pair_to_the_front_moves_the_body_by_a_third_of_h() -> None:
    landed, after, advance = law().step(law().at_home(), FRONT_RIGHT)

    assert landed.forward_m == (0.0, 0.02, 0.0)
    assert advance == pytest.approx(0.02 / 3)
    assert after.commanded == (0, 2, 0)
    assert after.lateral_m == (0.0, 0.02, 0.0)
    assert after.forward_m == pytest.approx((-0.02 / 3, 0.04 / 3, -0.02 / 3))


def test_pairs_stepping_to_the_front_in_turn_settle_at_half_of_h_per_step() -> None:
    pairs, advance = law(), 0.0
    feet = pairs.at_home()
    for step in range(60):
        _, feet, advance = pairs.step(feet, Action(step % 3, 2))

    assert advance == pytest.approx(0.02 / 2)


@pytest.mark.parametrize(
    ("gait", "advances_h"),
    [
        ("tripod", 2 / 3),
        ("bound", 9 / 14),
        ("one-by-one", 2 / 7),
        (GaitSpec(1, 2, groups=((1, 2, 3), (4, 5), (6,))), 2 / (3 * (1 + 14 / 36))),
    ],
)
def test_groups_taking_turns_advance_by_their_shares_of_the_feet(
    gait: str | GaitSpec, advances_h: float
) -> None:
    """2 h / (G (1 + Σ w²)) a step, w the shares; 2 h / (G + 1) for G groups of one size."""
    groups, advances = law(gait), []
    count, feet = len(groups.at_home().commanded), groups.at_home()
    for step in range(60 * count):
        _, feet, advance = groups.step(feet, Action(step % count, 2))
        advances.append(advance)

    assert sum(advances[-count:]) / count == pytest.approx(0.02 * advances_h)
    assert feet.mean_m(groups.sizes) == pytest.approx(0, abs=1e-12)


def test_an_action_that_leads_a_foot_out_of_reach_is_not_legal() -> None:
    """The pair in front would be farther ahead of home once the second has gone back."""
    reach = Reach((-0.023,) * 3, (0.023,) * 3)
    limited, back, front = law(reach=reach), Action(1, 4), Action(1, 2)
    start = Feet((1, 0, 0), (-0.02, 0.0, 0.0), (0.019, -0.0095, -0.0095))

    assert limited.possible(start, [back, front]) == [back, front]
    further = Feet((1, 0, 0), (-0.02, 0.0, 0.0), (0.021, -0.0105, -0.0105))
    assert limited.possible(further, [back, front]) == [front]


def test_where_no_action_is_within_reach_the_body_moves_as_far_as_feet_allow() -> None:
    limited = law(reach=Reach((-0.023,) * 3, (0.023,) * 3))
    start, back = Feet((1, 0, 0), (-0.02, 0.0, 0.0), (0.021, 0.0, -0.021)), Action(1, 4)

    assert limited.possible(start, [back]) == [back]
    _, after, advance = limited.step(start, back)
    assert advance == pytest.approx(-0.002)
    assert after.forward_m == pytest.approx((0.023, -0.018, -0.019))


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 4)), max_size=60))
def test_offsets_sum_to_zero_and_stay_bounded(steps: list[tuple[int, int]]) -> None:
    """With three pairs an offset stays within twice the half side; `check_reach` relies on it."""
    pairs = law()
    feet = pairs.at_home()
    for pair, cell in steps:
        _, feet, _ = pairs.step(feet, Action(pair, cell))

    assert sum(feet.forward_m) == pytest.approx(0, abs=1e-12)
    assert all(abs(y) < 2 * 0.02 for y in feet.forward_m)


def test_feet_round_trip_through_an_array() -> None:
    feet = Feet.at_home(4).landed(3, 4, (0.02, -0.02)).shifted(-0.005)

    assert feet.as_array().shape == (3, 4)
    assert Feet.from_array(feet.as_array()) == feet
