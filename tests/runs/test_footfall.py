"""Footfalls from foot heights: hand-made cases, and against the contacts of MuJoCo."""

import mujoco
import numpy as np
import pytest

from hexapods.domain.disturbances import Lost, Rough
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.types import Action, FloatArray
from hexapods.domain.world import UNDISTURBED, World, named_world
from hexapods.physics.mujoco_simulator import MujocoSimulator
from hexapods.runs.footfall import CONTACT_M, clearances_m, clipped, duty_factor, stance_intervals


def test_a_foot_stands_between_the_times_at_which_it_crosses_the_threshold() -> None:
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    clearance = CONTACT_M + np.array([-0.001, 0.001, 0.003, -0.001, -0.002])

    assert stance_intervals(times, clearance) == [
        pytest.approx((0.0, 0.5)),
        pytest.approx((2.75, 4.0)),
    ]


@pytest.mark.parametrize(("clearance_m", "stance"), [(-0.001, [(0.0, 2.0)]), (0.01, [])])
def test_a_foot_that_never_moves_stands_all_the_time_or_never(
    clearance_m: float, stance: list[tuple[float, float]]
) -> None:
    assert stance_intervals(np.array([0.0, 1.0, 2.0]), np.full(3, clearance_m)) == stance


def test_the_duty_factor_is_the_share_of_stance_in_the_window() -> None:
    stance = [(0.0, 1.0), (1.5, 2.5), (3.0, 4.0)]

    assert clipped(stance, 0.5, 2.0) == [(0.5, 1.0), (1.5, 2.0)]
    assert duty_factor(stance, 0.5, 2.5) == pytest.approx(1.5 / 2)


def test_a_lost_leg_never_stands() -> None:
    simulator = _simulator(Robot(), world := World((Lost(legs=(2,), at_step=1),)))
    pose = simulator.pose(simulator.rest())
    clearance = clearances_m(Robot(), np.stack([pose] * 3), np.array([0, 0, 1]), world)

    assert (clearance[:2] < CONTACT_M).all()
    assert np.isinf(clearance[2]).tolist() == [False, True, False, False, False, False]
    times = np.array([0.0, 1.0, 2.0])
    assert stance_intervals(times, clearance[:, 1]) == [(0.0, 1.0)]
    assert stance_intervals(times, clearance[::-1, 1]) == [(0.0, 2.0)]


def _simulator(robot: Robot, world: World) -> MujocoSimulator:
    gait = resolve("left-right-origin", robot.azimuths_deg)
    return MujocoSimulator(robot, gait, FootGrid(), world=world)


def _contacts_and_clearances(robot: Robot, world: World) -> tuple[FloatArray, FloatArray]:
    """Walk 15 steps; return for each recorded frame which feet MuJoCo has on the ground."""
    simulator, walk = _simulator(robot, world), (Action(0, 1), Action(1, 1), Action(2, 2))
    state, model = simulator.rest(), simulator.model
    data, contacts, poses = mujoco.MjData(model), [], []
    feet = [model.geom(f"leg{leg}_foot").id for leg in range(1, 7)]
    for number in range(15):
        action = walk[number % 3]
        mujoco.mj_setState(model, data, state.row, mujoco.mjtState.mjSTATE_INTEGRATION.value)
        for substep, target in enumerate(simulator.commands([state], [action])[0]):
            data.ctrl = target
            mujoco.mj_step(model, data)
            if substep % 5 == 4:
                mujoco.mj_forward(model, data)
                touching = {geom for contact in data.contact for geom in contact.geom}
                contacts.append([foot in touching for foot in feet])
                poses.append(data.qpos.astype(np.float32))
        state = simulator.step(state, action).state
    steps = np.zeros(len(poses), int)
    return np.array(contacts), clearances_m(robot, np.array(poses, float), steps, world)


@pytest.mark.parametrize(
    ("robot", "world", "share"),
    [
        (PRESETS["stiff"], UNDISTURBED, 0.99),
        (PRESETS["compliant"], UNDISTURBED, 0.97),
        (PRESETS["stiff"], named_world("slope"), 0.99),
        (PRESETS["stiff"], World((Rough(amplitude_m=0.015, seed=0),)), 0.95),
    ],
)
def test_feet_stand_where_mujoco_has_contacts(robot: Robot, world: World, share: float) -> None:
    contacts, clearance = _contacts_and_clearances(robot, world)

    assert 0.5 < contacts.mean() < 0.9
    assert ((clearance < CONTACT_M) == contacts).mean() > share
