"""The Gymnasium environment is the product's walking problem, and follows Gymnasium's API."""

import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hexapods.environment
from hexapods.assembly import build_learner
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import robot
from hexapods.runs.config import training_config
from hexapods.runs.records import StepTaken
from hexapods.runs.training import train

gymnasium.register_envs(hexapods.environment)


def make(**settings: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("RacingHexapods/Walk-v0", **settings)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"gait": "front-back-vertical", "robot": "compliant", "observation": "commanded"},
        {"simulator": "kinematic", "divisions": 3, "grid_side_m": 0.03},
        {"simulator": "kinematic", "robot": {"n_legs": 8}},
    ],
    ids=["as it comes", "another gait and robot", "a finer grid", "eight legs"],
)
def test_it_passes_gymnasiums_check_env_without_a_warning(settings: dict[str, Any]) -> None:
    check_env(make(**settings).unwrapped)


@pytest.mark.parametrize(
    "settings",
    [
        {"gait": "left-right-vertical", "robot": robot("compliant")},
        {"gait": "front-back-origin", "simulator": "kinematic", "observation": "commanded"},
        {"gait": "left-right-origin", "simulator": "kinematic", "divisions": 3},
    ],
    ids=["mujoco", "commanded", "a finer grid"],
)
def test_each_step_equals_that_of_a_training_to_the_last_bit(settings: dict[str, Any]) -> None:
    config = training_config(**settings, steps=60, evaluate_every=0)
    walk = make(**settings, max_episode_steps=60)
    observation, info = walk.reset()
    for record in train(build_learner(config), config):
        if isinstance(record, StepTaken):
            assert tuple(observation) == record.observation
            number = record.action.group * len(config.grid) + record.action.cell
            assert info["action_mask"][number] == 1
            observation, reward_m, _, _, info = walk.step(number)
            assert (reward_m, info["distance_m"]) == (record.reward_m, record.distance_m)


def test_an_episode_has_the_length_of_a_race_and_starts_from_rest() -> None:
    walk = make(simulator="kinematic")
    walk.action_space.seed(0)
    start = walk.reset(seed=0)
    info, ended = start[1], False
    steps = 0
    while not ended:
        _, _, terminated, ended, info = walk.step(walk.action_space.sample(info["action_mask"]))
        steps += 1
        assert not terminated
    observation, info = walk.reset(seed=1)

    assert steps == 50
    assert observation.tolist() == start[0].tolist() == [0, 0, 0]
    assert info["distance_m"] == 0


def test_an_action_is_a_pair_and_a_cell() -> None:
    walk = make(simulator="kinematic", observation="commanded", divisions=3)
    walk.reset()
    observation, *_ = walk.step(1 * 9 + 5)

    assert isinstance(walk.action_space, gymnasium.spaces.Discrete)
    assert walk.action_space.n == 3 * 9
    assert observation.tolist() == [0, 5, 0]


def test_an_illegal_action_is_a_no_op_with_zero_reward_that_counts_as_a_step() -> None:
    walk = make(simulator="kinematic", max_episode_steps=2)
    walk.reset()
    moved, _, _, _, before = walk.step(2)  # the first pair to its second cell
    present = np.arange(3) * 5 + moved
    observation, reward_m, _, truncated, info = walk.step(present[0])

    assert np.flatnonzero(before["action_mask"] == 0).tolist() == present.tolist()
    assert before["distance_m"] > 0
    assert (reward_m, truncated) == (0.0, True)
    assert observation.tolist() == moved.tolist()
    assert info["distance_m"] == before["distance_m"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"gait": "gallop"}, "unknown gait 'gallop'; choose one of: left-right-origin"),
        ({"robot": "rusty"}, "unknown robot 'rusty'; choose one of: stiff"),
        ({"simulator": "dream"}, "unknown simulator 'dream'; choose one of: mujoco, kinematic"),
        ({"observation": "guessed"}, "unknown observation 'guessed'; choose one of: measured"),
        ({"divisions": 1}, "divisions must be a whole number from 2 to 8"),
        ({"grid_side_m": 0.5}, "leg 1"),
    ],
)
def test_an_invalid_setting_names_the_valid_values(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        make(**settings)


@pytest.mark.parametrize("action", [-1, 15, 0.5, None])
def test_an_action_out_of_range_names_the_action_space(action: Any) -> None:
    walk = make(simulator="kinematic").unwrapped
    walk.reset()
    with pytest.raises(InvalidInput, match=r"an action is one of Discrete\(15\)"):
        walk.step(action)


def test_gymnasium_can_import_and_register_it_by_module_name() -> None:
    code = "import gymnasium; gymnasium.make('hexapods.environment:RacingHexapods/Walk-v0')"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, timeout=60)
