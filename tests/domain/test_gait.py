"""The paper's gaits, and gaits specified by the user."""

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import (
    PAPER_GAITS,
    GaitSpec,
    Pair,
    Symmetry,
    gait_as_json,
    read_gait,
    resolve,
)
from hexapods.domain.robot import ring

LEFT_RIGHT = (-30, 30, 90, 150, -150, -90)
FRONT_BACK = (-60, 0, 60, 120, 180, -120)


def azimuths(legs: int) -> list[float]:
    return [leg.azimuth_deg for leg in ring(legs)]


@pytest.mark.parametrize(
    ("name", "forward_deg", "azimuths_deg", "pairs"),
    [
        ("left-right-origin", 30, LEFT_RIGHT, ((1, 4), (2, 5), (3, 6))),
        ("left-right-vertical", 30, LEFT_RIGHT, ((1, 2), (6, 3), (5, 4))),
        ("front-back-origin", 60, FRONT_BACK, ((1, 4), (2, 5), (3, 6))),
        ("front-back-vertical", 60, FRONT_BACK, ((1, 3), (6, 4), (2, 5))),
    ],
)
def test_the_four_gaits_of_a_hexapod(
    name: str, forward_deg: float, azimuths_deg: tuple[float, ...], pairs: tuple[Pair, ...]
) -> None:
    gait = resolve(name, azimuths(6))

    assert gait.name == name
    assert gait.forward_deg == forward_deg
    assert gait.azimuths_deg == azimuths_deg
    assert gait.groups == pairs


@pytest.mark.parametrize(
    ("legs", "name", "pairs"),
    [
        (4, "left-right-origin", ((1, 3), (2, 4))),
        (4, "left-right-vertical", ((1, 2), (4, 3))),
        (4, "front-back-origin", ((1, 3), (2, 4))),
        (4, "front-back-vertical", ((1, 3), (2, 4))),
        (8, "left-right-origin", ((1, 5), (2, 6), (3, 7), (4, 8))),
        (8, "left-right-vertical", ((1, 2), (8, 3), (7, 4), (6, 5))),
        (8, "front-back-origin", ((1, 5), (2, 6), (3, 7), (4, 8))),
        (8, "front-back-vertical", ((1, 3), (8, 4), (7, 5), (2, 6))),
        (10, "left-right-origin", ((1, 6), (2, 7), (3, 8), (4, 9), (5, 10))),
        (10, "left-right-vertical", ((1, 2), (10, 3), (9, 4), (8, 5), (7, 6))),
        (10, "front-back-origin", ((1, 6), (2, 7), (3, 8), (4, 9), (5, 10))),
        (10, "front-back-vertical", ((1, 3), (10, 4), (9, 5), (8, 6), (2, 7))),
    ],
)
def test_other_numbers_of_legs_are_paired_by_the_same_rule(
    legs: int, name: str, pairs: tuple[Pair, ...]
) -> None:
    assert resolve(name, azimuths(legs)).groups == pairs


@given(
    legs=st.sampled_from([4, 6, 8, 10, 12]),
    right=st.integers(1, 12),
    between=st.integers(1, 2),
    symmetry=st.sampled_from(["origin", "vertical"]),
)
def test_pairs_are_symmetric_for_every_forward_direction(
    legs: int, right: int, between: int, symmetry: Symmetry
) -> None:
    right = 1 + right % legs
    left = 1 + (right - 1 + between) % legs
    gait = resolve(GaitSpec(right, left, symmetry), azimuths(legs))

    assert sorted(leg for pair in gait.groups for leg in pair) == list(range(1, legs + 1))
    for leader, partner in gait.groups:
        a, b = gait.azimuths_deg[leader - 1], gait.azimuths_deg[partner - 1]
        on_axis = {a, b} == {0, 180}
        mirrored = a + 180 if symmetry == "origin" or on_axis else -a
        assert (b - mirrored) % 360 == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(
    ("right", "left", "forward_deg"), [(1, 2, 30), (6, 1, -30), (2, 1, -150), (4, 6, -120)]
)
def test_forward_bisects_the_anticlockwise_arc_from_right_to_left(
    right: int, left: int, forward_deg: float
) -> None:
    assert resolve(GaitSpec(right, left, "origin"), azimuths(6)).forward_deg == forward_deg


def test_legs_need_not_stand_in_a_regular_ring() -> None:
    gait = resolve("left-right-vertical", [-40, 40, 85, 150, -150, -85])

    assert list(gait.azimuths_deg) == [-40, 40, 85, 150, -150, -85]
    assert gait.groups == ((1, 2), (6, 3), (5, 4))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("left-right-vertical", "leg 5 has no partner under vertical symmetry.*by hand"),
        ("left-right-origin", "leg 1 has no partner under origin symmetry.*-140° from forward"),
    ],
)
def test_a_leg_without_a_mirror_image_is_named(name: str, message: str) -> None:
    lopsided = [-40, 40, 90, 150, -145, -90]
    if name.endswith("origin"):
        lopsided[0], lopsided[1] = 40, -40
    spec = PAPER_GAITS[name]
    with pytest.raises(InvalidInput, match=message):
        resolve(GaitSpec(*((2, 1) if lopsided[0] > 0 else (1, 2)), spec.symmetry), lopsided)


def test_a_leg_alone_on_the_axis_is_a_group_and_does_not_move_sideways() -> None:
    gait = resolve("left-right-vertical", azimuths(5))

    assert list(gait.azimuths_deg) == [-36, 36, 108, 180, -108]
    assert gait.groups == ((1, 2), (5, 3), (4,))
    assert gait.mirror == (1, -1, -1, 0, 1)


@pytest.mark.parametrize(
    ("name", "legs", "groups"),
    [
        ("tripod", 6, ((1, 3, 5), (2, 4, 6))),
        ("tetrapod", 6, ((1, 3), (2, 5), (4, 6))),
        ("tetrapod", 8, ((1, 3, 5, 7), (2, 4, 6, 8))),
        ("trot", 4, ((1, 3), (2, 4))),
        ("trot", 12, ((1, 3, 5, 7, 9, 11), (2, 4, 6, 8, 10, 12))),
        ("pace", 6, ((1, 5, 6), (2, 3, 4))),
        ("bound", 4, ((1, 2), (3, 4))),
        ("bound", 6, ((1, 2), (3, 4, 5, 6))),
        ("bound", 5, ((1, 2), (3, 4, 5))),
        ("one-by-one", 3, ((1,), (2,), (3,))),
    ],
)
def test_named_groupings_fit_the_legs(
    name: str, legs: int, groups: tuple[tuple[int, ...], ...]
) -> None:
    assert resolve(name, azimuths(legs)).groups == groups


@pytest.mark.parametrize(
    ("name", "legs", "why"),
    [
        ("tripod", 8, "it needs six legs, this robot has 8"),
        ("tetrapod", 4, "it needs eight legs, or three on each side"),
        ("trot", 5, "an odd number, 5"),
        ("pace", 5, "leg 4 stands on the axis, on neither side"),
    ],
)
def test_a_grouping_that_makes_no_sense_says_why(name: str, legs: int, why: str) -> None:
    with pytest.raises(InvalidInput, match=f"{name} makes no sense .*{why}; give the groups by"):
        resolve(name, azimuths(legs))


def test_a_grouping_may_have_another_forward_direction() -> None:
    gait = resolve(GaitSpec(1, 3, groups="tripod"), azimuths(6))

    assert gait.name == "right 1, left 3, tripod"
    assert gait.groups == ((1, 3, 5), (2, 4, 6))
    assert gait.mirror == (1, 0, -1, -1, 0, 1)


def test_groups_are_mirrored_by_the_side_on_which_each_leg_stands() -> None:
    gait = resolve(GaitSpec(1, 2, groups=((1, 2, 3), (6,), (4, 5))), azimuths(6))

    assert gait.name == "right 1, left 2, 1+2+3 6 4+5"
    assert gait.sizes == (3, 1, 2)
    assert gait.mirror == (1, -1, -1, -1, 1, 1)
    assert gait.group_of_leg == (0, 0, 0, 2, 2, 1)


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        (((1, 2, 3), (4, 5)), "leave out leg 6; each leg belongs to one group"),
        (((1, 2, 3), (3, 4, 5, 6)), "leg 3 is used 2 times in the groups"),
        (((1, 2, 3, 4, 5, 6),), "two groups of legs or more"),
        (((1, 2, 3, 4, 5, 6), ()), "two groups of legs or more"),
        (((1, 2, 3), (4, 5, 6, 7)), "no leg 7"),
    ],
)
def test_groups_have_each_leg_once(groups: Any, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        resolve(GaitSpec(1, 2, groups=groups), azimuths(6))


def test_the_offset_of_a_group_is_the_mean_of_its_feet() -> None:
    """A foot on the axis tells nothing of x; where all stand there, x is the planned one."""
    gait = resolve(GaitSpec(1, 3, groups=((1, 2), (3, 4), (5,), (6,))), azimuths(6))
    feet = [(0.01, 0.02), (0.5, 0.04), (-0.02, 0.0), (-0.04, 0.0), (0.7, 0.03), (0.0, 0.0)]

    offsets = gait.by_group(feet, lateral_m=(0.0, 0.0, -0.02, 0.0))

    expected = [(0.01, 0.03), (0.03, 0.0), (-0.02, 0.03), (0.0, 0.0)]
    assert np.allclose(offsets, expected)


def test_explicit_pairs_are_used() -> None:
    pairs = ((1, 6), (2, 3), (4, 5))
    gait = resolve(GaitSpec(1, 2, pairs=pairs), azimuths(6))

    assert gait.groups == pairs
    assert list(gait.azimuths_deg) == list(LEFT_RIGHT)
    assert gait.name == "right 1, left 2, 1+6 2+3 4+5"


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        (((1, 4), (2, 5)), "leave out leg 3"),
        (((1, 4), (2, 5), (3, 2)), "leg 2 is used 2 times"),
        (((1, 4), (2, 5), (3, 3)), "leg 3 is used 2 times"),
        (((1, 4), (2, 5), (3, 7)), "no leg 7; this robot has legs 1 to 6"),
        (((1, 4), (2, 5), (3, 0)), "no leg 0"),
        ((), "two groups of legs or more"),
    ],
)
def test_an_invalid_pairing_names_the_leg(pairs: tuple[Pair, ...], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        resolve(GaitSpec(1, 2, pairs=pairs), azimuths(6))


def test_the_specification_of_a_named_gait_resolves_to_that_gait() -> None:
    for name, spec in PAPER_GAITS.items():
        assert resolve(spec, azimuths(6)) == resolve(name, azimuths(6))


def test_a_users_gait_is_named_by_its_specification() -> None:
    assert resolve(GaitSpec(6, 1, "origin"), azimuths(6)).name == "right 6, left 1, origin"


def test_an_unknown_gait_names_the_valid_ones() -> None:
    with pytest.raises(UnknownName, match=r"unknown gait 'canter'.*left-right-origin.*back-vertic"):
        resolve("canter", azimuths(6))
    with pytest.raises(UnknownName, match=r"unknown grouping 'canter'.*tripod"):
        GaitSpec(1, 2, groups="canter")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("right", "left", "message"),
    [(1, 1, "both 1; name two legs"), (0, 2, "no leg 0"), (1, 7, "no leg 7.*1 to 6")],
)
def test_right_and_left_must_be_two_existing_legs(right: int, left: int, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        resolve(GaitSpec(right, left, "origin"), azimuths(6))


def test_a_specification_has_a_symmetry_pairs_or_groups() -> None:
    with pytest.raises(InvalidInput, match=r"one of symmetry .* pairs, and groups"):
        GaitSpec(1, 2)
    with pytest.raises(InvalidInput, match=r"one of symmetry .* pairs, and groups"):
        GaitSpec(1, 2, "origin", ((1, 4), (2, 5), (3, 6)))
    with pytest.raises(UnknownName, match=r"diagonal.*origin, vertical"):
        GaitSpec(1, 2, "diagonal")  # type: ignore[arg-type]


@pytest.mark.parametrize("leg", [1.0, "1", None, True, [1]])
def test_a_leg_is_a_whole_number(leg: Any) -> None:
    for legs in ((leg, 2, "origin"), (1, leg, "origin"), (1, 2, None, ((leg, 4), (2, 5), (3, 6)))):
        with pytest.raises(InvalidInput, match="number of a leg, a whole number from 1, not"):
            GaitSpec(*legs)


@pytest.mark.parametrize("pairs", [3, "14", [1, 4], [[1, 4, 2]]])
def test_pairs_are_pairs(pairs: Any) -> None:
    with pytest.raises(InvalidInput, match=r"must look like \[\[1, 4\], "):
        GaitSpec(1, 2, pairs=pairs)


def test_numbers_of_legs_may_be_those_of_numpy_and_pairs_lists() -> None:
    pairs: Any = np.array([[1, 4], [2, 5], [3, 6]])
    leg: Any = np.int64(1)
    gait = GaitSpec(leg, 2, pairs=pairs)
    assert gait == GaitSpec(1, 2, pairs=((1, 4), (2, 5), (3, 6)))
    assert type(gait.right_leg) is int


@pytest.mark.parametrize("groups", [3, [1, 4]])
def test_groups_are_lists_of_legs(groups: Any) -> None:
    with pytest.raises(InvalidInput, match=r"must look like \[\[1, 3, 5\], "):
        GaitSpec(1, 2, groups=groups)


@pytest.mark.parametrize("groups", ["tripod", [[1, 3, 5], [2, 4, 6]]])
def test_groups_round_trip_through_json(groups: Any) -> None:
    written = {"right_leg": 1, "left_leg": 2, "groups": groups}
    read = read_gait(written)

    assert json.loads(json.dumps(gait_as_json(read))) == written
    assert read_gait(json.loads(json.dumps(gait_as_json(read)))) == read
