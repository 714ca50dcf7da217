"""The MuJoCo simulator: standing, slipping, threads, and the error on divergence."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from hexapods.domain.errors import Diverged
from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import legs_of
from hexapods.domain.observation import legal_actions
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.simulator import RewardKind
from hexapods.domain.types import Action, FloatArray
from hexapods.physics.mjcf import compile_model
from hexapods.physics.mujoco_simulator import MujocoSimulator, MujocoState


def build(
    gait: str = "left-right-origin",
    robot: Robot | None = None,
    threads: int = 1,
    reward: RewardKind = "forward",
) -> MujocoSimulator:
    robot = robot or Robot()
    gait_of_it = resolve(gait, robot.azimuths_deg)
    return MujocoSimulator(robot, gait_of_it, FootGrid(), threads, reward=reward)


def layer(simulator: MujocoSimulator) -> tuple[list[MujocoState], list[Action]]:
    """Return states and actions of the second layer of a two-step look-ahead: 144 transitions."""
    first = legal_actions((0, 0, 0), 5)
    states = simulator.expand([simulator.rest()] * 12, first).states
    pairs = [(s, a) for s in states for a in legal_actions(s.commanded, 5)]
    return [s for s, _ in pairs], [a for _, a in pairs]


@pytest.mark.test
def test_results_do_not_depend_on_the_number_of_threads() -> None:
    def rows(threads: int) -> tuple[bytes, bytes]:
        simulator = build(threads=threads)
        expansion = simulator.expand(*layer(simulator))
        return b"".join(s.row.tobytes() for s in expansion.states), expansion.rewards_m.tobytes()

    alone = rows(1)
    assert len(alone[1]) == 144 * 8
    assert rows(2) == alone
    assert rows(4) == alone
    assert rows(0) == alone


def data_at(simulator: MujocoSimulator, state: MujocoState) -> Any:
    data = mujoco.MjData(simulator.model)
    mujoco.mj_setState(simulator.model, data, state.row, mujoco.mjtState.mjSTATE_INTEGRATION.value)
    mujoco.mj_forward(simulator.model, data)
    return data


def feet_of(data: Any, legs: int = 6) -> FloatArray:
    return np.array([data.body(f"leg{leg}_foot").xpos for leg in range(1, legs + 1)])


@pytest.mark.parametrize("gait", PAPER_GAITS)
@pytest.mark.parametrize("preset", ["stiff", "compliant", "slippery"])
def test_the_home_pose_stands_still(gait: str, preset: str) -> None:
    simulator = build(gait, PRESETS[preset])
    data = data_at(simulator, simulator.rest())
    start, feet = data.qpos.copy(), feet_of(data)
    for _ in range(500):
        mujoco.mj_step(simulator.model, data)

    assert np.abs(data.qpos[:3] - start[:3]).max() < 2e-4  # 0.2 mm in two seconds
    assert np.abs(data.qpos[3:7] - start[3:7]).max() < 1e-6
    assert np.abs(data.qvel).max() < 1e-3
    assert np.abs(feet_of(data) - feet).max() < 2e-4
    assert data.time == pytest.approx(2.0)


@pytest.mark.parametrize("gait", PAPER_GAITS)
def test_forward_kinematics_in_the_world_are_those_of_the_model(gait: str) -> None:
    body = robot({"n_legs": 8, "coxa_m": 0.04, "mount_radius_m": 0.12})
    simulator = build(gait, body)
    data = mujoco.MjData(simulator.model)
    rng = np.random.default_rng(0)
    data.qpos[:] = [0.3, -2.0, 0.2, *rng.normal(size=4), *rng.uniform(-1, 0, 24)]
    data.qpos[3:7] /= np.linalg.norm(data.qpos[3:7])
    mujoco.mj_kinematics(simulator.model, data)

    assert legs_of(body).foot_positions(data.qpos[None])[0] == pytest.approx(
        feet_of(data, 8), abs=1e-9
    )


@pytest.mark.parametrize("legs", [4, 6, 8])
def test_feet_stand_on_the_ground_and_do_not_sink(legs: int) -> None:
    simulator = build(robot=robot({"n_legs": legs}))
    data = data_at(simulator, simulator.rest())

    assert data.ncon == legs
    # MuJoCo's contacts are soft: a foot presses in until they carry the weight, about 1 mm.
    assert feet_of(data, legs)[:, 2] == pytest.approx(0.012, abs=1.2e-3)
    carried = sum(float(_force(simulator, data, i)[0]) for i in range(data.ncon))
    weight = 9.81 * (1.2 + 0.16 * legs)
    assert carried == pytest.approx(weight, rel=1e-3)


def _force(simulator: MujocoSimulator, data: Any, contact: int) -> FloatArray:
    force = np.zeros(6)
    mujoco.mj_contactForce(simulator.model, data, contact, force)
    return force


def test_feet_do_not_sink_after_walking() -> None:
    simulator = build("front-back-vertical")
    state = simulator.rest()
    for step in range(24):
        state = simulator.step(state, Action(step % 3, 1 + step // 3 % 2)).state
    feet = feet_of(data_at(simulator, state))

    assert feet[:, 2] == pytest.approx(0.012, abs=2e-3)
    assert state.distance_m == pytest.approx(24 * 0.01, rel=0.1)


def test_the_torso_stays_level_and_on_course_with_stiff_servos() -> None:
    simulator = build("left-right-origin")
    state = simulator.rest()
    for step in range(24):
        state = simulator.step(state, Action(step % 3, 1 + step // 3 % 2)).state
    x, y, z, *_ = simulator.pose(state)

    assert y == state.distance_m
    assert abs(x) < 0.02
    assert z == pytest.approx(0.102, abs=5e-3)


def test_reward_is_measured_not_commanded() -> None:
    """With low friction the feet slip, so that the body moves less than planned."""
    gripping, slipping = build(), build(robot=Robot(friction=0.02))
    firm, loose = (s.step(s.rest(), Action(0, 1)).reward_m for s in (gripping, slipping))

    assert firm == pytest.approx(0.02 / 3, rel=0.1)
    assert abs(loose - firm) > 2e-4


def test_reward_is_along_the_robots_heading_or_along_the_track() -> None:
    """A robot that stands across the track earns along its heading only."""
    simulators = build(), build(reward="track")
    forward, track = (s.step(s.rest(), Action(0, 1)) for s in simulators)
    across = turned(simulators[0].rest(), 90)
    earned_m = [s.step(across, Action(0, 1)) for s in simulators]

    assert track.reward_m == track.state.distance_m == pytest.approx(forward.reward_m, rel=1e-3)
    assert earned_m[0].reward_m == pytest.approx(forward.reward_m, rel=0.01)
    assert abs(earned_m[1].reward_m) < 0.05 * forward.reward_m
    assert [step.reward_m for step in earned_m] == [
        s.expand([across], [Action(0, 1)]).rewards_m[0] for s in simulators
    ]


def turned(state: MujocoState, degrees: float) -> MujocoState:
    """Turn a robot at rest about the vertical, anticlockwise."""
    row, half = state.row.copy(), math.radians(degrees) / 2
    w, z = row[4], row[7]
    row[4] = math.cos(half) * w - math.sin(half) * z
    row[7] = math.cos(half) * z + math.sin(half) * w
    return replace(state, row=row)


def corrupted(state: MujocoState, value: float) -> MujocoState:
    row = state.row.copy()
    row[9] = value  # a joint angle
    return replace(state, row=row, steps=41)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e20])
def test_diverged_physics_names_the_step(value: float) -> None:
    simulator = build()
    broken = corrupted(simulator.rest(), value)
    with pytest.raises(
        Diverged, match=r"the physics diverged at step 42; try a smaller robot.dt_s"
    ):
        simulator.step(broken, Action(0, 1))


def test_a_single_diverged_simulation_of_a_batch_is_detected() -> None:
    simulator = build(threads=2)
    rest = simulator.rest()
    states = [rest] * 5 + [corrupted(rest, np.nan)] + [rest] * 6
    with pytest.raises(Diverged, match="at step 42"):
        simulator.expand(states, legal_actions((0, 0, 0), 5))


def test_the_simulator_gives_the_same_results_after_an_error() -> None:
    simulator = build()
    expected = simulator.step(simulator.rest(), Action(2, 2))
    with pytest.raises(Diverged):
        simulator.step(corrupted(simulator.rest(), np.nan), Action(0, 1))
    again = simulator.step(simulator.rest(), Action(2, 2))

    assert again.state.row.tobytes() == expected.state.row.tobytes()


def test_mujoco_leaves_no_log_in_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    simulator = build(threads=2)
    rest = simulator.rest()
    with pytest.raises(Diverged):
        simulator.step(corrupted(rest, np.nan), Action(0, 1))
    with pytest.raises(Diverged):
        simulator.expand([corrupted(rest, np.nan)] * 12, legal_actions((0, 0, 0), 5))

    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def test_the_state_is_the_full_integration_state() -> None:
    """Continuing from less than mjSTATE_INTEGRATION would give other results."""
    simulator = build()
    whole = mujoco.mj_stateSize(simulator.model, mujoco.mjtState.mjSTATE_INTEGRATION.value)

    assert simulator.rest().row.shape == (whole,)
    assert simulator.rest().row[0] == 0  # time starts with the run


def test_models_are_cached() -> None:
    assert build().model is build("front-back-origin").model is compile_model(Robot())


def test_estimate_keeps_velocities_and_joint_limits() -> None:
    """A foot that seems to be half a metre away is out of reach: the joints stay where they are."""
    simulator = build()
    state = simulator.step(simulator.rest(), Action(0, 1)).state
    near, far = (simulator.estimate(state, np.full((3, 2), by_m)) for by_m in (0.004, 0.5))
    joints = slice(8, 8 + simulator.model.nu)

    assert np.array_equal(far.row, state.row)
    assert not np.allclose(near.row[joints], state.row[joints], atol=0.01)
    assert np.array_equal(np.delete(near.row, joints), np.delete(state.row, joints))
    (end,), (reward_m,) = simulator.expand([near], [Action(1, 1)])
    assert np.isfinite(end.row).all()
    assert abs(reward_m) < 0.03
