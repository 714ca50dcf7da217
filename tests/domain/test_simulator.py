"""Conformance tests of the simulator protocol, on both simulators."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hexapods.domain.gait import PAPER_GAITS, resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.kinematics import legs_of
from hexapods.domain.observation import legal_actions, observe
from hexapods.domain.robot import Robot, robot
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import Action
from hexapods.physics.mujoco_simulator import MujocoSimulator

Build = Callable[..., Simulator[Any]]


@pytest.fixture(params=[KinematicSimulator, MujocoSimulator], ids=["kinematic", "mujoco"])
def build(request: pytest.FixtureRequest) -> Build:
    def build(
        gait: str = "left-right-origin", robot: Robot | None = None, divisions: int = 2
    ) -> Simulator[Any]:
        robot = robot or Robot()
        simulator: Simulator[Any] = request.param(
            robot, resolve(gait, robot.azimuths_deg), FootGrid(divisions=divisions)
        )
        return simulator

    return build


@pytest.fixture
def simulator(build: Build) -> Simulator[Any]:
    return build()


def walk(simulator: Simulator[Any], state: Any, steps: int, seed: int = 0) -> list[Any]:
    """Walk by random legal actions; return the states."""
    rng, states = np.random.default_rng(seed), []
    for _ in range(steps):
        legal = legal_actions(observe(simulator, state, "commanded"), len(simulator.grid))
        state = simulator.step(state, legal[int(rng.integers(len(legal)))]).state
        states.append(state)
    return states


def bits(simulator: Simulator[Any], state: Any) -> dict[str, bytes]:
    """Return the bytes of all arrays of a state."""
    return {name: array.tobytes() for name, array in simulator.dump(state).items()}


def test_rest_is_on_the_start_line_with_every_foot_at_home(build: Build) -> None:
    for gait in PAPER_GAITS:
        simulator = build(gait)
        rest = simulator.rest()

        assert (rest.distance_m, rest.steps, rest.commanded) == (0, 0, (0, 0, 0))
        assert np.allclose(simulator.group_offsets(rest), 0, atol=1e-3)
        assert observe(simulator, rest, "measured") == (0, 0, 0)


@pytest.mark.parametrize("gait", PAPER_GAITS)
def test_the_robot_faces_along_the_track(build: Build, gait: str) -> None:
    """The gait's forward direction is world +y."""
    simulator = build(gait)
    pose = simulator.pose(simulator.rest())
    half_yaw = np.arctan2(pose[6], pose[3])
    heading = 2 * np.rad2deg(half_yaw) + simulator.gait.forward_deg

    assert pose.shape == (7 + 18,)
    assert pose[:2] == pytest.approx((0, 0), abs=1e-9)
    assert pose[2] == pytest.approx(0.09 + 0.012, abs=2e-3)
    assert heading == pytest.approx(90, abs=0.1)


def test_the_pose_holds_the_joint_angles_of_the_legs_in_order(simulator: Simulator[Any]) -> None:
    state = walk(simulator, simulator.rest(), 5)[-1]
    angles = simulator.pose(state)[7:].tolist()
    feet = legs_of(simulator.robot).under(simulator.gait).foot_offsets(angles)

    for (leader, partner), (x, y) in zip(
        simulator.gait.groups, simulator.group_offsets(state), strict=True
    ):
        (right, forward, _), (left, as_forward, _) = feet[leader - 1], feet[partner - 1]
        assert (right - left) / 2 == pytest.approx(x, abs=1e-12)
        assert (forward + as_forward) / 2 == pytest.approx(y, abs=1e-12)


def test_a_step_moves_the_commanded_pair_and_counts(simulator: Simulator[Any]) -> None:
    state = simulator.step(simulator.rest(), Action(1, 2)).state
    offsets = np.array(simulator.group_offsets(state))

    assert state.commanded == (0, 2, 0)
    assert state.steps == 1
    expected = np.array([(0, -1 / 3), (1, 2 / 3), (0, -1 / 3)]) * 0.02
    assert np.allclose(offsets, expected, atol=2e-3)


def test_the_reward_is_the_bodys_displacement(simulator: Simulator[Any]) -> None:
    first = simulator.step(simulator.rest(), Action(1, 2))

    assert first.reward_m == pytest.approx(first.state.distance_m, abs=1e-5)
    assert first.reward_m == pytest.approx(0.02 / 3, rel=0.15)
    assert simulator.step(simulator.rest(), Action(1, 4)).reward_m < 0


def test_steps_are_deterministic_to_the_last_bit(build: Build) -> None:
    first, second = build(), build()
    states = walk(first, first.rest(), 12)

    assert [bits(first, s) for s in states] == [
        bits(second, s) for s in walk(second, second.rest(), 12)
    ]
    assert [bits(first, s) for s in states] == [
        bits(first, s) for s in walk(first, first.rest(), 12)
    ]


@pytest.mark.test
@pytest.mark.parametrize("divisions", [2, 3])
def test_expand_equals_step_to_the_last_bit(build: Build, divisions: int) -> None:
    simulator = build("left-right-vertical", divisions=divisions)
    states = [simulator.rest(), *walk(simulator, simulator.rest(), 4)]
    futures = [
        (state, action)
        for state in states
        for action in legal_actions(state.commanded, len(simulator.grid))
    ]
    # Batches that grow and shrink, to detect state left behind by an earlier call.
    for some in (futures[:7], futures, futures[11:14], futures[-1:]):
        expansion = simulator.expand([s for s, _ in some], [a for _, a in some])
        assert expansion.rewards_m.shape == (len(some),)
        for (state, action), after, reward in zip(
            some, expansion.states, expansion.rewards_m, strict=True
        ):
            step = simulator.step(state, action)
            assert bits(simulator, after) == bits(simulator, step.state)
            assert float(reward) == step.reward_m


def test_expand_of_no_states_is_empty(simulator: Simulator[Any]) -> None:
    expansion = simulator.expand([], [])

    assert expansion.states == []
    assert expansion.rewards_m.shape == (0,)


def test_a_state_is_immutable(simulator: Simulator[Any]) -> None:
    state = walk(simulator, simulator.rest(), 3)[-1]
    before = bits(simulator, state)

    walk(simulator, state, 3)
    simulator.expand([state] * 3, [Action(p, 4) for p in range(3)])
    simulator.pose(state)[:] = 0
    for array in simulator.dump(state).values():
        array[:] = 0
    loaded = simulator.dump(state)
    copy = simulator.load(loaded)
    for array in loaded.values():
        array[:] = 0

    assert bits(simulator, state) == before
    assert bits(simulator, copy) == before
    with pytest.raises(AttributeError):
        state.distance_m = 1.0
    with pytest.raises(AttributeError):
        state.feet.forward_m = ()


def test_the_arrays_of_a_state_are_read_only(simulator: Simulator[Any]) -> None:
    state = walk(simulator, simulator.rest(), 1)[-1]
    arrays = [getattr(state, name) for name in type(state).__slots__]

    assert not any(a.flags.writeable for a in arrays if isinstance(a, np.ndarray))


def test_a_loaded_state_is_identical_and_continues_identically(build: Build) -> None:
    simulator, other = build(), build()
    middle = walk(simulator, simulator.rest(), 6)[-1]
    copy = other.load(simulator.dump(middle))

    assert bits(other, copy) == bits(simulator, middle)
    assert (copy.commanded, copy.distance_m, copy.steps) == (
        middle.commanded,
        middle.distance_m,
        middle.steps,
    )
    onward, again = (walk(s, m, 6, 1) for s, m in ((simulator, middle), (other, copy)))
    assert [bits(simulator, s) for s in onward] == [bits(other, s) for s in again]


@pytest.mark.parametrize(
    ("robot", "frames"), [(Robot(), 16), (Robot(shift_s=0.128), 17), (Robot(dt_s=0.002), 16)]
)
def test_a_recorded_step_has_fifty_poses_per_second(
    build: Build, robot: Robot, frames: int
) -> None:
    simulator = build(robot=robot)
    before = simulator.rest()
    step = simulator.step(before, Action(1, 2), record=True)
    assert step.motion is not None
    time_s, qpos, *_ = step.motion

    assert time_s.dtype == qpos.dtype == np.float32
    assert time_s.shape == (frames,)
    assert qpos.shape == (frames, 7 + 18)
    assert time_s[:16] == pytest.approx(np.arange(1, 17) * 0.02)
    assert time_s[-1] == pytest.approx(robot.step_s)
    assert (qpos[-1] == simulator.pose(step.state).astype(np.float32)).all()
    assert np.linalg.norm(qpos[:, 3:7], axis=1) == pytest.approx(1)
    assert np.abs(np.diff(qpos, axis=0)).max() < 0.35  # no jumps


def test_recording_does_not_change_the_step(simulator: Simulator[Any]) -> None:
    state = walk(simulator, simulator.rest(), 2)[-1]
    recorded, unrecorded = (simulator.step(state, Action(0, 3), record) for record in (True, False))

    assert unrecorded.motion is None
    assert bits(simulator, recorded.state) == bits(simulator, unrecorded.state)
    assert recorded.reward_m == unrecorded.reward_m


@pytest.mark.parametrize("legs", [4, 8, 10])
def test_the_number_of_legs_is_a_parameter(build: Build, legs: int) -> None:
    simulator = build("front-back-vertical", robot({"n_legs": legs}))
    state = simulator.rest()
    for step in range(12):
        state = simulator.step(state, Action(step % (legs // 2), 1 + step // 6 % 2)).state

    assert len(state.commanded) == len(simulator.group_offsets(state)) == legs // 2
    assert simulator.pose(state).shape == (7 + 3 * legs,)
    assert 0.03 < state.distance_m < 0.2


def test_estimate_has_the_feet_where_they_are_measured_and_all_else_as_it_is(
    build: Build,
) -> None:
    for gait in PAPER_GAITS:
        simulator = build(gait)
        (*_, state) = walk(simulator, simulator.rest(), 5)
        error_m = np.random.default_rng(0).normal(0, 0.004, (3, 2))
        true_m = np.array(simulator.group_offsets(state))

        estimate = simulator.estimate(state, error_m)

        assert np.allclose(simulator.group_offsets(estimate), true_m + error_m, atol=1e-9)
        assert np.array_equal(simulator.pose(estimate)[:7], simulator.pose(state)[:7])
        assert (estimate.distance_m, estimate.steps) == (state.distance_m, state.steps)
        assert estimate.commanded == state.commanded
        assert np.allclose(simulator.group_offsets(state), true_m, atol=0)


def test_estimate_without_an_error_is_the_state(build: Build, simulator: Simulator[Any]) -> None:
    (*_, state) = walk(simulator, simulator.rest(), 5)
    same = simulator.estimate(state, np.zeros((3, 2)))
    assert bits(simulator, same) == bits(simulator, state)
