"""Kinds of disturbances: their limits, their text on a command line, and their JSON."""

from dataclasses import fields

import pytest

from hexapods.domain.disturbance_documents import (
    as_mapping,
    as_text,
    disturbance_from,
    parse_disturbance,
)
from hexapods.domain.disturbances import KINDS, Disturbance, Limp, Slope, Stuck, is_nothing
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.robot import PRESETS, Robot

ONE_OF_EACH = (
    "limp:legs=1,4:at=25",
    "stuck:leg=2:joint=femur:angle_rad=-0.9",
    "lost:legs=2",
    "weak:legs=1,2,3:torque_share=0.5:until=9",
    "repair:legs=1:at=30",
    "slope:degrees=8:direction_deg=90",
    "rough:amplitude_m=0.01:seed=3",
    "friction:value=0.1",
    "patch:from_m=0.1:to_m=0.2:friction=0.05",
    "payload:kg=1:x_m=0.08",
    "push:impulse_ns=2:direction_deg=-90:at=4",
    "sensor-noise:sd_m=0.004",
    "delay:seconds=0.02",
    "dead-band:radians=0.05",
)


def test_there_is_an_example_of_every_kind() -> None:
    assert [text.split(":")[0] for text in ONE_OF_EACH] == list(KINDS)


@pytest.mark.parametrize("text", ONE_OF_EACH)
def test_text_and_json_give_the_same_disturbance(text: str) -> None:
    parsed = parse_disturbance(text)

    assert disturbance_from(as_mapping(parsed)) == parsed
    assert parse_disturbance(as_text(parsed)) == parsed
    assert parsed.title
    assert parsed.help.endswith(".")
    parsed.check(Robot())


def test_fields_are_numbers_of_their_types() -> None:
    assert parse_disturbance("limp:legs=4,1:at=25") == Limp(legs=(1, 4), at_step=25)
    slope = disturbance_from({"kind": "slope", "degrees": 8})
    assert repr(slope) == repr(Slope(degrees=8.0, at_step=0, until_step=None))


@pytest.mark.parametrize(
    ("text", "robot", "expected"),
    [
        ("slope:degrees=0:direction_deg=90", "stiff", True),
        ("slope:degrees=1", "stiff", False),
        ("payload:kg=0:x_m=0.1", "stiff", True),
        ("weak:legs=1:torque_share=1", "stiff", True),
        ("friction:value=1", "stiff", True),
        ("friction:value=1", "slippery", False),
        ("friction:value=0.1", "slippery", True),
        ("patch:from_m=0:to_m=1:friction=1", "stiff", False),  # on ice it is something
        ("stuck:leg=1:joint=coxa:angle_rad=0", "stiff", False),
        ("repair:legs=1", "stiff", False),
    ],
)
def test_of_some_sizes_nothing_happens(text: str, robot: str, expected: bool) -> None:
    assert is_nothing(parse_disturbance(text), PRESETS[robot]) is expected


def test_every_declared_size_is_a_field() -> None:
    for kind in KINDS.values():
        names = {field.name for field in fields(kind)}
        assert kind.size is None or kind.size in names
        assert {*kind.ranges, *(spread.field for spread in kind.ranges.values())} <= names


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("fire", "choose one of: limp, stuck"),
        ("limp", "limp needs legs"),
        ("limp:legs=", "list of numbers of legs, such as 1,4"),
        ("limp:legs=1,1", "different numbers from 1 to 12"),
        ("limp:legs=13", "different numbers from 1 to 12"),
        ("limp:legs=1:legs=2", "give each field once"),
        ("limp:legs=1:at", "give each field once"),
        ("limp:kind=lost:legs=1", "give each field once"),
        (f"limp:legs={'9' * 5000}", "list of numbers of legs"),
        ("limp:legs=1:until=99999999", "until_step must be a whole number from 1 to 10,000,000"),
        ("limp:legs=1:at=-1", "at_step must be a whole number from 0 to 10,000,000"),
        ("limp:legs=1:at=9:until=9", "until_step must be over at_step, 9, not 9"),
        ("limp:legs=1:angle=9", "choose one of: at_step, until_step, legs"),
        ("slope:degrees=80", "degrees must be a number from 0 to 30"),
        ("slope:degrees=nan", "degrees must be a number from 0 to 30"),
        ("stuck:leg=2:joint=k/nee:angle_rad=0", "name of a joint, such as coxa, femur, tibia"),
        ("stuck:leg=2:joint=knee:angle_rad=8", "angle_rad must be a number from -7 to 7 rad"),
        ("patch:from_m=1:to_m=1:friction=1", "to_m must be over from_m, 1"),
        ("push:impulse_ns=1:until=3", "leave out until_step"),
        ("sensor-noise:sd_m=-0.001", "sd_m must be a number from 0 to 0.05 m"),
        ("delay:seconds=1", "seconds must be a number from 0 to 0.1 s"),
        ("weak:legs=1:torque_share=0", "torque_share must be a number over 0 and at most 1"),
    ],
)
def test_what_is_not_valid_is_refused_by_name(text: str, complaint: str) -> None:
    with pytest.raises(InvalidInput, match=complaint):
        parse_disturbance(text)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            "stuck:leg=2:joint=knee:angle_rad=0",
            "leg 2 has no joint knee; its joints are: coxa, femur, tibia",
        ),
        (
            "stuck:leg=2:joint=tibia:angle_rad=1",
            "the tibia of leg 2 turns from -2.8 to 0 rad, not to 1",
        ),
    ],
)
def test_a_joint_is_one_of_the_robot_and_turns_within_its_limits(text: str, complaint: str) -> None:
    with pytest.raises(InvalidInput, match=complaint):
        parse_disturbance(text).check(Robot())


@pytest.mark.parametrize("legs", ["1,4", 1, [], [True], [1.5], ["1"], None])
def test_legs_are_a_list_of_whole_numbers(legs: object) -> None:
    with pytest.raises(InvalidInput, match="list of numbers of legs"):
        disturbance_from({"kind": "limp", "legs": legs})


@pytest.mark.parametrize("mapping", [{}, {"kind": None}, {"kind": ["limp"]}, {"kind": "Limp"}])
def test_a_kind_is_needed(mapping: dict[str, object]) -> None:
    with pytest.raises(UnknownName, match="unknown kind of disturbance"):
        disturbance_from(mapping)


@pytest.mark.parametrize("disturbance", [Limp(legs=(7,)), Stuck(leg=7, joint="coxa", angle_rad=0)])
def test_a_leg_that_is_not_there_is_refused(disturbance: Disturbance) -> None:
    with pytest.raises(InvalidInput, match="there is no leg 7; this robot has legs 1 to 6"):
        disturbance.check(Robot())
