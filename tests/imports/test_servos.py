"""Torques of servos, and what joints lose by damping and friction."""

import pytest

import hexapods as hx
from hexapods.domain.model_robot import model_robot
from hexapods.domain.robot import document_of, read_document
from hexapods.domain.robot_model import ModelJoint
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.imports.choices import Choices
from hexapods.imports.imported import ImportedRobot
from hexapods.physics.mjcf import compile_model
from tests.imports.robots import HOME, bug, dog, read

WITHOUT_LIMITS = '<position joint="{joint}" kp="40"/>'


def knee(robot: ImportedRobot) -> ModelJoint:
    return robot.model.joints_of(1)[2]


def with_losses(losses: str, **details: str) -> str:
    """Return the dog with losses in its hips, thighs and calves."""
    text = dog(keyframes={"home": HOME}, **details)  # type: ignore[arg-type]
    return text.replace('_joint" axis=', f'_joint" {losses} axis=')


def test_friction_belongs_to_the_robot() -> None:
    robot = read(with_losses('frictionloss="0.3" damping="0.2"'))

    assert (knee(robot).friction_nm, knee(robot).damping) == (0.3, 0.2)
    assert knee(robot).servo_torque_nm == 20  # as the file says

    compiled = compile_model(model_robot(robot.model, "dog"))
    assert compiled.dof_frictionloss[6:] == pytest.approx([0.3] * 12)


def test_friction_of_a_urdf_belongs_to_the_robot() -> None:
    dynamics = '<dynamics damping="0.02" friction="0.05"/>'
    limit = '<limit lower="-1.6" upper="1.6" effort="{effort}" velocity="5"/>' + dynamics

    assert knee(read(bug(limit=limit))).friction_nm == 0.05


def test_friction_is_stored_and_without_it_the_document_is_as_before() -> None:
    rough, plain = (read(with_losses(losses)) for losses in ('frictionloss="0.3"', ""))

    documents = [document_of(model_robot(robot.model, "dog")) for robot in (rough, plain)]

    assert b'"friction_nm":0.3' in documents[0]
    assert b"friction_nm" not in documents[1]
    for robot, document in zip((rough, plain), documents, strict=True):
        stored = read_document(document)
        assert stored == model_robot(robot.model, "dog")
        assert document_of(stored) == document


def test_a_guessed_torque_overcomes_damping_and_friction() -> None:
    plain = read(with_losses("", actuators=WITHOUT_LIMITS))
    lossy = read(with_losses('damping="2" frictionloss="0.5"', actuators=WITHOUT_LIMITS))

    assert knee(lossy).servo_torque_nm == pytest.approx(knee(plain).servo_torque_nm + 0.5 + 2.5 * 2)
    (note,) = [note for note in lossy.notes if "largest torque of all joints" in note.text]
    assert "and the damping and friction of its joints" in note.text
    assert len(note.parts) == 12


@pytest.mark.test
def test_a_robot_with_damped_joints_walks() -> None:
    imported = read(with_losses('damping="8"', actuators=WITHOUT_LIMITS))
    robot, steps = model_robot(imported.model, imported.name), 20
    side_m = usual_grid_side_m(robot, imported.gait)

    race = hx.race(["greedy"], robot=robot, gait=imported.gait, grid_side_m=side_m, steps=steps)

    assert race.standings[0].total_distance_m == pytest.approx(steps * side_m / 3, rel=0.25)


def test_servos_that_can_hardly_move_are_told_with_a_torque_that_can() -> None:
    robot = read(with_losses('damping="10" frictionloss="3"'))

    (note,) = [note for note in robot.notes if "can hardly move" in note.text]
    assert note.text == (
        "12 servos can hardly move: FR_hip_joint has at most 20 N·m against a damping of 10 "
        "N·m·s/rad and a friction of 3 N·m"
    )
    assert note.offer == Choices(servo_torque_nm=56)
    stronger = read(with_losses('damping="10" frictionloss="3"'), choices=note.offer)
    assert not any("can hardly move" in text for text in stronger.guesses)


def test_springs_are_told() -> None:
    robot = read(with_losses('stiffness="2"'))

    (note,) = [note for note in robot.notes if "springs of joints" in note.text]
    assert note.parts[:2] == ("FL_hip_joint", "FL_thigh_joint")
    assert not any("springs" in text for text in read(with_losses('stiffness="0.0"')).repairs)


def test_joints_without_an_actuator_among_others_are_told() -> None:
    text = dog(keyframes={"home": HOME})
    for leg in ("FL", "RR"):
        text = text.replace(f'<position joint="{leg}_calf_joint" kp="40" forcerange="-20 20"/>', "")
    robot = read(text)

    (note,) = [note for note in robot.notes if "had no actuator" in note.text]
    assert set(note.parts) == {"FL_calf_joint", "RR_calf_joint"}


def test_what_is_told_names_its_parts() -> None:
    arm = (
        '<body name="arm" pos="0 0 0.1"><joint name="shoulder" axis="0 1 0"/>'
        '<geom type="capsule" fromto="0 0 0 0 0 0.1" size="0.01" mass="0.1"/></body>'
    )
    robot = read(dog(base="", keyframes={}, on_torso=arm))

    parts = {note.text.partition(":")[0]: note.parts for note in robot.notes}
    assert parts["trunk was fixed to the world; now it is free"] == ("trunk",)
    assert parts["it has joints of no leg, which hold"] == ("shoulder",)
    legs = parts["its 4 legs are the chains that reach lowest, to"]
    assert set(legs) == {"FL_calf", "FR_calf", "RL_calf", "RR_calf"}
