"""The motion of a step, reconstructed from the servo commands by forward kinematics."""

import numpy as np
import pytest

from hexapods.domain.feet import Feet, StepLaw
from hexapods.domain.gait import PAPER_GAITS, GaitSpec, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import JOINT_LIMITS_RAD
from hexapods.domain.motion import StepMotion, StepPlan, ease, recorded_substeps
from hexapods.domain.robot import Robot, robot
from hexapods.domain.types import Action, FloatArray

SWING, SHIFT = 50, 30
FRONT_LEFT, FRONT_RIGHT, BACK_LEFT = 1, 2, 3

every_gait = pytest.mark.parametrize("gait", PAPER_GAITS)


def motion_of(gait: str, robot: Robot | None = None) -> StepMotion:
    robot = robot or Robot()
    resolved = resolve(gait, robot.azimuths_deg)
    return StepMotion(robot, resolved, StepLaw(resolved, FootGrid(), None))


def third_step(motion: StepMotion) -> StepPlan:
    """Plan a third step, when feet are off their cells: pair 1 from front left to back left."""
    feet = motion.plan(Feet.at_home(3), Action(1, FRONT_LEFT)).end
    feet = motion.plan(feet, Action(0, FRONT_RIGHT)).end
    return motion.plan(feet, Action(1, BACK_LEFT))


def feet_over_time(motion: StepMotion, plan: StepPlan) -> FloatArray:
    """Return the foot offsets from home in the robot frame [m], (substeps, legs, 3)."""
    targets = motion.joint_targets([plan])[0]
    return np.array([motion.kinematics.foot_offsets(row.tolist()) for row in targets])


@every_gait
def test_a_pair_swings_from_its_position_over_the_midpoint_to_its_cell(gait: str) -> None:
    motion = motion_of(gait)
    plan = third_step(motion)
    leader, partner = (leg - 1 for leg in resolve(gait, Robot().azimuths_deg).groups[1])
    feet = feet_over_time(motion, plan)
    from_x, from_y = plan.start.lateral_m[1], plan.start.forward_m[1]
    half_way, landed = SWING // 2 - 1, SWING - 1

    middle = ((from_x - 0.02) / 2, (from_y - 0.02) / 2, 0.03)
    assert feet[half_way, leader] == pytest.approx(middle)
    assert feet[landed, leader] == pytest.approx((-0.02, -0.02, 0), abs=1e-12)
    for substep in range(SWING):
        x, y, z = feet[substep, leader]
        assert feet[substep, partner] == pytest.approx((-x, y, z), abs=1e-12)
    heights = feet[:SWING, leader, 2]
    assert heights.max() == pytest.approx(0.03)
    assert (heights[:-1] > 0).all()


@every_gait
def test_four_feet_stand_still_while_two_swing(gait: str) -> None:
    motion = motion_of(gait)
    pairs = resolve(gait, Robot().azimuths_deg).groups
    plan = third_step(motion)
    feet = feet_over_time(motion, plan)

    for pair in (0, 2):
        x, y = plan.start.lateral_m[pair], plan.start.forward_m[pair]
        for leg, side in zip(pairs[pair], (1, -1), strict=True):
            standing = feet[:SWING, leg - 1]
            assert (standing == standing[0]).all()
            assert standing[0] == pytest.approx((side * x, y, 0), abs=1e-12)


@every_gait
def test_the_shift_centres_the_body_over_six_planted_feet(gait: str) -> None:
    motion = motion_of(gait)
    plan = third_step(motion)
    feet = feet_over_time(motion, plan)
    shift = feet[SWING - 1 :]  # from touch-down

    assert len(feet) == SWING + SHIFT
    assert shift[..., 2] == pytest.approx(0, abs=1e-12)
    moved = shift - shift[0]
    assert moved == pytest.approx(np.repeat(moved[:, :1], 6, axis=1), abs=1e-12)  # all feet alike
    assert shift[0].mean(axis=0)[:2] == pytest.approx((0, plan.advance_m), abs=1e-12)
    assert shift[-1].mean(axis=0) == pytest.approx((0, 0, 0), abs=1e-12)
    assert moved[-1, 0] == pytest.approx((0, -plan.advance_m, 0), abs=1e-12)


@pytest.mark.parametrize("legs", [4, 6, 8, 10])
def test_joint_targets_of_a_batch_equal_single_ones_to_the_last_bit(legs: int) -> None:
    motion = motion_of("left-right-vertical", robot({"n_legs": legs}))
    feet = motion.plan(Feet.at_home(legs // 2), Action(1, FRONT_LEFT)).end
    plans = [motion.plan(feet, Action(p, c)) for p in range(legs // 2) for c in range(5)]
    together = motion.joint_targets(plans)

    assert together.shape == (5 * legs // 2, SWING + SHIFT, 3 * legs)
    for plan, row in zip(plans, together, strict=True):
        assert (motion.joint_targets([plan])[0] == row).all()
    assert (motion.joint_targets(plans[3:7]) == together[3:7]).all()


def test_commands_stay_within_the_joints_limits_over_many_random_steps() -> None:
    motion, rng = motion_of("left-right-origin"), np.random.default_rng(0)
    feet, plans = Feet.at_home(3), []
    for _ in range(200):
        plan = motion.plan(feet, Action(int(rng.integers(3)), int(rng.integers(5))))
        feet = plan.end
        plans.append(plan)
    targets = motion.joint_targets(plans).reshape(-1, 6, 3)

    for joint, (low, high) in enumerate(JOINT_LIMITS_RAD.values()):
        assert targets[..., joint].min() > low
        assert targets[..., joint].max() < high


def test_commands_start_and_end_each_phase_at_rest() -> None:
    motion = motion_of("left-right-origin")
    foot = feet_over_time(motion, third_step(motion))[:, 1, 1]  # forward, of a leg that swings
    speed = np.abs(np.diff(foot))

    assert speed[0] < 0.2 * speed[: SWING - 1].max()
    assert speed[SWING - 2] < 0.2 * speed[: SWING - 1].max()
    assert speed[-1] < 0.2 * speed[SWING:].max()


def test_wanted_substeps_have_the_commands_of_all_to_the_last_bit() -> None:
    robot, whole = Robot(shift_s=0.128), motion_of("left-right-origin", Robot(shift_s=0.128))
    gait, wanted = resolve("left-right-origin", robot.azimuths_deg), recorded_substeps(robot)
    recorded = StepMotion(robot, gait, StepLaw(gait, FootGrid(), None), wanted)
    plans = [
        whole.plan(Feet.at_home(3), Action(pair, cell)) for pair in (0, 1, 2) for cell in (1, 4)
    ]

    for plan in plans:
        recorded_targets, all_of_it = recorded.joint_targets([plan]), whole.joint_targets([plan])
        assert np.array_equal(recorded_targets, all_of_it[:, wanted])
    assert np.array_equal(recorded.joint_targets(plans), whole.joint_targets(plans)[:, wanted])


def test_ease_runs_from_0_to_1() -> None:
    assert ease(np.array([0, 0.5, 1])) == pytest.approx([0, 0.5, 1])


def test_recorded_substeps_are_20_ms_apart_and_include_the_last() -> None:
    assert recorded_substeps(Robot()).tolist() == list(range(4, 80, 5))
    assert recorded_substeps(Robot(shift_s=0.128))[-2:].tolist() == [79, 81]


def test_groups_of_any_sizes_swing_while_the_others_stand() -> None:
    """Also in one batch; a foot on the axis does not move sideways."""
    robot = Robot()
    gait = resolve(GaitSpec(1, 3, groups=((2, 1, 3), (4, 6), (5,))), robot.azimuths_deg)
    motion = StepMotion(robot, gait, StepLaw(gait, FootGrid(), None))
    plans = [motion.plan(Feet.at_home(3), Action(group, FRONT_LEFT)) for group in range(3)]
    together = motion.joint_targets(plans)

    for plan, targets in zip(plans, together, strict=True):
        assert (motion.joint_targets([plan])[0] == targets).all()
        feet = np.array([motion.kinematics.foot_offsets(row.tolist()) for row in targets])
        lifted = feet[: SWING - 1, :, 2].max(axis=0) > 0.02
        assert np.flatnonzero(lifted).tolist() == sorted(leg - 1 for leg in gait.groups[plan.group])
        landed = feet[SWING - 1, lifted]
        sides = np.array(gait.mirror)[lifted]
        assert landed[:, 0] == pytest.approx(-0.02 * sides, abs=1e-9)
        assert landed[:, 1] == pytest.approx(0.02)
    assert gait.mirror == (1, 0, -1, -1, 0, 1)
