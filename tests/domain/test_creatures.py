"""The robots that are built in: their legs, their dimensions, and how they walk."""

from typing import Any

import numpy as np
import pytest

from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import resolve
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematics import check_reach, legs_of
from hexapods.domain.observation import legal_in, observe
from hexapods.physics.mjcf import compile_model
from hexapods.physics.mujoco_simulator import MujocoSimulator

PAPER = ("stiff", "compliant", "slippery")
OTHERS = [name for name in CREATURES if name not in PAPER]


def test_creatures_have_three_to_twelve_legs_odd_numbers_too() -> None:
    legs = {name: len(CREATURES[name].robot.legs) for name in OTHERS}

    assert legs == {
        "ant": 6,
        "crab": 8,
        "spider": 8,
        "starfish": 5,
        "dog": 4,
        "centipede": 12,
        "freenove": 6,
        "phantomx": 6,
        "chica": 6,
    }


@pytest.mark.parametrize("name", OTHERS)
def test_bodies_are_symmetric_and_face_where_their_gait_goes(name: str) -> None:
    robot = CREATURES[name].robot
    gait = resolve(CREATURES[name].gait, robot.azimuths_deg)
    homes = legs_of(robot).under(gait).homes_m

    assert robot.name == name
    mirrored = {(round(-x, 9), round(y, 9)) for x, y in homes}
    assert mirrored == {(round(x, 9), round(y, 9)) for x, y in homes}
    assert gait.azimuths_deg[0] < 0 < gait.azimuths_deg[1]
    assert np.abs(gait.azimuths_deg[:2]).max() < 90


@pytest.mark.parametrize(
    ("name", "mass_kg", "coxa_height_m", "links_m"),
    [
        ("freenove", 2.0, 0.039, (0.033, 0.09, 0.11)),
        ("phantomx", 3.22, 0.105, (0.0529, 0.0618, 0.131)),
        ("chica", 2.25, 0.07, (0.043, 0.08, 0.134)),
    ],
)
def test_kits_have_their_dimensions_and_masses(
    name: str, mass_kg: float, coxa_height_m: float, links_m: tuple[float, ...]
) -> None:
    robot = CREATURES[name].robot

    assert float(compile_model(robot).body_mass.sum()) == pytest.approx(mass_kg)
    assert robot.body_height_m == coxa_height_m
    assert (robot.coxa_m, robot.femur_m, robot.tibia_m) == links_m
    assert "Guessed" in CREATURES[name].description


@pytest.mark.parametrize("name", OTHERS)
def test_every_creature_stands_still_and_level(name: str) -> None:
    creature = CREATURES[name]
    gait = resolve(creature.gait, creature.robot.azimuths_deg)
    simulator = MujocoSimulator(creature.robot, gait, FootGrid())
    _, _, z, w, x, y, around = simulator.torso(simulator.rest())

    assert z == pytest.approx(creature.robot.body_height_m + creature.robot.foot_radius_m, abs=0.01)
    assert 2 * (x * x + y * y) < 1e-4
    assert np.abs(simulator.group_offsets(simulator.rest())).max() < 0.01
    assert w * w + around * around == pytest.approx(1, abs=1e-4)


def greedy_m(name: str, steps: int) -> float:
    """Return how far a creature comes by the best next step."""
    creature = CREATURES[name]
    gait = resolve(creature.gait, creature.robot.azimuths_deg)
    simulator = MujocoSimulator(creature.robot, gait, FootGrid())
    state: Any = simulator.rest()
    for _ in range(steps):
        legal = legal_in(simulator, state, observe(simulator, state, "measured"))
        expansion = simulator.expand([state] * len(legal), legal)
        state = expansion.states[int(expansion.rewards_m.argmax())]
    return float(state.distance_m)


@pytest.mark.parametrize("name", OTHERS)
def test_every_creature_walks_by_the_law(name: str) -> None:
    """2 h / (G (1 + Σ w²)) a step, w the groups' shares of the feet; the first steps are longer."""
    robot = CREATURES[name].robot
    gait = resolve(CREATURES[name].gait, robot.azimuths_deg)
    shares = np.array(gait.sizes) / len(robot.legs)
    law_m = 0.04 / (len(shares) * (1 + float((shares**2).sum())))

    assert check_reach(robot, gait, FootGrid()) is None
    assert greedy_m(name, 12) / 12 == pytest.approx(law_m, rel=0.15)
