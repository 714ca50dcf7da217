"""The plan of an experiment: all of its trials, each with a unique key and seed."""

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hexapods.agents.registry import BUILT_IN
from hexapods.domain.errors import HexapodError
from hexapods.domain.robot import robot
from hexapods.experiments.config import experiment_config
from hexapods.experiments.plan import Plan, trial_seed


def plan(experiment: str, **values: Any) -> Plan:
    return Plan(experiment_config(experiment, values))


@pytest.mark.parametrize(
    ("experiment", "seeds", "roles"),
    [
        # 4 gaits × 2 readings × 2 robots: greedy and two-step, two practices, one race by the wall
        ("table1", 30, {"reference": 32, "learner": 30 * 32, "timed": 16}),
        # 4 gaits × 2 readings, in blocks and in one go
        ("figure4", 30, {"reference": 8, "learner": 30 * 16}),
        ("sweep", 2, {"reference": 4, "learner": 2 * 4}),
    ],
)
def test_deterministic_agents_run_once_and_learners_once_a_seed(
    experiment: str, seeds: int, roles: dict[str, int]
) -> None:
    laid_out = plan(experiment, seeds=seeds)
    trials = list(laid_out.trials())
    assert Counter(trial.setting.role for trial in trials) == roles
    assert laid_out.total == len(trials) == sum(roles.values())


@pytest.mark.parametrize("experiment", ["table1", "figure4", "sweep"])
def test_keys_and_seeds_are_unique(experiment: str) -> None:
    trials = list(plan(experiment, seeds=20).trials())
    assert len({trial.key for trial in trials}) == len(trials)
    assert len({trial.config.training.seed for trial in trials}) == len(trials)


def test_a_key_names_everything_that_differs_from_the_paper() -> None:
    keys = [setting.key for setting in plan("table1", seeds=1).settings]
    assert keys[0] == "left-right-origin/measured/stiff/greedy"
    assert "left-right-vertical/commanded/compliant/q-learning/1000" in keys
    assert keys[-1] == "front-back-vertical/commanded/compliant/q-learning/500/timed"
    (*_, trial) = plan("sweep", seeds=12, alpha=(0.1,), divisions=(3,), steps=(40,)).trials()
    assert trial.key == "front-back-vertical/measured/stiff/divisions=3/q-learning/40/alpha=0.1#11"
    assert plan("figure4").settings[15].key.endswith("/q-learning/8x250")
    assert plan("figure4").settings[-1].key.endswith("/q-learning/2000")


def test_figure4_practises_the_steps_of_its_blocks_in_one_go_too() -> None:
    laid_out = plan("figure4", seeds=1, agents=("q-learning", "sarsa"), gaits=("tripod",))
    learners = [setting for setting in laid_out.settings if setting.role == "learner"]
    in_blocks, in_one_go = learners[:4], learners[4:]

    assert {block_line.trial.blocks for block_line in in_blocks} == {8}
    assert [block_line.training.agent for block_line in in_one_go] == [
        block_line.training.agent for block_line in in_blocks
    ]
    for in_one_go_setting, blocks in zip(in_one_go, in_blocks, strict=True):
        assert (in_one_go_setting.trial.blocks, in_one_go_setting.training.steps) == (1, 2000)
        assert (
            list(in_one_go_setting.walks_after)
            == list(blocks.walks_after)
            == list(range(250, 2001, 250))
        )


@pytest.mark.parametrize("experiment", ["table1", "league"])
def test_a_trial_is_found_by_its_key(experiment: str) -> None:
    laid_out = plan(experiment, seeds=2)
    for trial in laid_out.trials():
        trial_of_key = laid_out.find(trial.key)
        assert trial_of_key == trial
        assert "config" not in vars(trial_of_key), "which takes twenty times as long as the rest"
        assert trial_of_key.config == trial.config
    learner = trial.setting.key
    for number in ("2", "-1", "+1", "01", " 1", "1 ", "١", "1_0", "9" * 5000, "", "x"):
        assert laid_out.find(f"{learner}#{number}") is None
    for key in ("", "#0", learner, f"{learner}#0#0"):
        assert laid_out.find(key) is None


def test_adding_seeds_does_not_change_the_trials_of_earlier_seeds() -> None:
    few, many = (
        {trial.key: trial.config for trial in plan("figure4", seeds=seeds).trials()}
        for seeds in (3, 30)
    )
    assert few.items() < many.items()


def test_trial_seeds_are_spawned_from_the_experiments_seed() -> None:
    child = np.random.SeedSequence(7).spawn(4)[3].spawn(12)[11]
    (spawned,) = child.generate_state(1, np.uint64)
    assert trial_seed(7, 3, 11) == int(spawned) >> 11 < 2**53
    trials = list(plan("sweep", seed=7, seeds=2).trials())
    assert trials[5].config.training.seed == trial_seed(7, 5, 0)


def test_another_seed_gives_other_trials_under_the_same_keys() -> None:
    trials_of_seed_0, trials_of_seed_1 = (
        {trial.key: trial.config.training.seed for trial in plan("sweep", seed=seed).trials()}
        for seed in (0, 1)
    )
    assert trials_of_seed_0.keys() == trials_of_seed_1.keys()
    assert not set(trials_of_seed_0.values()) & set(trials_of_seed_1.values())


def test_references_come_first_and_timed_trials_last() -> None:
    roles = [trial.setting.role for trial in plan("table1", seeds=3).trials()]
    order = ["reference", "learner", "timed"]
    assert roles == sorted(roles, key=order.index)
    for trial in plan("table1", seeds=1).trials():
        assert trial.config.must_be_alone == (trial.setting.role == "timed")


def test_sweep_varies_the_settings_of_searches() -> None:
    gaits = ("front-back-origin",)
    settings = plan("sweep", gaits=gaits, agents=("beam",), width=(1, 4), depth=(2,)).settings
    assert [(setting.training.agent, dict(setting.training.settings)) for setting in settings] == [
        ("greedy", {}),
        ("beam", {"width": 1, "depth": 2}),
        ("beam", {"width": 4, "depth": 2}),
    ]
    with pytest.raises(HexapodError, match="choose depth 4 or less"):
        plan("sweep", gaits=gaits, agents=("look-ahead",), depth=(5,))


def test_greedy_is_always_a_reference() -> None:
    agents = ("tests.own_agents:Restless", "tests.own_agents:ThreeStep")
    gaits = ("front-back-origin",)
    settings = plan("sweep", gaits=gaits, agents=agents, steps=(40, 80)).settings
    agents_and_roles = [(setting.training.agent, setting.role) for setting in settings]
    assert agents_and_roles == [
        ("greedy", "reference"),
        ("tests.own_agents:ThreeStep", "reference"),
        ("tests.own_agents:Restless", "learner"),
        ("tests.own_agents:Restless", "learner"),
    ]


def test_two_robots_of_one_preset_have_different_labels() -> None:
    robots = (robot({"femur_m": 0.09}), robot({"femur_m": 0.085}), robot("slippery"))
    labels = [setting.robot for setting in plan("sweep", seeds=1, robots=robots).settings]
    assert set(labels) == {"stiff (modified) 1", "stiff (modified) 2", "slippery"}


@pytest.mark.parametrize(
    ("values", "names"),
    [
        ({"seeds": 10_000, "alpha": (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)}, "the most is 200,000"),
        ({"grid_side_m": (0.04, 0.2)}, "cannot reach"),
        ({"gaits": ("moonwalk",)}, "left-right-origin"),
        ({"agents": ("skynet",)}, ", ".join(BUILT_IN)),
        ({"alpha": (2.0,)}, "over 0 and at most 1"),
        ({"divisions": (9,)}, "from 2 to 8"),
        ({"observations": ("guessed",)}, "measured, commanded"),
        ({"alpha": (0.1, 0.1 + 1e-9)}, "is there twice"),
    ],
)
def test_invalid_setting_is_refused_before_any_trial_runs(
    values: dict[str, Any], names: str
) -> None:
    with pytest.raises(HexapodError) as refused:
        plan("sweep", **values)
    assert names in str(refused.value)


def test_a_trial_differs_from_its_setting_in_the_seed_only() -> None:
    for trial in plan("figure4", seeds=2).trials():
        seedless = replace(trial.config.training, seed=0)
        assert replace(trial.config, training=seedless) == trial.setting.trial


WORLDS = ("flat", "limp-pair")
ONE_GAIT = {"gaits": ("left-right-origin",), "worlds": WORLDS, "agents": ("q-learning", "informed")}


def test_league_walks_in_every_world_with_the_same_robots() -> None:
    laid_out = plan("league", seeds=3, **ONE_GAIT)
    keys = [setting.key for setting in laid_out.settings]
    flat, limp = "left-right-origin/measured/stiff", "left-right-origin/measured/stiff/limp-pair"
    assert keys == [
        *(f"{place}/{agent}" for place in (flat, limp) for agent in (*SEARCHERS, "greedy/nominal")),
        f"{flat}/q-learning/250",
        f"{limp}/q-learning/250",
    ]
    robots: dict[int, set[Any]] = {}
    for trial in laid_out.trials():
        robots.setdefault(trial.seed_number, set()).add(trial.config.training.built_robot)
    assert laid_out.total == len(keys) * 3
    assert [len(drawn) for drawn in robots.values()] == [1, 1, 1]
    assert len(set.union(*robots.values())) == 3


SEARCHERS = ("greedy", "informed")


def test_searchers_walk_once_where_nothing_varies() -> None:
    laid_out = plan("league", seeds=3, tolerance=0.0, **{**ONE_GAIT, "worlds": ("ice", "noise")})
    trials_by_world = {
        world: [laid_out.count(s) for s in laid_out.settings if s.world == world]
        for world in ("ice", "noise")
    }
    # greedy, informed, nominal greedy; q-learning
    assert trials_by_world == {"ice": [1, 1, 1, 3], "noise": [3, 3, 3, 3]}
    assert len(list(laid_out.trials())) == laid_out.total


def test_only_the_nominal_greedy_plans_with_the_design() -> None:
    trials = plan("league", seeds=1, **ONE_GAIT).trials()
    nominal = [trial.key for trial in trials if trial.config.plans_with == "nominal"]
    assert nominal == [
        "left-right-origin/measured/stiff/greedy/nominal#0",
        "left-right-origin/measured/stiff/limp-pair/greedy/nominal#0",
    ]


def test_recovery_begins_after_the_practice() -> None:
    settings = plan("recovery", seeds=1, gaits=ONE_GAIT["gaits"], worlds=("limp-pair",)).settings
    learner, searcher = settings[-1], settings[0]
    assert learner.trial.evaluations == (100, 101, 125, 150, 200, 250)
    assert learner.training.world.change_steps == (100,)
    assert (learner.training.steps, learner.parameters["steps"]) == (300, 100)
    assert searcher.training.world.change_steps == ()  # its world is so from the start


def test_each_body_walks_in_the_gait_that_suits_it() -> None:
    settings = plan("bodies", seeds=2).settings
    gaits = {setting.robot: setting.gait for setting in settings}

    assert gaits["stiff"] == "left-right-origin"
    assert gaits["crab"] == "tetrapod"
    assert gaits["starfish"] == "right 1, left 2, 1+3 2+5 4"
    learners = [setting for setting in settings if setting.role == "learner"]
    assert len(learners) == 2 * len(gaits)
    assert all(setting.trial.evaluations == (25, 50, 100, 150, 250) for setting in learners)
