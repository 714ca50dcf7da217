"""Worlds: which disturbances hold in a step, and which contradict each other."""

import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hexapods.domain.disturbance_documents import as_text, parse_disturbance
from hexapods.domain.disturbances import (
    KINDS,
    Friction,
    Limp,
    Lost,
    Patch,
    Push,
    Repair,
    Rough,
    SensorNoise,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.robot import Robot, robot
from hexapods.domain.world import (
    MAX_IN_A_RUN,
    UNDISTURBED,
    WORLDS,
    World,
    check_ends,
    named_world,
    parse_world,
    world,
)

CASES = json.loads((Path(__file__).parents[1] / "cases" / "conditions.json").read_text("utf-8"))
"""What holds in a step; the page's test of its disturbances reads them too."""

EXAMPLES = {
    "limp": "limp:legs=1,2",
    "stuck": "stuck:leg=2:joint=femur:angle_rad=-0.9",
    "lost": "lost:legs=2",
    "weak": "weak:legs=2:torque_share=0.5",
    "repair": "repair:legs=2",
    "slope": "slope:degrees=8",
    "rough": "rough:amplitude_m=0.01",
    "friction": "friction:value=0.1",
    "patch": "patch:from_m=0.1:to_m=0.2:friction=0.05",
    "payload": "payload:kg=1",
    "push": "push:impulse_ns=2",
    "sensor-noise": "sensor-noise:sd_m=0.004",
    "delay": "delay:seconds=0.02",
    "dead-band": "dead-band:radians=0.05",
}
HELD = {"leg": 2, "joint": "femur", "angle_rad": -0.9}


def test_the_conditions_of_a_step_hold_from_the_start() -> None:
    steep, limp = Slope(degrees=8, until_step=30), Limp(legs=(1, 4), at_step=10)
    disturbed = World((steep, limp))

    assert disturbed.change_steps == (10, 30)
    assert disturbed.as_of(0) == disturbed.as_of(9) == World((Slope(degrees=8),))
    slope_and_limp = {Slope(degrees=8), Limp(legs=(1,)), Limp(legs=(4,))}
    assert (
        set(disturbed.as_of(10).disturbances)
        == set(disturbed.as_of(29).disturbances)
        == slope_and_limp
    )
    assert set(disturbed.as_of(30).disturbances) == {Limp(legs=(1,)), Limp(legs=(4,))}
    assert disturbed.as_of(10).as_of(99) == disturbed.as_of(10)


def test_equal_conditions_are_equal_however_they_came_about() -> None:
    early = World((Limp(legs=(1, 4)), Slope(degrees=8)))
    late = World((Slope(degrees=8, at_step=3), Limp(legs=(4,), at_step=5), Limp(legs=(1,))))

    assert early.as_of(0) == late.as_of(5)
    assert hash(early.as_of(0)) == hash(late.as_of(5))


def test_a_later_one_replaces_an_earlier_one_of_the_same_thing() -> None:
    disturbed = World(
        (
            Limp(legs=(1, 4)),
            Weak(legs=(4,), torque_share=0.5, at_step=5),
            Friction(value=0.1),
            Friction(value=0.5, at_step=5, until_step=8),
            Repair(legs=(1, 4), at_step=10),
        )
    )

    assert set(disturbed.as_of(5).disturbances) == {
        Limp(legs=(1,)),
        Weak(legs=(4,), torque_share=0.5),
        Friction(value=0.5),
    }
    assert Friction(value=0.1) in disturbed.as_of(8).disturbances
    assert disturbed.as_of(10) == World((Friction(value=0.1),))


def test_a_repaired_leg_has_no_stuck_joint() -> None:
    disturbed = World((Stuck(**HELD), Repair(legs=(2,), at_step=1)))  # type: ignore[arg-type]

    assert disturbed.as_of(0) == World((Stuck(**HELD),))  # type: ignore[arg-type]
    assert disturbed.as_of(1) == UNDISTURBED


def test_a_push_is_in_one_step_and_not_among_the_conditions() -> None:
    disturbed = World((Push(impulse_ns=1, at_step=3), Push(impulse_ns=2, at_step=3)))
    one_by_one = UNDISTURBED
    for push in disturbed.disturbances:
        one_by_one = one_by_one.then(push)
    assert one_by_one == disturbed

    assert disturbed.as_of(3) == UNDISTURBED
    assert [push.impulse_ns for push in disturbed.pushes_at(3)] == [1, 2]
    assert disturbed.pushes_at(2) == disturbed.pushes_at(4) == ()


@pytest.mark.parametrize(
    ("earlier", "later"),
    [
        (Slope(degrees=1), Slope(degrees=2)),
        (Limp(legs=(1, 2)), Lost(legs=(2, 3))),
        (Lost(legs=(2,)), Limp(legs=(2,), at_step=9)),
        (Lost(legs=(2,)), Stuck(**HELD, at_step=9)),  # type: ignore[arg-type]
        (Limp(legs=(2,), at_step=9), Repair(legs=(2,), at_step=9)),
        (Patch(from_m=0, to_m=1, friction=0.1), Patch(from_m=0.5, to_m=2, friction=1)),
        (Patch(from_m=0, to_m=1, friction=0.1), Rough(amplitude_m=0.01, at_step=5)),
    ],
)
def test_contradictions_are_refused(earlier: object, later: object) -> None:
    for pair in ((earlier, later), (later, earlier)):
        with pytest.raises(InvalidInput, match="contradict"):
            World(pair)  # type: ignore[arg-type]


def test_what_was_repaired_contradicts_nothing() -> None:
    lost, repaired = Lost(legs=(2,)), Repair(legs=(2,), at_step=3)
    assert World((lost, repaired, Stuck(**HELD, at_step=5)))  # type: ignore[arg-type]
    flat = Rough(amplitude_m=0, at_step=3)
    assert World((Rough(amplitude_m=0.01), flat, Patch(from_m=0, to_m=1, friction=1, at_step=4)))


def test_power_and_joints_of_a_leg_are_different_things() -> None:
    stuck = Stuck(**HELD)  # type: ignore[arg-type]
    for power in (Limp(legs=(2,), at_step=5), Weak(legs=(2,), torque_share=0.5, at_step=5)):
        assert stuck in World((stuck, power)).as_of(5).disturbances
        assert len(World((stuck, power)).as_of(5).disturbances) == 2
        assert World((power, replace(stuck, at_step=5))).as_of(5) == World((stuck, power)).as_of(5)
        assert World((stuck, power, Repair(legs=(2,), at_step=9))).as_of(9) == UNDISTURBED


@pytest.mark.parametrize("earlier_kind", KINDS)
@pytest.mark.parametrize("later_kind", KINDS)
def test_every_accepted_pair_of_disturbances_has_conditions(
    earlier_kind: str, later_kind: str
) -> None:
    """Every ordered pair of kinds is refused as it is made, or has conditions at any step."""
    first = parse_disturbance(EXAMPLES[earlier_kind])
    second = replace(parse_disturbance(EXAMPLES[later_kind]), at_step=4)
    with suppress(InvalidInput):
        combined = World((first, second))
        assert all(combined.as_of(step).as_of(0) == combined.as_of(step) for step in (0, 3, 4, 9))


def test_a_disturbance_that_has_ended_contradicts_no_other() -> None:
    assert World((Lost(legs=(2,), until_step=9), Limp(legs=(2,), at_step=9)))
    assert World((Slope(degrees=1, until_step=9), Slope(degrees=2, at_step=9)))


def test_a_run_refuses_what_it_cannot_show() -> None:
    with pytest.raises(InvalidInput, match="kinematic simulator knows no slope, only sensor-noise"):
        named_world("slope").check(Robot(), "kinematic")
    named_world("noise").check(Robot(), "kinematic")
    late = World((Limp(legs=(1,), at_step=50),))
    with pytest.raises(InvalidInput, match="at_step must be from 0 to 49, the last step"):
        late.check(Robot(), "mujoco", steps=50)
    late.check(Robot(), "mujoco", steps=51)
    many = World(tuple(SensorNoise(sd_m=0.001, at_step=i) for i in range(MAX_IN_A_RUN + 1)))
    with pytest.raises(InvalidInput, match="at most 200 disturbances, not 201"):
        many.check(Robot(), "mujoco")


def test_a_request_refuses_what_would_end_after_the_run() -> None:
    """Stored runs may have it: it was accepted once, and means the same as no end."""
    lasting = (Limp(legs=(1,)), Slope(degrees=1, until_step=50))
    check_ends(lasting, 50)
    with pytest.raises(InvalidInput, match="slope: until_step must be at most 49, the end of this"):
        check_ends(lasting, 49)
    World(lasting).check(Robot(), "mujoco", 49)


def test_named_worlds_suit_the_robot() -> None:
    for choice in WORLDS.values():
        assert choice.title
        assert choice.help.endswith(".")
        for legs in (4, 6, 8, 12):
            choice.world.check(robot({"n_legs": legs}), "mujoco")
    assert named_world("flat") == UNDISTURBED
    with pytest.raises(UnknownName, match="unknown world 'moon'; choose one of: flat, slope"):
        named_world("moon")
    assert world([{"kind": "limp", "legs": [1, 4]}]) == named_world("limp-pair")


def test_world_is_parsed_from_a_name_or_from_what_happens() -> None:
    assert parse_world("limp-pair") == named_world("limp-pair") == parse_world("limp:legs=1,4")
    assert parse_world("slope:degrees=4+payload:kg=1") == world(
        [{"kind": "slope", "degrees": 4.0}, {"kind": "payload", "kg": 1.0}]
    )
    with pytest.raises(UnknownName, match="limp-pair"):
        parse_world("moon")


def test_later_world_begins_and_ends_later() -> None:
    early = parse_world("limp:legs=1:at=3:until=5+slope:degrees=4")
    assert early.later(10) == parse_world("limp:legs=1:at=13:until=15+slope:degrees=4:at=10")
    assert early.later(10).as_of(9) == UNDISTURBED


@pytest.mark.parametrize("value", ["ice", ("ice",), 3, Limp(legs=(1,))])
def test_a_world_is_made_of_disturbances(value: Any) -> None:
    with pytest.raises(InvalidInput, match="made of disturbances, as World"):
        World(value)
    assert World([Limp(legs=(1,))]) == World((Limp(legs=(1,)),))


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['happens']} in {case['step']}")
def test_what_holds_in_a_step_is_what_the_page_says(case: dict[str, Any]) -> None:
    now = World(tuple(map(parse_disturbance, case["happens"]))).as_of(case["step"])
    effects = [
        effect for disturbance in now.disturbances for effect in disturbance.parts().values()
    ]
    expected = [as_text(parse_disturbance(text)) for text in case["holds"]]
    assert sorted(map(as_text, effects)) == sorted(expected)
