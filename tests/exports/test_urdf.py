"""Robots as URDF: what other readers demand, and the same robot when it is read back."""

import io
import zipfile
from dataclasses import replace
from functools import cache
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
import pytest

import hexapods as hx
from hexapods.domain.creatures import CREATURES, PRESETS
from hexapods.domain.gait import GaitSpec, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_robot import ModelRobot, model_robot
from hexapods.domain.robot import Robot
from hexapods.domain.robot_model import ModelGeom, RobotModel
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.types import Action
from hexapods.exports.robot_files import ROBOT_FILES
from hexapods.exports.urdf import robot_urdf, robot_urdf_zip
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.imported import ImportedRobot
from hexapods.physics.mjcf import compile_visual_model
from hexapods.physics.mujoco_simulator import MujocoSimulator
from tests.imports.robots import HOME, bug, dog, read
from tests.model_robots import (
    four_joint_model,
    gait_of,
    mixed_model,
    quadruped_model,
    two_joint_model,
    with_meshes,
)

STEPS = 6
READ_BACK = ("xml", "zip")


def from_files() -> dict[str, tuple[ModelRobot, str | GaitSpec]]:
    """Return robots from files, with their gaits."""
    models = {
        "meshes": with_friction(with_meshes(quadruped_model())),
        "four joints": four_joint_model(),
        "two joints": two_joint_model(),
        "mixed": mixed_model(),
    }
    robots: dict[str, tuple[ModelRobot, str | GaitSpec]] = {}
    for name, model in models.items():
        robot = model_robot(model, name)
        robots[name] = robot, gait_of(robot)
    for name, text in {
        "dog": dog(keyframes={"home": HOME}),
        "searched": dog(),
        "bug": bug(),
    }.items():
        imported = read(text)
        robots[f"imported {name}"] = (imported.robot(name), imported.gait)
    return robots


def with_friction(model: RobotModel) -> RobotModel:
    """Return a model with dry friction in its joints."""
    links = tuple(
        replace(link, joint=replace(link.joint, friction_nm=0.3)) if link.joint else link
        for link in model.links
    )
    return replace(model, links=links)


FROM_FILES = from_files()
BUILT_IN = {name: (creature.robot, creature.gait) for name, creature in CREATURES.items()}
ROBOTS: dict[str, tuple[Robot, str | GaitSpec]] = {**BUILT_IN, **FROM_FILES}


def exported(robot: Robot, ending: str, choices: Choices = AS_FOUND) -> ImportedRobot:
    """Return a robot from its exported file."""
    return read(ROBOT_FILES[ending].write(robot), f"file.{ending}", choices)


def walked(robot: Robot, gait: str | GaitSpec, side_m: float) -> list[float]:
    """Return the pose of the torso after steps that are fixed: place and rotation."""
    simulator = MujocoSimulator(robot, resolve(gait, robot.azimuths_deg), FootGrid(side_m))
    state = simulator.rest()
    groups = len(simulator.gait.groups)
    for number in range(STEPS):
        state = simulator.step(state, Action(number % groups, 1 + number % 2)).state
    place: list[float] = simulator.pose(state)[:7].tolist()
    return place


@cache
def walked_of(name: str) -> list[float]:
    robot, gait = ROBOTS[name]
    return walked(robot, gait, usual_grid_side_m(robot, gait))


@pytest.mark.test
@pytest.mark.parametrize("ending", READ_BACK)
@pytest.mark.parametrize("name", ROBOTS)
def test_it_is_read_back_as_the_robot_that_moves_alike(name: str, ending: str) -> None:
    robot, gait = ROBOTS[name]
    imported = exported(robot, ending)
    again = imported.robot(name)

    if name in BUILT_IN:
        assert imported.gait == gait
    assert {note.kind for note in imported.notes if note.topic == "servos"} == set()
    turned = np.subtract(again.azimuths_deg, robot.azimuths_deg)
    assert (turned + 180) % 360 - 180 == pytest.approx(0, abs=1e-5)
    assert [joint.label for joint in legs_of(again).joints] == [
        joint.label for joint in legs_of(robot).joints
    ]
    for number in ("friction", "step_height_m", "swing_s", "shift_s", "dt_s"):
        assert getattr(again, number) == getattr(robot, number)
    if isinstance(robot, ModelRobot):
        assert [joint.friction_nm for leg in (1, 2) for joint in again.model.joints_of(leg)] == [
            joint.friction_nm for leg in (1, 2) for joint in robot.model.joints_of(leg)
        ]
    if isinstance(robot, ModelRobot):
        before, after = (
            [link.joint.home_rad for link in body.model.links if link.joint]
            for body in (robot, again)
        )
        assert after == pytest.approx(before, abs=1e-12)
    for joint in legs_of(robot).joints:
        assert again.servo_of(joint.leg, joint.name) == robot.servo_of(joint.leg, joint.name)
    side_m = usual_grid_side_m(robot, gait)
    # Legs of built-in robots are solved in closed form, those of files by iteration.
    off = 5e-4 if name in BUILT_IN else 1e-7
    assert walked(again, gait, side_m) == pytest.approx(walked_of(name), abs=off)


@pytest.mark.test
@pytest.mark.parametrize(
    ("name", "ending"),
    [("starfish", "xml"), ("slippery", "zip"), ("crab", "urdf"), ("imported bug", "zip")],
)
def test_greedy_walks_as_far(name: str, ending: str) -> None:
    robot, gait = ROBOTS[name]
    side_m = usual_grid_side_m(robot, gait)
    before_m, after_m = (
        hx.race(["greedy"], robot=body, gait=gait, grid_side_m=side_m).standings[0].total_distance_m
        for body in (robot, exported(robot, ending).robot(name))
    )
    assert after_m == pytest.approx(before_m, rel=0.01)


def test_what_other_readers_demand_is_there() -> None:
    robot = FROM_FILES["meshes"][0]
    with zipfile.ZipFile(io.BytesIO(robot_urdf_zip(robot))) as archive:
        document, *meshes = archive.namelist()
        root = ElementTree.fromstring(archive.read(document))
        sizes = [len(archive.read(mesh)) for mesh in meshes]
    assert document == "meshes.urdf"
    assert root.get("name") == "meshes"
    files = [mesh.get("filename", "") for mesh in root.iter("mesh")]
    assert sorted(files) == sorted(meshes)
    assert sizes == [84 + 50 * 4] * 5, "tetrahedra in binary STL"
    check_tree(root)
    for joint in root.iter("joint"):
        if joint.get("type") == "revolute":
            assert {child.tag for child in joint} == {
                "origin", "parent", "child", "axis", "limit", "dynamics",
            }  # fmt: skip
            limit = joint.find("limit")
            assert limit is not None
            assert {*limit.attrib} == {"lower", "upper", "effort", "velocity"}
            assert float(limit.get("velocity", "")) > 0
    masses = [float(mass.get("value", "")) for mass in root.iter("mass")]
    assert sum(masses) == pytest.approx(sum(link.mass_kg for link in robot.model.links))
    assert len(masses) == len([*root.iter("link")]), "PyBullet takes 1 kg where there is none"
    assert {element.tag for element in root.iter("geometry") for element in element} <= {
        "box", "cylinder", "sphere", "mesh",
    }  # fmt: skip


def check_tree(root: Element) -> None:
    """Check that links are a tree below the torso, and names of shapes are unique."""
    links = [link.get("name") for link in root.findall("link")]
    ends = [(joint.find("parent"), joint.find("child")) for joint in root.findall("joint")]
    parents = {end.get("link") for end, _ in ends if end is not None}
    children = [end.get("link") for _, end in ends if end is not None]
    assert sorted(["torso", *map(str, children)]) == sorted(map(str, links))
    assert parents <= {*links}
    shapes = [
        shape.get("name") for link in root.findall("link") for shape in link if shape.get("name")
    ]
    assert len({*shapes}) == len(shapes)


@pytest.mark.parametrize("name", ["spider", "crab", "mixed", "meshes", "imported bug"])
def test_mujoco_reads_it_as_it_is_in_any_pose(name: str) -> None:
    robot = ROBOTS[name][0]
    visual, read_back = (
        compile_visual_model(robot),
        mujoco.MjModel.from_xml_string(robot_urdf(robot)),
    )
    angles = np.random.default_rng(1).uniform(-1, 1, visual.nu)
    torso = [0, 0, 0, 1, 0, 0, 0]
    data, data_back = mujoco.MjData(visual), mujoco.MjData(read_back)
    data.qpos[:], data_back.qpos[:] = [*torso, *angles], angles
    for model, posed in ((visual, data), (read_back, data_back)):
        mujoco.mj_kinematics(model, posed)
        mujoco.mj_comPos(model, posed)
    for joint in legs_of(robot).joints:
        assert data_back.body(joint.label).xpos == pytest.approx(
            data.body(joint.label).xpos, abs=1e-9
        )
        assert data_back.body(joint.label).xipos == pytest.approx(
            data.body(joint.label).xipos, abs=1e-9
        )
    for leg in range(1, len(robot.legs) + 1):
        assert data_back.body(f"leg{leg}_foot").xpos == pytest.approx(
            data.geom(f"leg{leg}_foot").xpos, abs=1e-9
        )


def test_a_person_can_correct_what_is_in_the_file() -> None:
    robot = PRESETS["dog"]
    turned = exported(robot, "urdf", Choices(forward="-y", servo_torque_nm=2.0, gait="trot"))
    assert turned.forward_deg == -90
    assert turned.gait == "trot"
    joints = [link.joint for link in turned.model.links if link.joint is not None]
    assert {joint.servo_torque_nm for joint in joints} == {2.0}
    assert {joint.servo_kp for joint in joints} == {40.0}, "of the file"


@pytest.mark.parametrize(
    ("text", "changed"),
    [
        ("leg1_foot leg2_foot", "leg1_foot leg1_foot"),
        ('gait="trot"', 'gait="tripod"'),
        ('gait="trot"', 'gait="{&quot;right_leg&quot;: [[[[[1]]]]]}"'),
        ('swing_s="0.2"', 'swing_s="1e9"'),
        ('swing_s="0.2"', 'swing_s="nan"'),
        ('kp="40"', 'kp="0"'),
        ('armature="0.002"', 'armature="-1"'),
        ("<hexapods ", "<others "),
    ],
)
def test_settings_that_do_not_fit_the_file_are_left_out(text: str, changed: str) -> None:
    document = robot_urdf(PRESETS["dog"])
    assert text in document
    changed_document = document.replace(text, changed)
    if "<others" in changed:
        changed_document = changed_document.replace("</hexapods>", "</others>")
    imported = read(changed_document, "dog.urdf")
    assert len(imported.legs) == 4
    assert imported.numbers == {}
    assert not any("exported here" in note.text for note in imported.notes)


def test_shapes_that_urdf_lacks_are_drawn_as_others() -> None:
    model = quadruped_model()
    flat = ModelGeom("ellipsoid", (0.1, 0.2, 0.03), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    links = (replace(model.links[0], geoms=(flat,)), *model.links[1:])
    robot = model_robot(RobotModel(links, model.feet), "with an ellipsoid")
    (shape,) = exported(robot, "urdf").model.links[0].geoms
    assert shape.kind == "cylinder"
    radius, half, _ = shape.size_m
    assert 2 * radius**2 * half == pytest.approx(4 / 3 * 0.1 * 0.2 * 0.03), "of the same volume"
    capsules = [geom for link in robot.model.links for geom in link.geoms if geom.kind == "capsule"]
    again = [
        geom
        for link in exported(robot, "urdf").model.links
        for geom in link.geoms
        if geom.kind == "capsule"
    ]
    assert [geom.size_m for geom in again] == [
        pytest.approx(geom.size_m, abs=1e-9) for geom in capsules
    ]
