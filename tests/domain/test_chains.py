"""Numeric kinematics of chains: exact within reach, NaN beyond, and the same in any batch."""

from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.chains import ChainLegs
from hexapods.domain.errors import ImpossibleLegs, Unreachable
from hexapods.domain.feet import StepLaw
from hexapods.domain.gait import Gait, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach, legs_of
from hexapods.domain.legs import FootKinematics
from hexapods.domain.model_robot import model_robot
from hexapods.domain.motion import StepMotion
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.robot_model import RobotModel
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.domain.types import Action, FloatArray
from tests.model_robots import (
    four_joint_model,
    mixed_model,
    model_of,
    quadruped_model,
    two_joint_model,
)

FOLLOWING = {"quadruped": quadruped_model, "four joints": four_joint_model, "mixed": mixed_model}


def kinematics_of(model: RobotModel, gait: str = "trot") -> FootKinematics:
    robot = model_robot(model, "own")
    return legs_of(robot).under(resolve(gait, robot.azimuths_deg))


def offsets(legs: int, within_m: float, count: int = 300) -> FloatArray:
    """Return foot offsets from home, (count, legs, 3) [m]."""
    drawn = np.random.default_rng(5).uniform(-within_m, within_m, (count, legs, 3))
    drawn[..., 2] = np.abs(drawn[..., 2])
    return drawn


@pytest.mark.parametrize("name", ["stiff", "ant", "dog", "centipede"])
def test_numeric_kinematics_is_the_closed_form_of_a_built_in_robot(name: str) -> None:
    closed, numeric = PRESETS[name], model_robot(model_of(PRESETS[name]), name)
    closed_legs = legs_of(closed).under(resolve("trot", closed.azimuths_deg))
    numeric_legs = legs_of(numeric).under(resolve("trot", numeric.azimuths_deg))
    places = offsets(len(closed.legs), 0.02)
    angles = numeric_legs.joint_angles(places)

    assert np.abs(closed_legs.homes_m - numeric_legs.homes_m).max() < 1e-9
    assert np.abs(angles - closed_legs.joint_angles(places)).max() < 1e-9
    assert legs_of(numeric).feet_in_body(angles) == pytest.approx(
        legs_of(closed).feet_in_body(angles), abs=1e-9
    )
    pose = angles[0].tolist()
    assert numeric_legs.foot_offsets(pose) == pytest.approx(
        np.array(closed_legs.foot_offsets(pose)), abs=1e-9
    )
    for links, numeric_links in zip(
        legs_of(closed).links_in_body(pose), legs_of(numeric).links_in_body(pose), strict=True
    ):
        assert numeric_links == pytest.approx(links, abs=1e-9)
    far = offsets(len(closed.legs), 0.08)
    with np.errstate(invalid="ignore"):
        wanted = closed_legs.joint_angles(far).reshape(-1, 3)
    numeric_angles = numeric_legs.joint_angles(far).reshape(-1, 3)
    is_unreached, is_not_found = (np.isnan(each.sum(axis=1)) for each in (wanted, numeric_angles))
    # The numeric one finds no foot where there is none, and nearly all others.
    assert is_unreached.sum() > 3
    assert is_not_found[is_unreached].all()
    assert is_not_found[~is_unreached].mean() < 0.005
    # Where a leg is nearly straight or folded, its angles are less certain than its foot.
    found_by_both = ~is_not_found
    assert np.quantile(np.abs(numeric_angles - wanted)[found_by_both], 0.99) < 1e-6


@pytest.mark.parametrize("name", FOLLOWING)
@pytest.mark.parametrize("within_m", [0.02, 0.06])
def test_feet_arrive_within_a_tenth_of_a_millimetre(name: str, within_m: float) -> None:
    model = FOLLOWING[name]()
    legs = kinematics_of(model)
    places = offsets(len(model.feet), within_m)
    angles = legs.joint_angles(places)
    # As a step's commands are computed: less exactly.
    x, y, z = np.moveaxis(places, -1, 0)
    frames = np.repeat(legs.frames[:, None], len(places), axis=1)
    coarse = legs.in_pose_order(legs.solve(np.array((x, y)), z, frames))

    for place, solved, step in zip(places, angles, coarse, strict=True):
        assert np.abs(np.array(legs.foot_offsets(solved.tolist())) - place).max() < 1e-8
        assert np.abs(np.array(legs.foot_offsets(step.tolist())) - place).max() < 1e-4


def test_a_chain_with_more_joints_than_it_needs_stays_near_where_it_stands() -> None:
    model = four_joint_model()
    legs = legs_of(model_robot(model, "own"))
    assert isinstance(legs, ChainLegs)
    angles = kinematics_of(model).joint_angles(offsets(6, 0.02))

    assert np.abs(angles - legs.standing_rad).max() < 0.5


@pytest.mark.parametrize(
    "model", [mixed_model(), two_joint_model(), model_of(Robot())], ids=["mixed", "two", "stiff"]
)
def test_angles_do_not_depend_on_the_batch(model: RobotModel) -> None:
    legs = kinematics_of(model)
    places = offsets(len(model.feet), 0.05, 1000)
    together = legs.joint_angles(places)

    for number in (0, 1, 250, 700, 999):
        assert legs.joint_angles(places[number]).tobytes() == together[number].tobytes()
        some = legs.joint_angles(places[number : number + 7])
        assert some.tobytes() == together[number : number + 7].tobytes()


def test_commands_of_steps_do_not_depend_on_the_batch_and_end_in_their_cells() -> None:
    robot = model_robot(quadruped_model(), "own")
    gait, grid = resolve("trot", robot.azimuths_deg), FootGrid(0.08)
    motion = StepMotion(robot, gait, StepLaw(gait, grid, None))
    feet, plans = StepLaw(gait, grid, None).at_home(), []
    for number in range(40):
        plan = motion.plan(feet, Action(number % 2, 1 + number % 4))
        plans.append(plan)
        feet = plan.end
    together = motion.joint_targets(plans)

    for number, plan in enumerate(plans):
        assert motion.joint_targets([plan]).tobytes() == together[number].tobytes()
        reached = motion.kinematics.foot_offsets(together[number, -1].tolist())
        offset = gait.by_leg(np.array((plan.end.lateral_m, plan.end.forward_m)).T)
        assert np.array(reached)[:, :2] == pytest.approx(offset, abs=1e-5)


def test_commands_between_the_places_that_are_solved_are_within_a_third_of_a_milliradian() -> None:
    robot = model_robot(model_of(Robot()), "own")
    gait, grid = resolve("tripod", robot.azimuths_deg), FootGrid(0.04)
    law = StepLaw(gait, grid, None)
    closed = StepMotion(Robot(), resolve("tripod", Robot().azimuths_deg), law)
    numeric = StepMotion(
        model_robot(robot.model, "own", swing_s=0.2, shift_s=0.12, step_height_m=0.03), gait, law
    )
    plan = numeric.plan(law.at_home(), Action(0, 1))
    for action in (Action(1, 2), Action(0, 4), Action(1, 3)):
        wanted, targets = (motion.joint_targets([plan]) for motion in (closed, numeric))
        assert np.abs(targets - wanted).max() < 3e-4
        plan = numeric.plan(plan.end, action)


def test_legs_of_two_joints_keep_the_height_and_say_that_they_do_not_follow() -> None:
    model = two_joint_model()
    robot = model_robot(model, "own")
    legs = legs_of(robot)
    assert isinstance(legs, ChainLegs)
    places = offsets(4, 0.03)
    kinematics = kinematics_of(model)
    angles = kinematics.joint_angles(places)
    reached = np.array([kinematics.foot_offsets(pose.tolist()) for pose in angles])
    missed = np.linalg.norm((reached - places)[..., :2], axis=-1)

    assert legs.follows_grid == (False,) * 4
    assert legs_of(model_robot(mixed_model(), "own")).follows_grid == (True,) * 6
    assert np.isfinite(angles).all()
    assert np.abs(reached - places)[..., 2].max() < 0.002
    assert 0.005 < missed.max() < 0.09
    # No place beside is nearer: a small turn of any joint leads away from it.
    for change in np.eye(8) * 1e-3:
        for sign in (-1, 1):
            other = np.array(kinematics.foot_offsets((angles[0] + sign * change).tolist()))
            weights = np.array((1, 1, 8))
            missed_distance, near = (
                (offset - places[0]) * weights for offset in (reached[0], other)
            )
            assert (near**2).sum() >= (missed_distance**2).sum() - 1e-9


def test_reach_ends_where_the_links_end() -> None:
    robot = model_robot(quadruped_model(), "own")
    gait: Gait = resolve("trot", robot.azimuths_deg)

    assert check_reach(robot, gait, FootGrid(usual_grid_side_m(robot, "trot"))) is None
    with pytest.raises(Unreachable, match="leg 1 cannot reach cell 1"):
        check_reach(robot, gait, FootGrid(0.7))


def test_a_foot_that_cannot_stand_with_the_others_is_named() -> None:
    model = quadruped_model()
    links = list(model.links)
    links[1] = replace(links[1], at_m=(0.05, 0.19, 0.5))
    with pytest.raises(ImpossibleLegs, match="the foot of leg 1 cannot stand on one plane"):
        legs_of(model_robot(replace(model, links=tuple(links)), "own"))
