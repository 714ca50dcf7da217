"""The kinematic simulator follows the kinematic law exactly."""

import numpy as np
import pytest

from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.robot import Robot
from hexapods.domain.types import Action

FRONT_LEFT, FRONT_RIGHT = 1, 2
H = 0.02


@pytest.fixture
def simulator() -> KinematicSimulator:
    gait = resolve("front-back-vertical", Robot().azimuths_deg)
    return KinematicSimulator(Robot(), gait, FootGrid())


def test_the_first_step_to_the_front_earns_a_third_of_h(simulator: KinematicSimulator) -> None:
    step = simulator.step(simulator.rest(), Action(0, FRONT_LEFT))

    assert step.reward_m == pytest.approx(H / 3)
    assert step.state.distance_m == step.reward_m


def test_swapping_sides_at_the_front_earns_half_of_h_per_step_indefinitely(
    simulator: KinematicSimulator,
) -> None:
    """With the observation `commanded`, in which a pair's commanded cell is illegal."""
    state, reward = simulator.rest(), 0.0
    for step in range(60):
        cell = FRONT_LEFT if step % 6 < 3 else FRONT_RIGHT
        state, reward, _ = simulator.step(state, Action(step % 3, cell))

    assert reward == pytest.approx(H / 2)


def test_the_distance_is_the_sum_of_the_rewards(simulator: KinematicSimulator) -> None:
    rng, state, total = np.random.default_rng(3), simulator.rest(), 0.0
    for _ in range(100):
        state, reward, _ = simulator.step(state, Action(int(rng.integers(3)), int(rng.integers(5))))
        total += reward

    assert state.distance_m == total


def test_the_recorded_body_stays_upright_and_eases_into_the_shift(
    simulator: KinematicSimulator,
) -> None:
    motion = simulator.step(simulator.rest(), Action(0, FRONT_LEFT), record=True).motion
    assert motion is not None
    forward, height = motion.qpos[:, 1], motion.qpos[:, 2]

    assert (forward[motion.time_s <= 0.2] == 0).all()
    assert (np.diff(forward[motion.time_s > 0.2]) > 0).all()
    assert height == pytest.approx(0.09 + 0.012)


def test_a_robot_that_cannot_reach_its_grid_is_refused() -> None:
    with pytest.raises(Unreachable, match="leg 1 cannot reach cell"):
        KinematicSimulator(
            Robot(), resolve("left-right-origin", Robot().azimuths_deg), FootGrid(0.3)
        )
