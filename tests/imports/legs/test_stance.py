"""The stance that is found: knees bent and above, and feet that can step."""

import re

import numpy as np
import pytest

import hexapods as hx
from hexapods.domain.model_robot import model_robot
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.legs.chain import LegChain
from hexapods.imports.legs.reach import can_step
from tests.imports.robots import FOUR, bug, read

LEVEL = '<limit lower="-3.1416" upper="3.1416" effort="{effort}" velocity="5"/>'


def with_two_joints(axes: tuple[str, str] = ("0 1 0", "0 1 0"), keyframe: str = "") -> str:
    """Return a quadruped whose legs of two joints hang straight down at the angles 0."""
    legs = "".join(
        f"""<body name="{leg}_upper" pos="{x} {y} 0"><joint name="{leg}_hip" axis="{axes[0]}"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.16" size="0.01" mass="0.1"/>
        <body name="{leg}_lower" pos="0 0 -0.16"><joint name="{leg}_knee" axis="{axes[1]}"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.14" size="0.008" mass="0.05"/>
          <geom name="{leg}" type="sphere" size="0.012" pos="0 0 -0.16" mass="0.02"/>
        </body></body>"""
        for leg, (x, y) in FOUR.items()
    )
    return f"""<mujoco><compiler angle="radian"/><default><joint range="-2.5 2.5"/></default>
      <worldbody><body name="trunk" pos="0 0 0.4"><freejoint/>
        <geom type="box" size="0.2 0.08 0.04" mass="1.5"/>{legs}</body></worldbody>
      <keyframe>{keyframe}</keyframe></mujoco>"""


def chains(robot: ImportedRobot) -> list[tuple[LegChain, np.ndarray]]:
    """Return the legs of a robot, and the angles with which it stands."""
    legs = []
    for number in range(1, len(robot.model.feet) + 1):
        links, joints = robot.model.links_of(number), robot.model.joints_of(number)
        anchors = np.cumsum([link.at_m for link in links], axis=0)
        foot = anchors[-1] + robot.model.feet[number - 1].at_m
        limits = np.array([joint.limits_rad for joint in joints]).T
        axes = np.array([joint.axis for joint in joints])
        angles = np.array([joint.home_rad for joint in joints])
        legs.append((LegChain(axes, anchors, foot, limits), angles))
    return legs


def test_straight_legs_of_two_joints_bend() -> None:
    robot = read(with_two_joints())

    assert any("bent knees" in text and "could hardly move" in text for text in robot.guesses)
    assert robot.reaches_grid
    for chain, angles in chains(robot):
        assert not can_step(chain, np.zeros(2))
        assert can_step(chain, angles)
    joints = {note.text: note.parts for note in robot.notes if "leg of two joints" in note.text}
    assert joints == {
        "a leg of two joints follows a grid only as far as it can: 1, 2, 3, 4": tuple(
            f"{leg}_{joint}" for leg in ("FR", "FL", "RL", "RR") for joint in ("hip", "knee")
        )
    }


@pytest.mark.test
def test_such_legs_walk_on_their_usual_grid() -> None:
    imported = read(with_two_joints())
    robot, steps = model_robot(imported.model, imported.name), 20
    side_m = usual_grid_side_m(robot, imported.gait)

    race = hx.race(["greedy"], robot=robot, gait=imported.gait, grid_side_m=side_m, steps=steps)

    assert race.standings[0].total_distance_m == pytest.approx(steps * side_m / 3, rel=0.25)


def test_bent_legs_of_two_joints_stay() -> None:
    bent = "0 0 0.3 1 0 0 0" + 4 * " 0.6 -1.2"
    robot = read(with_two_joints(keyframe=f'<key name="stand" qpos="{bent}"/>'))

    assert "it stands as in keyframe stand" in robot.guesses
    assert [joint.home_rad for joint in robot.model.joints_of(2)] == [0.6, -1.2]


def test_feet_that_cannot_be_lifted_and_moved_are_told() -> None:
    # Both joints turn about the leg itself.
    robot = read(with_two_joints(axes=("0 0 1", "0 0 1")))

    assert not robot.reaches_grid
    (note,) = [note for note in robot.notes if "it cannot walk" in note.text]
    assert note.text.endswith("that of leg 1, 2, 3, 4; choose other angles with which it stands")
    assert len(note.parts) == 8


def test_knees_are_above_where_the_limits_allow_both() -> None:
    robot = read(bug(limit=LEVEL))

    assert robot.reaches_grid
    for chain, angles in chains(robot):
        assert chain.knee_heights_m(angles[None])[0] > 0.1 * chain.length_m


def test_knees_are_below_where_the_limits_allow_no_other() -> None:
    text = bug()
    for joint, limits in (("femur", '"-0.2" upper="2"'), ("tibia", '"-2.6" upper="-0.8"')):
        pattern = rf'(name="j_{joint}.*?lower=)"[^"]*" upper="[^"]*"'
        text = re.sub(pattern, rf"\g<1>{limits}", text)

    for chain, angles in chains(read(text)):
        assert chain.knee_heights_m(angles[None])[0] < -0.02 * chain.length_m


def test_heights_of_knees() -> None:
    chain = LegChain(
        axes=np.array([[0.0, 1, 0], [0, 1, 0]]),
        anchors=np.array([[0.0, 0, 0], [0.1, 0, 0]]),
        foot=np.array([0.2, 0, 0]),
        limits=np.array([[-3.0, -3], [3, 3]]),
    )
    angles = np.array([[0.0, 0], [-0.5, 1], [0.5, -1], [0, np.pi / 2]])

    heights = chain.knee_heights_m(angles)

    # The foot is at the height of the hip with 0.5 and -1; by 90° at 45° below it.
    assert heights == pytest.approx([0, 0.1 * np.sin(0.5), -0.1 * np.sin(0.5), 0.05])
