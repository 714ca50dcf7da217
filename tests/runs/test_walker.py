"""Walkers: from where a search plans if sensors are noisy, and the heading that agents read."""

import math
from typing import Any

import numpy as np
import pytest

from hexapods.assembly import build_simulator, build_walkers
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.posture import heading_deg
from hexapods.domain.types import Action
from hexapods.domain.world import UNDISTURBED, World, named_world
from hexapods.runs.config import WalkingProblem
from hexapods.runs.lane import lane_config
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.walker import FutureNode, Sensors, Walker

STUCK = named_world("stuck-leg")


def walkers(
    world: World = UNDISTURBED, *, simulator: Any = "kinematic", seed: int = 0
) -> list[Walker]:
    lanes = tuple(lane_config("greedy", plans_with=how) for how in (None, "nominal"))
    config = RaceConfig(
        gait="left-right-origin", simulator=simulator, lanes=lanes, world=world, seed=seed
    )
    return build_walkers(config, [None, None], threads=1)


def root_of(walker: Walker) -> FutureNode:
    assert walker.expand is not None
    return walker.expand.here


@pytest.mark.parametrize("simulator", ["kinematic", "mujoco"])
def test_a_search_plans_from_where_the_feet_are_measured(simulator: str) -> None:
    """Whatever its model knows: the sensors tell it the same."""
    noisy = World((SensorNoise(sd_m=0.004),))
    for walker in walkers(noisy, simulator=simulator):
        for _ in range(3):
            walker.carry_out(walker.decide())
            root, true_m = root_of(walker), walker.simulator.group_offsets(walker.state)
            planned_from_m = walker.simulator.group_offsets(root.state)
            assert np.allclose(planned_from_m, root.offsets_m, atol=1e-9)  # one draw for all
            assert np.abs(np.subtract(planned_from_m, true_m)).max() > 0.001
            assert root.state.distance_m == walker.state.distance_m


def test_a_search_plans_from_the_true_state_where_sensors_are_exact() -> None:
    later = World((SensorNoise(sd_m=0.004, at_step=2, until_step=4),))
    for walker in (*walkers(), *walkers(later)):
        is_noisy = []
        for _ in range(5):
            is_noisy.append(root_of(walker).state is not walker.state)
            walker.carry_out(walker.decide())
        assert is_noisy == [walker.simulator.world == later and step in (2, 3) for step in range(5)]


def test_noise_makes_greedy_choose_other_steps() -> None:
    def distance_m(world: World, seed: int = 0) -> float:
        walker = walkers(world, seed=seed)[0]
        for _ in range(50):
            walker.carry_out(walker.decide())
        return float(walker.state.distance_m)

    noisy = World((SensorNoise(sd_m=0.02),))
    assert distance_m(noisy) < 0.95 * distance_m(World())
    assert distance_m(noisy) == distance_m(noisy) != distance_m(noisy, seed=1)


def test_the_heading_is_how_far_the_robot_has_turned_to_the_left() -> None:
    """Leg 2 is in front on the left: stuck, it no longer pushes there, and the robot turns."""
    simulator = build_simulator(WalkingProblem(gait="left-right-origin", world=STUCK))
    sensors = Sensors(simulator)
    at_rest_rad, state = sensors.heading_rad, simulator.rest()
    for step in range(12):
        state = simulator.step(state, Action(step % 3, 1 + step // 3 % 2)).state
    sensors.at(state)

    start, torso = (
        simulator.torso(simulator_state) for simulator_state in (simulator.rest(), state)
    )
    assert at_rest_rad == 0
    assert abs(sensors.heading_rad) > 0.01
    assert sensors.heading_rad == pytest.approx(math.radians(heading_deg(torso, start)))


def test_in_the_kinematic_simulator_no_robot_turns() -> None:
    walker = walkers()[0]
    sensors = Sensors(walker.simulator)
    sensors.at(walker.carry_out(walker.decide()).state)

    assert sensors.heading_rad == 0
