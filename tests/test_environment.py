"""The Gymnasium environment is the product's walking problem, and follows Gymnasium's API."""

import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hexapods.environment  # registers it
from hexapods.assembly import build_learner, build_simulator
from hexapods.domain.disturbance_documents import parse_disturbance
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import robot
from hexapods.domain.types import Action
from hexapods.domain.world import World
from hexapods.runs.config import training_config
from hexapods.runs.records import StepTaken
from hexapods.runs.training import train

ICE_UPHILL = ["friction:value=0.1", "slope:degrees=4"]
DISTURBED = ["sensor-noise:sd_m=0.01", "limp:legs=1,4:at=10"]


def make(**settings: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("RacingHexapods/Walk-v0", **settings)


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"gait": "front-back-vertical", "robot": "compliant", "observation": "commanded"},
        {"simulator": "kinematic", "divisions": 3, "grid_side_m": 0.03},
        {"simulator": "kinematic", "robot": {"n_legs": 8}},
        {"world": "ice", "disturbances": DISTURBED, "tolerance": 0.02, "start_noise_m": 0.005},
        {"simulator": "kinematic", "reward": "track"},
        {"render_mode": "rgb_array"},
    ],
    ids=[
        "default",
        "gait and robot",
        "a finer grid",
        "eight legs",
        "disturbed",
        "track",
        "rendered",
    ],
)
def test_it_passes_gymnasiums_check_env_without_a_warning(settings: dict[str, Any]) -> None:
    check_env(make(**settings).unwrapped)  # which renders in every declared mode, too


@pytest.mark.parametrize(
    "settings",
    [
        {"gait": "left-right-vertical", "robot": robot("compliant")},
        {"gait": "front-back-origin", "simulator": "kinematic", "observation": "commanded"},
        {"gait": "left-right-origin", "simulator": "kinematic", "divisions": 3},
        {
            "gait": "left-right-origin",
            "world": World(tuple(map(parse_disturbance, DISTURBED))),
            "tolerance": 0.03,
        },
    ],
    ids=["mujoco", "commanded", "a finer grid", "disturbed"],
)
def test_each_step_equals_that_of_a_training_to_the_last_bit(settings: dict[str, Any]) -> None:
    config = training_config(**settings, steps=60, seed=7, evaluate_every=0)
    walk = make(**settings, max_episode_steps=60)
    observation, info = walk.reset(seed=7)
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
        ({"world": "swamp"}, "unknown"),
        ({"disturbances": "ice"}, "disturbances is a list"),
        ({"reward": "sideways"}, "reward must be forward, or track"),
        ({"tolerance": 0.9}, "tolerance must be a number"),
        ({"start_noise_m": 0.03}, r"start_noise_m must be a number from 0 to 0\.02"),
        ({"simulater": "mujoco"}, "argument of the environment .*; did you mean simulator?"),
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


def test_action_masks_are_the_legal_actions_as_maskable_ppo_asks_for_them() -> None:
    walks = gymnasium.vector.SyncVectorEnv([lambda: make(simulator="kinematic")] * 2)
    _, infos = walks.reset(seed=0)
    masks = walks.call("action_masks")

    assert [mask.dtype for mask in masks] == [bool, bool]
    assert np.array_equal(np.stack(masks), infos["action_mask"])
    walks.close()


def test_a_world_and_disturbances_are_those_of_a_training() -> None:
    by_name = make(world="ice", disturbances=["slope:degrees=4"]).unwrapped
    config = training_config(
        gait="left-right-origin", world=World(tuple(map(parse_disturbance, ICE_UPHILL)))
    )
    by_name.reset(seed=0)
    rewards_m = [by_name.step(2)[1], by_name.step(8)[1]]
    simulator = build_simulator(config)
    state, expected_m = simulator.rest(), []
    for action in (Action(0, 2), Action(1, 3)):
        state, reward_m, _ = simulator.step(state, action)
        expected_m.append(reward_m)

    assert rewards_m == expected_m


def test_a_robot_that_turns_earns_along_the_track_what_it_advances() -> None:
    turning = {"world": "stuck-leg", "disturbances": ["limp:legs=3"]}
    forward, track = make(**turning).unwrapped, make(**turning, reward="track").unwrapped
    for walk in (forward, track):
        walk.reset(seed=0)
    steps = [[walk.step(action) for action in (2, 8, 11, 1)] for walk in (forward, track)]
    earned_m = [[step[1] for step in of_walk] for of_walk in steps]
    info = steps[1][-1][4]

    assert np.cumsum(np.array(earned_m[1], float))[-1] == pytest.approx(
        info["distance_m"], abs=1e-12
    )
    assert info == steps[0][-1][4] | {"action_mask": info["action_mask"]}
    assert abs(info["heading_rad"]) > 1e-4
    assert earned_m[0] != earned_m[1]


def starts(walk: gymnasium.Env[Any, Any], *seeds: int | None) -> list[tuple[Any, ...]]:
    """The first observation and reward of an episode of each seed; None goes on without one."""
    return [(*walk.reset(seed=seed)[0].tolist(), walk.step(np.int64(2))[1]) for seed in seeds]


@pytest.mark.parametrize("simulator", ["kinematic", "mujoco"])
def test_start_noise_moves_the_feet_as_the_seed_says(simulator: str) -> None:
    walk = make(simulator=simulator, start_noise_m=0.02)
    first, second, third = starts(walk, 3, None, None)

    assert len({first, second, third}) == 3  # each episode starts somewhere else
    assert starts(walk, 3, None, None) == [first, second, third]
    assert starts(make(simulator=simulator, start_noise_m=0.02), 4) != [first]
    without = starts(make(simulator=simulator), 3, 4, None)
    assert len(set(without)) == 1


def test_the_robot_within_its_tolerance_is_drawn_by_the_seed() -> None:
    walk = make(tolerance=0.03)
    first, again, other = starts(walk, 1, None, 2)

    assert first == again != other  # without a seed the robot stays as it was drawn
    assert starts(walk, 1) == [first]


def test_pictures_show_the_robot_as_videos_do_and_follow_it() -> None:
    walk = make(render_mode="rgb_array")
    walk.reset(seed=0)
    standing: Any = walk.render()
    for action in (2, 7, 12):
        walk.step(action)
    walking: Any = walk.render()

    assert (standing.shape, standing.dtype) == ((360, 640, 3), np.uint8)
    assert not np.array_equal(standing, walking)
    assert len(np.unique(walking.reshape(-1, 3), axis=0)) > 100
    assert walk.metadata["render_fps"] == 1 / robot("stiff").step_s
    walk.close()


def test_each_of_several_environments_renders_its_own_robot() -> None:
    walks = gymnasium.vector.SyncVectorEnv([lambda: make(render_mode="rgb_array")] * 2)
    walks.reset(seed=0)
    walks.step(np.array([2, 3]))
    first, second = walks.render() or ()
    again, _ = walks.render() or ()

    assert not np.array_equal(first, second)
    assert np.array_equal(first, again)
    walks.close()


def test_workers_of_a_vector_environment_make_it() -> None:
    code = (
        "import gymnasium\n"
        "if __name__ == '__main__':\n"
        "    walks = gymnasium.make_vec('hexapods.environment:RacingHexapods/Walk-v0',"
        " num_envs=2, vectorization_mode='async', simulator='kinematic',"
        " vector_kwargs={'context': 'spawn'})\n"
        "    walks.reset(seed=0)\n"
        "    walks.step([2, 3])\n"
        "    walks.close()\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_an_unknown_render_mode_names_the_valid_ones() -> None:
    with pytest.raises(InvalidInput, match="unknown render mode 'human'; choose one of: rgb_array"):
        hexapods.environment.WalkEnv(render_mode="human")


@pytest.mark.parametrize(
    "program",
    [
        "import gymnasium; gymnasium.make('hexapods.environment:RacingHexapods/Walk-v0')",
        "import gymnasium, hexapods.environment; gymnasium.make('RacingHexapods/Walk-v0')",
        "import hexapods.environment, gymnasium; gymnasium.make('RacingHexapods/Walk-v0')",
    ],
)
def test_gymnasium_can_import_and_register_it_by_module_name(program: str) -> None:
    subprocess.run([sys.executable, "-W", "error", "-c", program], check=True, timeout=60)
