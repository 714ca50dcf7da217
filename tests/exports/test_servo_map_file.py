"""Servo maps in YAML: what they mean, and what is refused with which sentence."""

import math
import time
from pathlib import Path

import numpy as np
import pytest

from hexapods.domain.creatures import PRESETS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.exports.servo_map import BUILT_IN_MAPS, Servo, ServoMap
from hexapods.exports.servo_map_file import load_servo_map, read_servo_map
from tests.exports.servo_maps import JOINTS, map_text


def read(text: str) -> ServoMap:
    return read_servo_map(text.encode(), "mine.yaml", JOINTS)


def refused(text: str | bytes) -> str:
    content = text if isinstance(text, bytes) else text.encode()
    with pytest.raises(InvalidInput) as refusal:
        read_servo_map(content, "mine.yaml", JOINTS)
    return str(refusal.value)


def test_a_servo_has_its_pulse_at_zero_and_a_slope() -> None:
    servos = read(map_text()).servos
    assert [servo.joint for servo in servos] == JOINTS, "in the order of poses"
    coxa = servos[0]
    assert (coxa.board, coxa.channel, coxa.limits_us) == (0, 0, (500, 2500))
    assert coxa.pulses_us(np.array([-1.0, 0.0, 0.5])).tolist() == [1100, 1500, 1700]


def test_two_points_and_the_angle_that_they_call_zero_say_the_same() -> None:
    points = "board: 9, us_at_minus_45_deg: 1950, us_at_plus_45_deg: 1050"
    fields = {"leg1_coxa": "channel: 0", "leg1_tibia": "channel: 1, zero_deg: -90"}
    servos = read(map_text(**{joint: f"{{{points}, {rest}}}" for joint, rest in fields.items()}))
    coxa, tibia = servos.servos[0], servos.servos[2]
    quarter = math.radians(45)
    assert coxa.pulses_us(np.array([-quarter, 0.0, quarter])) == pytest.approx([1950, 1500, 1050])
    bent = np.array([-3 * quarter, -2 * quarter, -quarter])
    assert tibia.pulses_us(bent) == pytest.approx([1950, 1500, 1050])


def test_limits_and_speed_are_of_all_servos_or_of_one() -> None:
    place = "board: 9, channel: 0, us_at_zero: 1500, us_per_rad: 500"
    fields = f"{{{place}, limits_us: [600, 2400], speed_deg_s: 400}}"
    read_map = read(
        map_text("limits_us: [700, 2300]\nspeed_deg_s: 300\nspeed_share: 0.8", leg1_coxa=fields)
    )
    first, second, *_ = read_map.servos
    assert (first.limits_us, first.speed_deg_s) == ((600, 2400), 400)
    assert (second.limits_us, second.speed_deg_s) == ((700, 2300), 300)
    assert read_map.speed_share == 0.8
    assert read(map_text()).servos[0].speed_deg_s is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            map_text(leg2_femur=None),
            "line 2: no servo is given for leg2_femur; a map has one for each",
        ),
        (
            map_text().replace("leg6_tibia", "leg7_coxa"),
            "line 19: this robot has no joint 'leg7_coxa'; its joints are: leg1_coxa, leg1_femur",
        ),
        (
            map_text(leg1_femur="{board: 0, channel: 0, us_at_zero: 1500, us_per_rad: 9}"),
            "line 3: leg1_femur: channel 0 of board 0 is that of leg1_coxa already",
        ),
        (map_text() + "  leg1_coxa: {}\n", "line 20: servos has 'leg1_coxa' twice"),
        (
            map_text(leg1_coxa="{board: 0, channel: 0, us_at_zero: .nan, us_per_rad: 500}"),
            "line 2: leg1_coxa: us_at_zero must be a number from -40000 to 40000, not '.nan'",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 0, us_at_zero: 1500, us_per_rad: .inf}"),
            "leg1_coxa: us_per_rad must be a number from -20000 to 20000, not '.inf'",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 64, us_at_zero: 1500, us_per_rad: 500}"),
            "leg1_coxa: channel must be a number from 0 to 63, not '64'",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 1.5, us_at_zero: 1500, us_per_rad: 500}"),
            "leg1_coxa: channel must be a whole number",
        ),
        (
            map_text(leg1_coxa="{board: yes, channel: 0, us_at_zero: 1500, us_per_rad: 500}"),
            "leg1_coxa: board must be a number from 0 to 127, not 'yes'",
        ),
        (
            map_text(leg1_coxa="{channel: 0, us_at_zero: 1500, us_per_rad: 500}"),
            "leg1_coxa: board is missing",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 0, us_at_zero: 1500}"),
            "leg1_coxa needs either us_at_zero and us_per_rad, or us_at_minus_45_deg and",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 0, us_at_zero: 1500, us_per_rad: 0}"),
            "leg1_coxa: its pulse must change with the angle",
        ),
        (
            map_text(leg1_coxa="{board: 0, channel: 0, us: 1500}"),
            "leg1_coxa has no field 'us'; it may have board, channel, us_at_zero",
        ),
        (map_text("limits_us: [2500, 500]"), "line 1: limits_us must be the lowest pulse"),
        (map_text("limits_us: 2500"), "line 1: limits_us must be a list of two numbers"),
        (map_text("speed_deg_s: fast"), "speed_deg_s must be a number from 1 to 10000, not 'fast'"),
        (map_text("speed_share: 70"), "speed_share must be a number from 0.01 to 1, not '70'"),
        (map_text("servo: {}"), "a servo map has no field 'servo'; it may have servos"),
        (map_text("x" * 1_000 + ": 1"), f"has no field '{'x' * 40}…'; it may have"),
        ("limits_us: [500, 2500]\n", "servos is missing"),
        ("servos:\n", "servos must be a mapping"),
        ("- a list\n", "a servo map must be a mapping"),
        ("", "it is empty"),
        ("servos: {leg1_coxa: [\n", "not valid YAML: while parsing a flow"),
        ("servos: {}\n---\nservos: {}\n", "not valid YAML: expected a single document"),
        ("servos: \x07\n", "not valid YAML: it has characters that YAML does not allow"),
        (b"\xff\xfe\x00", "it is not text in UTF-8"),
    ],
)
def test_what_is_wrong_is_said_with_its_line_and_what_is_valid(
    text: str | bytes, message: str
) -> None:
    assert message in refused(text)


BOMB = "a: &a [x, x]\n" + "".join(
    f"{chr(98 + n)}: &{chr(98 + n)} [{', '.join([f'*{chr(97 + n)}'] * 9)}]\n" for n in range(9)
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BOMB, "line 2: not valid YAML: *a: aliases are not read; write the value out"),
        ("servos: &own\n  leg1_coxa: *own\n", "aliases are not read"),
        ("[" * 60_000, "nested too deeply"),
        ("{" + "a," * 30_000, "it has more than 5,000 names and values"),
        ("servos: " + "9" * 65_536, "is no servo map: it is larger than 64 kB"),
        ("speed_share: " + "9" * 60_000 + "\nservos: {}\n", "speed_share must be a number"),
        ("speed_share: !!int ''\nservos: {}\n", "speed_share must be a number"),
        ("!!python/object/apply:os.system ['touch bad']\n", "a servo map must be a mapping"),
        ("servos: !!python/object/new:dict {}\n", "servos must be a mapping"),
        (
            map_text("speed_share: !!python/object/apply:os.getpid []"),
            "speed_share must be a number from 0.01 to 1, not a list or mapping",
        ),
    ],
)
def test_hostile_maps_are_refused_at_once_and_construct_nothing(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    began = time.process_time()
    assert message in refused(text)
    assert time.process_time() - began < 1
    assert not [*tmp_path.iterdir()]


def test_a_map_that_cannot_be_read_names_those_that_are_built_in(tmp_path: Path) -> None:
    for path in ("nope.yaml", str(tmp_path), "\0"):
        with pytest.raises(
            InvalidInput, match=r"cannot be read: .*built in: freenove, freenove-old"
        ):
            load_servo_map(path, JOINTS)


FREENOVE_CHANNELS = {
    # The kit's legs from its front right one clockwise, as its software counts channels.
    1: (15, 14, 13),
    6: (12, 11, 10),
    5: (9, 8, 31),
    4: (22, 23, 27),
    3: (19, 20, 21),
    2: (16, 17, 18),
}
"""By our number of the leg: coxa, femur, tibia."""


@pytest.mark.parametrize(
    ("name", "at_0_us", "per_degree_us"), [("freenove", 500, 100 / 9), ("freenove-old", 850, 10)]
)
def test_freenoves_maps_are_as_its_software_turns_the_servos(
    name: str, at_0_us: float, per_degree_us: float
) -> None:
    robot = PRESETS["freenove"]
    servos = load_servo_map(name, [joint.label for joint in legs_of(robot).joints]).servos
    angles_deg = {"coxa": 20.0, "femur": 35.0, "tibia": -80.0}

    for leg, channels in FREENOVE_CHANNELS.items():
        x_m = robot.homes_m[leg - 1][0]
        # Degrees of its servos: the coxa turns clockwise; on the left the others are mirrored.
        is_right = x_m > 0
        degrees = {
            "coxa": 90 - angles_deg["coxa"],
            "femur": 90 + angles_deg["femur"] if is_right else 90 - angles_deg["femur"],
            "tibia": -angles_deg["tibia"] if is_right else 180 + angles_deg["tibia"],
        }
        for (joint, turned_deg), channel in zip(degrees.items(), channels, strict=True):
            servo = next(
                candidate for candidate in servos if candidate.joint == f"leg{leg}_{joint}"
            )
            place = (0x41, channel) if channel < 16 else (0x40, channel - 16)
            assert (servo.board, servo.channel) == place
            pulse = servo.pulses_us(np.radians([angles_deg[joint]]))
            assert pulse == pytest.approx([at_0_us + per_degree_us * turned_deg])


def test_the_map_in_the_document_is_one_of_a_leg() -> None:
    document = (Path(__file__).parents[2] / "docs" / "servos.md").read_text("utf-8")
    example = document.partition("```yaml\n")[2].partition("```")[0]
    servo_map = read_servo_map(example.encode(), "servos.md", JOINTS[:3])
    assert servo_map.servos[0] == Servo("leg1_coxa", 0, 0, 1500, -573, (500, 2500), 353)
    for name in BUILT_IN_MAPS:
        assert f"`{name}`" in document
