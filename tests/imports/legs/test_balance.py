"""What topples is told before it walks."""

import pytest

from hexapods.domain.gait import read_gait
from hexapods.imports.choices import Choices
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.legs.balance import center_of_mass_m
from hexapods.imports.notes import Note
from tests.imports.robots import FOUR, HOME, SIX, bug, dog, read
from tests.imports.same_motion import feet_and_center


def with_pack(x_m: float, kg: float) -> str:
    """Return the dog with a load on its back, at some distance ahead of its centre."""
    inertial = f'<inertial pos="0 0 0" mass="{kg}" diaginertia="0.1 0.1 0.1"/>'
    pack = f'<body name="pack" pos="{x_m} 0 0.05">{inertial}</body>'
    return dog(keyframes={"home": HOME}, on_torso=pack)


def toppling(robot: ImportedRobot) -> list[Note]:
    return [note for note in robot.notes if "it topples" in note.text]


def test_the_centre_of_mass_is_that_of_mujoco() -> None:
    robot = read(with_pack(0.05, 4))
    home = {
        (leg, joint.name): joint.home_rad
        for leg in range(1, 5)
        for joint in robot.model.joints_of(leg)
    }

    assert center_of_mass_m(robot.model) == pytest.approx(feet_and_center(robot, home)[1], abs=1e-9)


@pytest.mark.parametrize("text", [dog(keyframes={"home": HOME}), with_pack(0.05, 4), bug()])
def test_a_robot_that_is_balanced_is_not_said_to_topple(text: str) -> None:
    assert toppling(read(text)) == []


def test_a_trot_with_a_load_ahead_topples() -> None:
    (note,) = toppling(read(with_pack(0.2, 12)))

    assert note.topic == "groups"
    assert "it topples while legs 2 4 swing" in note.text
    assert note.offer is None  # any other three legs stand no better


def test_a_robot_that_cannot_even_stand_is_told() -> None:
    (note,) = toppling(read(with_pack(0.6, 30)))

    assert note.topic == "stance"
    assert note.text.endswith("mm outside its feet: it topples as it stands")


def test_legs_of_one_side_that_swing_together_topple_a_hexapod() -> None:
    on_the_left = tuple(n for n, leg in enumerate(read(bug()).legs, start=1) if "_l" in leg.foot)
    others = tuple(n for n in range(1, len(SIX) + 1) if n not in on_the_left)
    gait = {"right_leg": 1, "left_leg": 2, "groups": [others, on_the_left]}

    (note,) = toppling(read(bug(), choices=Choices(gait=read_gait(gait))))

    assert "better groups are 1 3 5; 2 4 6" in note.text
    assert note.offer is not None
    assert toppling(read(bug(), choices=note.offer)) == []


def test_a_narrow_robot_is_offered_to_stand_lower() -> None:
    narrow = {leg: (x, 0.4 * y) for leg, (x, y) in FOUR.items()}
    text = dog(narrow, keyframes={"home": HOME})
    robot = read(text)

    (note,) = [note for note in robot.notes if "it may topple in this gait" in note.text]
    assert note.offer is not None
    assert note.offer.body_height_m is not None
    assert note.offer.body_height_m < robot.body_height_m
    lower = read(text, choices=note.offer)
    assert lower.body_height_m == pytest.approx(note.offer.body_height_m, abs=1e-3)
    assert not any("may topple" in text for text in lower.guesses)
