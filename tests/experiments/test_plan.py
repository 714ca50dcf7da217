"""The plan of an experiment: all of its trials, each with a unique key and seed."""

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.domain.errors import HexapodError
from app.domain.robot import robot
from app.experiments.config import experiment_config
from app.experiments.plan import Plan, trial_seed


def plan(experiment: str, **given: Any) -> Plan:
    return Plan(experiment_config(experiment, given))


@pytest.mark.parametrize(
    ("experiment", "seeds", "roles"),
    [
        # 4 gaits × 2 readings × 2 robots: greedy and two-step, two practices, one race by the wall
        ("table1", 30, {"reference": 32, "learner": 30 * 32, "timed": 16}),
        # 4 gaits × 2 readings
        ("figure4", 30, {"reference": 8, "learner": 30 * 8}),
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
    (*_, one) = plan("sweep", seeds=12, alpha=(0.1,), divisions=(3,), steps=(40,)).trials()
    assert one.key == "front-back-vertical/measured/stiff/divisions=3/q-learning/40/alpha=0.1#11"
    assert plan("figure4").settings[-1].key.endswith("/q-learning/8x250")


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
    here, there = (
        {trial.key: trial.config.training.seed for trial in plan("sweep", seed=seed).trials()}
        for seed in (0, 1)
    )
    assert here.keys() == there.keys()
    assert not set(here.values()) & set(there.values())


def test_references_come_first_and_timed_trials_last() -> None:
    roles = [trial.setting.role for trial in plan("table1", seeds=3).trials()]
    order = ["reference", "learner", "timed"]
    assert roles == sorted(roles, key=order.index)
    for trial in plan("table1", seeds=1).trials():
        assert trial.config.must_be_alone == (trial.setting.role == "timed")


def test_greedy_is_always_a_reference() -> None:
    agents = ("tests.own_agents:Restless", "tests.own_agents:ThreeStep")
    gaits = ("front-back-origin",)
    settings = plan("sweep", gaits=gaits, agents=agents, steps=(40, 80)).settings
    found = [(setting.training.agent, setting.role) for setting in settings]
    assert found == [
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
    ("given", "names"),
    [
        ({"seeds": 10_000, "alpha": (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)}, "the most is 200,000"),
        ({"grid_side_m": (0.04, 0.2)}, "cannot reach"),
        ({"gaits": ("moonwalk",)}, "left-right-origin"),
        ({"agents": ("skynet",)}, "q-learning, sarsa-lambda, linear-model, greedy, two-step"),
        ({"alpha": (2.0,)}, "over 0 and at most 1"),
        ({"divisions": (9,)}, "from 2 to 8"),
        ({"observations": ("guessed",)}, "measured, commanded"),
        ({"alpha": (0.1, 0.1 + 1e-9)}, "is there twice"),
    ],
)
def test_invalid_setting_is_refused_before_any_trial_runs(
    given: dict[str, Any], names: str
) -> None:
    with pytest.raises(HexapodError) as refused:
        plan("sweep", **given)
    assert names in str(refused.value)


def test_a_trial_differs_from_its_setting_in_the_seed_only() -> None:
    for trial in plan("figure4", seeds=2).trials():
        seedless = replace(trial.config.training, seed=0)
        assert replace(trial.config, training=seedless) == trial.setting.trial
