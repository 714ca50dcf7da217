"""Robots from files: what follows from their models, and what may be changed."""

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import resolve
from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_geometry import home_angles, leg_chains, turned_mounts
from hexapods.domain.model_robot import model_robot
from hexapods.domain.posture import has_fallen
from hexapods.domain.robot import PRESETS, Robot, changed_model
from hexapods.domain.robot_model import ModelMesh, RobotModel
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.support import Support
from hexapods.domain.tolerance import build_tolerance
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import preview
from tests.model_robots import (
    four_joint_model,
    mesh_of,
    mixed_model,
    model_of,
    quadruped_model,
    two_joint_model,
    wedge,
)


@pytest.mark.parametrize("name", ["stiff", "ant", "dog"])
def test_a_robot_from_a_file_has_the_size_of_the_built_in_one(name: str) -> None:
    built_in, robot = PRESETS[name], model_robot(model_of(PRESETS[name]), "own")

    assert robot.homes_m == pytest.approx(np.array(built_in.homes_m), abs=1e-9)
    assert robot.azimuths_deg == pytest.approx(
        [azimuth if azimuth <= 180 else azimuth - 360 for azimuth in built_in.azimuths_deg],
        abs=1e-6,
    )
    for field in ("body_height_m", "foot_radius_m", "torso_kg", "span_m", "servo_kp", "servo_kv"):
        assert getattr(robot, field) == pytest.approx(getattr(built_in, field)), field
    assert robot.torso_half_sides_m == pytest.approx(np.array(built_in.torso_half_sides_m))
    assert robot.torso_half_height_m == pytest.approx(built_in.torso_half_height_m)
    assert legs_of(robot).masses_kg == pytest.approx(legs_of(built_in).masses_kg)
    gaits = [resolve("trot", either.azimuths_deg) for either in (built_in, robot)]
    centers = [
        Support(either, gait).center_m
        for either, gait in zip((built_in, robot), gaits, strict=True)
    ]
    assert centers[0] == pytest.approx(centers[1], abs=1e-9)


def test_heights_and_times_scale_with_the_legs_and_two_legs_carry_it_briefly() -> None:
    hexapod, dog = model_robot(model_of(Robot()), "own"), model_robot(quadruped_model(), "own")

    assert hexapod.step_height_m == pytest.approx(0.026, abs=0.001)
    assert hexapod.swing_s == pytest.approx(0.2)
    assert hexapod.shift_s == pytest.approx(0.12)
    assert dog.step_height_m > 2 * hexapod.step_height_m
    assert dog.shift_s > hexapod.shift_s
    assert dog.swing_s == 0.17
    assert usual_grid_side_m(dog, "trot") > 2 * usual_grid_side_m(hexapod, "tripod")
    assert hexapod.dt_s == 0.004
    soft = model_robot(model_of(replace(Robot(), joint_armature=0.0002)), "own")
    assert soft.dt_s < hexapod.dt_s


def test_feet_of_other_heights_stand_on_one_plane() -> None:
    model = quadruped_model()
    lower = tuple(
        replace(foot, at_m=(x, y, z - 0.01 * (number == 0)))
        for number, (foot, (x, y, z)) in enumerate((foot, foot.at_m) for foot in model.feet)
    )
    robot = model_robot(replace(model, feet=lower), "own")
    legs = legs_of(robot)
    standing = legs.under(resolve("trot", robot.azimuths_deg)).joint_angles(np.zeros((4, 3)))
    heights = legs.feet_in_body(standing[None])[0, :, 2]

    assert heights == pytest.approx([-robot.body_height_m] * 4, abs=1e-9)
    assert robot.body_height_m == pytest.approx(0.3625)


@pytest.mark.parametrize(
    ("model", "gait"),
    [
        pytest.param(quadruped_model(), "trot", id="quadruped"),
        pytest.param(four_joint_model(), "tripod", id="hexapod"),
        pytest.param(two_joint_model(), "trot", id="two joints"),
        pytest.param(mixed_model(), "tripod", id="mixed"),
    ],
)
def test_it_begins_with_a_grid_on_which_it_walks(model: RobotModel, gait: str) -> None:
    robot = model_robot(model, "own")
    side_m = usual_grid_side_m(robot, gait)
    previewed = preview(WalkingProblem(gait=gait, robot=robot, grid_side_m=side_m))

    assert previewed.out_of_reach is None
    assert previewed.safe_side_m is not None
    assert previewed.law_m > 0.2
    assert previewed.stands
    assert previewed.safe_side_m >= side_m
    assert len(previewed.legs) == len(model.feet)
    assert "coxa_m" not in previewed.built
    follows = "legs 1, 2, 3, 4" if len(model.joints_of(1)) == 2 else None
    assert (
        (previewed.beside_grid is None)
        if follows is None
        else follows in (previewed.beside_grid or "")
    )
    assert {leg.follows_grid for leg in previewed.legs} == {follows is None}
    links = previewed.legs[0].links_m
    assert links is not None
    assert len(links) == len(model.joints_of(1)) + 1


def test_equal_models_make_equal_robots_and_survive_pickling() -> None:
    first, second = model_robot(quadruped_model(), "own"), model_robot(quadruped_model(), "own")
    assert first == second
    assert hash(first) == hash(second)
    assert pickle.loads(pickle.dumps(first)) == first
    assert first != model_robot(two_joint_model(), "own")
    heavier = replace(first.model.links[0], mass_kg=6.5)
    assert first.model != replace(first.model, links=(heavier, *first.model.links[1:]))
    whole: Any = 6  # as a program may write it
    same = replace(first.model.links[0], mass_kg=whole)
    assert first.model == replace(first.model, links=(same, *first.model.links[1:]))


def test_servos_are_scaled_and_lengths_are_those_of_the_file() -> None:
    robot = model_robot(model_of(PRESETS["dog"]), "own")
    strong = changed_model(robot, {"servo_torque_nm": 3.0, "friction": 0.5, "swing_s": 0.3})

    assert strong.servo_of(1, "hip").torque_nm == pytest.approx(3.0)
    assert strong.servo_of(1, "hip").kp == pytest.approx(40)
    assert (strong.friction, strong.swing_s) == (0.5, 0.3)
    assert strong.name == "own (modified)"
    assert changed_model(robot, {"friction": 1}) == robot
    with pytest.raises(UnknownName, match="servo_kp, servo_kv, servo_torque_nm, friction, step_h"):
        changed_model(robot, {"torso_kg": 2.0})
    with pytest.raises(InvalidInput, match=r"robot.servo_kp must be from 0.4 to 4000, not 1"):
        changed_model(robot, {"servo_kp": 1e6})


def test_a_weaker_joint_stays_weaker() -> None:
    model = quadruped_model()
    links = tuple(
        replace(link, joint=replace(link.joint, servo_torque_nm=5.0))
        if link.joint is not None and link.joint.name == "hip"
        else link
        for link in model.links
    )
    changed = changed_model(
        model_robot(replace(model, links=links), "own"), {"servo_torque_nm": 12.5}
    )

    assert changed.servo_of(2, "knee").torque_nm == pytest.approx(12.5)
    assert changed.servo_of(2, "hip").torque_nm == pytest.approx(2.5)


def test_build_tolerance_varies_masses_servos_friction_and_mounts() -> None:
    designed = model_robot(quadruped_model(), "own")
    built = build_tolerance(designed, 0.1, np.random.default_rng(2))
    assert build_tolerance(designed, 0.0, np.random.default_rng(2)) is designed
    assert built == build_tolerance(designed, 0.1, np.random.default_rng(2))
    assert built.torso_kg != designed.torso_kg
    assert built.torso_kg == pytest.approx(designed.torso_kg, rel=0.1)
    assert legs_of(built).masses_kg != legs_of(designed).masses_kg
    for field in ("servo_kp", "servo_kv", "friction"):
        assert getattr(built, field) == pytest.approx(getattr(designed, field), rel=0.1)
        assert getattr(built, field) != getattr(designed, field)
    assert built.homes_m != designed.homes_m
    assert built.homes_m == pytest.approx(np.array(designed.homes_m), abs=0.02)


def test_mounts_turn_about_the_vertical_through_the_first_joint() -> None:
    model = mixed_model()
    turned = turned_mounts(model, [10, 0, 0, 0, 0, -5])
    before, after = (leg_chains(variant, home_angles(variant)) for variant in (model, turned))
    for number, degrees in enumerate([10, 0, 0, 0, 0, -5]):
        chain, turned_chain = before[number], after[number]
        assert turned_chain.anchors_m[0] == pytest.approx(chain.anchors_m[0], abs=1e-12)
        cos, sin = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
        turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
        assert turned_chain.foot_m - turned_chain.anchors_m[0] == pytest.approx(
            turn @ (chain.foot_m - chain.anchors_m[0]), abs=1e-12
        )


def test_it_has_fallen_when_its_torso_lies_on_the_ground() -> None:
    robot = model_robot(quadruped_model(), "own")
    upright = [0.0, 0.0, 0.38, 1.0, 0.0, 0.0, 0.0]
    on_its_side = [0.0, 0.0, 0.1, 0.7071, 0.0, 0.7071, 0.0]

    assert not has_fallen(robot, upright)
    assert has_fallen(robot, on_its_side)


def test_a_mesh_that_is_damaged_is_refused() -> None:
    model = quadruped_model()

    def with_mesh(mesh: ModelMesh) -> RobotModel:
        return replace(model, links=(replace(model.links[0], mesh=mesh), *model.links[1:]))

    assert with_mesh(wedge(1, 1, 1)) != model
    whole = wedge(1, 1, 1)
    for mesh, problem in (
        (replace(whole, vertices="!"), "a mesh is damaged"),
        (replace(whole, vertices=whole.vertices[:12]), "a mesh is damaged"),
        (replace(whole, triangles=3), "its faces do not fit"),
        (mesh_of([(0, 0, 0)] * 3, [(0, 1, 3)]), "its faces do not fit"),
        (wedge(20, 1, 1), "larger than 10 m"),
    ):
        with pytest.raises(InvalidInput, match=problem):
            with_mesh(mesh)
