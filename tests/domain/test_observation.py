"""The observations of a state, and its legal actions."""

from dataclasses import replace

import pytest

from hexapods.domain.errors import UnknownName
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.observation import OBSERVATIONS, check_observation, legal_actions, observe
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.types import Action
from hexapods.physics.mujoco_simulator import MujocoSimulator

HOME, FRONT_LEFT, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT = range(5)


GAIT = resolve("left-right-origin", Robot().azimuths_deg)


@pytest.fixture
def simulator() -> KinematicSimulator:
    return KinematicSimulator(Robot(), GAIT, FootGrid())


def test_at_rest_every_observation_is_home(simulator: KinematicSimulator) -> None:
    for how in OBSERVATIONS:
        assert observe(simulator, simulator.rest(), how) == (HOME, HOME, HOME)


def test_the_observations_differ_once_the_body_has_moved(simulator: KinematicSimulator) -> None:
    state = simulator.rest()
    for action in ((0, FRONT_LEFT), (1, FRONT_LEFT), (2, BACK_RIGHT), (0, FRONT_RIGHT)):
        state = simulator.step(state, Action(*action)).state
    offsets = simulator.group_offsets(state)

    assert observe(simulator, state, "commanded") == (
        FRONT_RIGHT,
        FRONT_LEFT,
        BACK_RIGHT,
    )
    # The second pair was commanded to the front, and has drifted back since.
    assert offsets[1] == pytest.approx((-0.02, 0.02 * 32 / 81))
    assert observe(simulator, state, "measured") == tuple(
        simulator.grid.nearest(x, y) for x, y in offsets
    )


def test_a_pair_that_drifted_far_enough_is_measured_at_the_back(
    simulator: KinematicSimulator,
) -> None:
    state = simulator.step(simulator.rest(), Action(2, FRONT_LEFT)).state
    for step in range(6):
        state = simulator.step(state, Action(step % 2, FRONT_LEFT if step % 4 < 2 else 2)).state

    assert observe(simulator, state, "commanded")[2] == FRONT_LEFT
    assert observe(simulator, state, "measured")[2] == BACK_LEFT


def test_without_slip_the_feet_are_where_they_were_planned(simulator: KinematicSimulator) -> None:
    state = simulator.rest()
    for step in range(24):
        state = simulator.step(state, Action(step % 3, 1 + step % 4)).state
        assert observe(simulator, state, "planned") == observe(simulator, state, "measured")


def test_dead_reckoning_does_not_see_what_physics_did_to_the_feet() -> None:
    """Servos too weak to lift a leg leave the feet at home; the plan has them elsewhere."""
    weak = replace(PRESETS["stiff"], servo_kp=0.1, servo_torque_nm=0.01)
    real, ideal = (
        MujocoSimulator(weak, GAIT, FootGrid()),
        KinematicSimulator(weak, GAIT, FootGrid()),
    )
    state, plan = real.rest(), ideal.rest()
    for step in range(4):
        action = Action(step % 3, 1 + step)
        state, plan = real.step(state, action).state, ideal.step(plan, action).state

    assert observe(real, state, "planned") == observe(ideal, plan, "measured")
    assert observe(real, state, "measured") != observe(real, state, "planned")


def test_every_cell_but_the_observed_one_is_legal_for_each_pair() -> None:
    actions = legal_actions((HOME, FRONT_LEFT, BACK_RIGHT), 5)

    assert len(actions) == 12
    assert actions[:5] == ((0, 1), (0, 2), (0, 3), (0, 4), (1, 0))
    assert not {(0, HOME), (1, FRONT_LEFT), (2, BACK_RIGHT)} & set(actions)


def test_an_unknown_observation_names_the_valid_ones() -> None:
    check_observation("measured")
    with pytest.raises(UnknownName, match="observation 'guessed'; choose one of: measured, comma"):
        check_observation("guessed")
