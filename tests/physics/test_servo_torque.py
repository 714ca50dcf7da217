"""Torque and work of the servos, against MuJoCo's own forces and its balance of momentum."""

from copy import copy
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from hexapods.domain.disturbances import Limp
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.domain.world import UNDISTURBED, World
from hexapods.physics.mjcf import compile_model
from hexapods.physics.mujoco_simulator import MujocoSimulator
from hexapods.physics.servo_torque import servo_effort

TRIPLET = (Action(0, 1), Action(1, 1), Action(2, 2))


def walk(robot: Robot, world: World = UNDISTURBED, steps: int = 12) -> list[Motion]:
    """Return the motions of steps to the front edge, pair by pair."""
    simulator = MujocoSimulator(
        robot, resolve("left-right-origin", robot.azimuths_deg), FootGrid(), world=world
    )
    state, motions = simulator.rest(), []
    for number in range(steps):
        step = simulator.step(state, TRIPLET[number % 3], record=True, effort=True)
        assert step.motion is not None
        state = step.state
        motions.append(step.motion)
    return motions


def work_j(motions: list[Motion]) -> float:
    return sum(float(motion.work_j.sum()) for motion in motions if motion.work_j is not None)


@pytest.mark.parametrize("kv", [0.5, 1.0])
@pytest.mark.parametrize("limit_nm", [0.2, 1.5])
def test_the_torque_is_what_accelerates_the_joints(kv: float, limit_nm: float) -> None:
    """In the air, where nothing else acts: mass matrix times change of speed is all forces."""
    robot = Robot(servo_kv=kv, servo_torque_nm=limit_nm)
    model = copy(compile_model(robot))
    model.opt.gravity = 0
    data = mujoco.MjData(model)
    data.qpos[2] = 5
    data.qpos[7:] = np.tile([0.1, 0.2, -1.5], 6)
    target = np.tile([0.12, 0.21, -1.52], 6)
    mujoco.mj_forward(model, data)
    before = data.qvel.copy()
    inertia = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    data.ctrl = target
    mujoco.mj_step(model, data)
    acceleration = (data.qvel - before) / robot.dt_s
    total = inertia @ acceleration  # it stood still, so nothing else moves it
    damping = robot.joint_damping * data.qvel[6:]

    effort = servo_effort(
        model,
        target[None],
        data.qpos[None, 7:],
        data.qvel[None, 6:],
        speeds_before=before[6:],
        frames=np.array([0]),
    )
    is_free = np.abs(data.actuator_force) < limit_nm

    assert is_free.all() == (limit_nm == 1.5)
    assert effort.torque_nm[0][is_free] == pytest.approx(
        (total[6:] + damping)[is_free], rel=1e-3, abs=2e-3
    )
    assert np.abs(effort.torque_nm).max() <= limit_nm


@pytest.mark.parametrize("preset", ["stiff", "compliant"])
def test_work_is_that_of_mujocos_forces_in_fine_substeps(preset: str) -> None:
    """With an eighth of the time step `actuator_force` is right too, to some per cent."""
    robot = PRESETS[preset]
    fine = replace(robot, dt_s=robot.dt_s / 8)
    simulator = MujocoSimulator(fine, resolve("left-right-origin", fine.azimuths_deg), FootGrid())
    state, model = simulator.rest(), simulator.model
    data, by_mujoco_j = mujoco.MjData(model), 0.0
    for number in range(6):
        action = TRIPLET[number % 3]
        mujoco.mj_setState(model, data, state.row, mujoco.mjtState.mjSTATE_INTEGRATION.value)
        for target in simulator.commands([state], [action])[0]:
            speeds = data.qvel[6:].copy()
            data.ctrl = target
            mujoco.mj_step(model, data)
            power = data.actuator_force * (speeds + data.qvel[6:]) / 2
            by_mujoco_j += float(np.maximum(power, 0).sum()) * fine.dt_s
        state = simulator.step(state, action).state

    assert work_j(walk(robot, steps=6)) == pytest.approx(by_mujoco_j, rel=0.05)


def test_a_leg_without_power_does_no_work() -> None:
    motions = walk(Robot(), World((Limp(legs=(2,)),)), steps=3)
    torques = np.concatenate(
        [motion.torque_nm for motion in motions if motion.torque_nm is not None]
    )

    assert (torques[:, 3:6] == 0).all()
    assert np.abs(torques[:, :3]).max() > 0.1


def test_a_recording_keeps_the_largest_torque_of_each_frame_and_all_work() -> None:
    model = compile_model(Robot())
    angles, speeds = np.zeros((5, 18)), np.zeros((5, 18))
    targets = np.zeros((5, 18))
    targets[:, 0] = 0.01, -0.02, 0.015, 0.0, 0.03
    speeds[:, 0] = 0.1
    effort = servo_effort(
        model, targets, angles, speeds, speeds_before=speeds[0], frames=np.array([2, 4])
    )
    # kp is 40, kv 1, and at the beginning of each substep the angle is −0.004 s · 0.1 rad/s.
    torque = 40 * (targets[:, 0] + 0.0004) - 0.1

    assert effort.torque_nm[:, 0] == pytest.approx([torque[1], torque[4]], rel=1e-3)
    expected = np.maximum(torque * 0.1, 0) * 0.004
    assert effort.work_j == pytest.approx([expected[:3].sum(), expected[3:].sum()])
