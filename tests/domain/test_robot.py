"""Robots: the default, the presets, and validation of user input."""

import math
from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from typing import Any

import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import PRESETS, LegMount, Robot, as_mapping, ring, robot


def test_the_default_robot_has_the_specified_parameters() -> None:
    figures = {
        "torso_radius_m": 0.10,
        "torso_half_height_m": 0.02,
        "torso_kg": 1.2,
        "coxa_m": 0.05,
        "femur_m": 0.08,
        "tibia_m": 0.13,
        "coxa_kg": 0.06,
        "femur_kg": 0.06,
        "tibia_kg": 0.03,
        "foot_radius_m": 0.012,
        "foot_kg": 0.01,
        "home_radius_m": 0.25,
        "body_height_m": 0.09,
        "step_height_m": 0.03,
        "swing_s": 0.2,
        "shift_s": 0.12,
        "servo_kp": 40,
        "servo_kv": 1,
        "servo_torque_nm": 1.5,
        "joint_armature": 0.002,
        "joint_damping": 0.05,
        "friction": 1,
        "dt_s": 0.004,
    }
    default = asdict(Robot())

    assert {name: default[name] for name in figures} == figures
    identity_fields = {"name", "legs", "id", "document", "torso_length_m", "torso_width_m"}
    assert set(default) == {*figures, *identity_fields}
    assert list(Robot().azimuths_deg) == [0, 60, 120, 180, 240, 300]
    assert (Robot().swing_substeps, Robot().shift_substeps) == (50, 30)
    assert Robot().step_s == pytest.approx(0.32)


def test_the_presets_of_the_paper_differ_in_servos_and_friction_only() -> None:
    def differences(name: str) -> dict[str, Any]:
        fields_of_preset, stiff = asdict(PRESETS[name]), asdict(Robot())
        return {k: v for k, v in fields_of_preset.items() if v != stiff[k] and k != "name"}

    assert list(PRESETS)[:3] == ["stiff", "compliant", "slippery"]
    assert differences("stiff") == {}
    assert differences("compliant") == {"servo_kp": 10, "servo_kv": 0.5}
    assert differences("slippery") == {"friction": 0.1}
    assert all(preset.name == name for name, preset in PRESETS.items())


def test_a_preset_is_found_by_name() -> None:
    assert robot("compliant") == PRESETS["compliant"]
    assert robot(PRESETS["slippery"]) is PRESETS["slippery"]


def test_a_mapping_overrides_fields_of_a_preset() -> None:
    tall = robot({"preset": "compliant", "body_height_m": 0.1, "friction": 1})

    assert tall.name == "compliant (modified)"
    assert (tall.body_height_m, tall.servo_kp) == (0.1, 10)
    assert robot({"femur_m": 0.08}) == Robot()


def test_n_legs_gives_a_regular_ring() -> None:
    octopod = robot({"n_legs": 8, "mount_radius_m": 0.12})

    assert octopod.legs == ring(8, 0.12)
    assert list(octopod.azimuths_deg) == [0, 45, 90, 135, 180, 225, 270, 315]
    assert robot({"mount_radius_m": 0.12}).legs == ring(6, 0.12)


def test_legs_can_be_listed_one_by_one() -> None:
    mounts = [{"azimuth_deg": a, "radius_m": 0.11} for a in (0, 90, 180)] + [{"azimuth_deg": 270}]

    assert robot({"legs": mounts}).legs == (
        LegMount(0, 0.11),
        LegMount(90, 0.11),
        LegMount(180, 0.11),
        LegMount(270, 0.10),
    )


@pytest.mark.parametrize(
    "written",
    [
        "stiff",
        "compliant",
        {"servo_kp": 5, "servo_kv": 0.3},
        {"preset": "slippery", "n_legs": 8},
        {"legs": [{"azimuth_deg": a, "radius_m": 0.09} for a in (5, 95, 185, 275)]},
        {"n_legs": 10, "mount_radius_m": 0.13, "tibia_m": 0.15, "dt_s": 0.002},
    ],
)
def test_a_robot_round_trips_through_its_mapping(written: str | Mapping[str, Any]) -> None:
    body = robot(written)

    assert robot(as_mapping(body)) == body
    assert as_mapping(robot(as_mapping(body))) == as_mapping(body)


def test_a_presets_mapping_is_its_name_alone() -> None:
    assert as_mapping(PRESETS["compliant"]) == {"preset": "compliant"}
    assert as_mapping(robot({"friction": 0.5})) == {"preset": "stiff", "friction": 0.5}


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("snake", "unknown robot 'snake'; choose one of: stiff, compliant, slippery"),
        ({"preset": "snake"}, "unknown robot 'snake'"),
        ({"preset": 3}, "unknown robot 3"),
        ({"wings": 2}, "unknown robot field 'wings'; choose one of: preset, id, n_legs,.*tibia_m"),
        ({"name": "x"}, "unknown robot field 'name'"),
        ({"femur_m": "long"}, "robot.femur_m must be a number, not 'long'"),
        ({"femur_m": True}, "robot.femur_m must be a number, not True"),
        ({"femur_m": None}, "robot.femur_m must be a number"),
        ({"femur_m": math.nan}, "robot.femur_m must be from 0.001 to 2, not nan"),
        ({"femur_m": math.inf}, "robot.femur_m must be from"),
        ({"femur_m": 0}, "robot.femur_m must be from"),
        ({"femur_m": 10**400}, "robot.femur_m must be from"),
        ({"dt_s": 0.008}, "robot.dt_s must be from 0.0005 to 0.005"),
        ({"swing_s": 5.1}, "robot.swing_s must be from 0.02 to 5"),
        ({"n_legs": 2}, "a robot has 3 to 12 legs, not 2"),
        ({"n_legs": 13}, "a robot has 3 to 12 legs, not 13"),
        ({"n_legs": 6.5}, "robot.n_legs must be a whole number"),
        ({"n_legs": True}, "robot.n_legs must be a whole number"),
        ({"n_legs": None}, "robot.n_legs must not be null"),
        ({"mount_radius_m": None}, "robot.mount_radius_m must not be null"),
        ({"mount_radius_m": -0.1}, "robot.mount_radius_m must be from 0 to 2"),
        ({"legs": 6}, "robot.legs must be a list of {azimuth_deg, radius_m}"),
        ({"legs": "six"}, "robot.legs must be a list"),
        ({"legs": [1, 2, 3, 4]}, "robot.legs must be a list of"),
        ({"legs": [{"azimuth_deg": 0, "length": 1}] * 4}, "robot.legs must be a list of"),
        ({"legs": [{"radius_m": 0.1}] * 4}, "robot.legs.azimuth_deg must be a number"),
        ({"legs": [{"azimuth_deg": 361}] * 4}, "robot.legs.azimuth_deg must be from -360 to 360"),
        ({"legs": [{"azimuth_deg": 0}] * 13}, "a robot has 3 to 12 legs, not 13"),
        ({"legs": [], "n_legs": 6}, "legs one by one, or n_legs and mount_radius_m"),
    ],
)
def test_an_invalid_robot_names_the_field_and_the_valid_values(
    written: str | Mapping[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        robot(written)


@pytest.mark.parametrize("name", [f.name for f in fields(Robot) if f.type in (float, "float")])
def test_every_quantity_must_be_positive_and_within_its_range(name: str) -> None:
    for value in (-1, 0, 1e12, math.nan):
        with pytest.raises(InvalidInput, match=f"robot.{name} must be"):
            robot({name: value})
    for value in (-1.0, 0.0, math.inf, math.nan):
        with pytest.raises(InvalidInput, match=f"robot.{name} must be"):
            replace(Robot(), **{name: value})  # type: ignore[arg-type]


def test_a_phase_lasts_at_least_two_substeps() -> None:
    with pytest.raises(InvalidInput, match=r"robot.shift_s must be from two substeps to 5 s"):
        Robot(shift_s=0.007)


def test_a_ring_may_have_an_odd_number_of_legs() -> None:
    assert [leg.azimuth_deg for leg in ring(5)] == [0, 72, 144, 216, 288]


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"femur_m": "x"}, "robot.femur_m must be a number, not 'x'"),
        ({"femur_m": True}, "robot.femur_m must be a number, not True"),
        ({"femur_m": -1}, "robot.femur_m must be positive"),
        ({"legs": 3}, "robot.legs must be a tuple of LegMount, not 3"),
    ],
)
def test_a_robot_is_built_of_numbers(values: Any, reason: str) -> None:
    with pytest.raises(InvalidInput, match=reason):
        Robot(**values)


def test_a_leg_may_be_placed_by_x_and_y_and_have_numbers_of_its_own() -> None:
    legs = [
        {"x_m": 0.05, "y_m": 0.1, "yaw_deg": 30, "foot_out_m": 0.12, "femur_m": 0.1},
        {"x_m": -0.05, "y_m": 0.1, "z_m": 0.01, "servo_torque_nm": 3},
        {"azimuth_deg": -90, "coxa_kg": 0.1},
    ]
    body = robot({"legs": legs, "tibia_m": 0.14})

    assert body.legs[0].radius_m == pytest.approx(math.hypot(0.05, 0.1))
    assert body.legs[0].azimuth_deg == pytest.approx(math.degrees(math.atan2(0.1, 0.05)))
    assert body.legs[0].direction_deg == 30
    assert body.legs[2].direction_deg == -90
    assert body.of_legs("femur_m") == (0.1, 0.08, 0.08)
    assert body.of_legs("tibia_m") == (0.14, 0.14, 0.14)
    assert body.of_legs("servo_torque_nm") == (1.5, 3, 1.5)
    assert body.feet_out_m[0] == 0.12
    assert body.feet_out_m[2] == pytest.approx(0.25 - 0.1)
    assert body.homes_m[2] == pytest.approx((0, -0.25))
    assert robot(as_mapping(body)) == body


@pytest.mark.parametrize(
    ("legs", "message"),
    [
        ({"x_m": 0.1}, "robot.legs.y_m must be a number, not None"),
        ({"x_m": 0.1, "y_m": 0.1, "azimuth_deg": 3}, "leg 3 has azimuth_deg and radius_m, or x_m"),
        ({"azimuth_deg": 240, "tibia_m": 3}, "robot.legs.tibia_m must be from 0.001 to 2, not 3"),
        ({"azimuth_deg": 240, "z_m": -1.1}, "robot.legs.z_m must be from -1 to 1"),
        ({"azimuth_deg": 240, "radius_m": 0.3}, "foot of leg 3 would be under its coxa joint"),
        ({"azimuth_deg": 120}, "the feet of legs 2 and 3 are in one place"),
    ],
)
def test_an_impossible_leg_is_named(legs: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        robot({"legs": [{"azimuth_deg": 0}, {"azimuth_deg": 120}, legs]})


def test_an_elongated_torso_has_length_and_width() -> None:
    long = robot({"torso_length_m": 0.3, "torso_width_m": 0.1})

    assert long.torso_half_sides_m == (0.05, 0.15)
    assert robot(as_mapping(long)) == long
    with pytest.raises(InvalidInput, match="torso_length_m and torso_width_m go together"):
        robot({"torso_length_m": 0.3})
