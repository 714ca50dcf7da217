"""The id of a baseline: all that its distance depends on, and nothing else."""

from dataclasses import replace

import pytest

from hexapods.domain.disturbances import Limp, SensorNoise
from hexapods.domain.robot import robot
from hexapods.domain.world import World
from hexapods.runs.baseline import baseline_id
from hexapods.runs.config import TrainingConfig, training_config

CONFIG = training_config(gait="left-right-origin", steps=40)


def id_of(config: TrainingConfig, step: int = 0) -> str:
    return baseline_id(config, config.world.as_of(step))


@pytest.mark.parametrize(
    "changes",
    [
        {"gait": "front-back-origin"},
        {"robot": robot("compliant")},
        {"simulator": "kinematic"},
        {"divisions": 3},
        {"grid_side_m": 0.05},
        {"tolerance": 0.1},
        {"world": World((Limp(legs=(1,)),))},
    ],
    ids=str,
)
def test_another_problem_has_another_baseline(changes: dict[str, object]) -> None:
    assert id_of(replace(CONFIG, **changes)) != id_of(CONFIG)  # type: ignore[arg-type]


def test_the_practice_makes_no_other_baseline() -> None:
    other = training_config("sarsa", gait="left-right-origin", steps=90, seed=7, alpha=0.5)
    assert id_of(other) == id_of(CONFIG)


def test_the_seed_counts_where_there_is_chance() -> None:
    for chance in ({"tolerance": 0.1}, {"world": World((SensorNoise(sd_m=0.01),))}):
        config = replace(CONFIG, **chance)
        assert id_of(config) != id_of(replace(config, seed=1))


def test_a_later_world_has_a_baseline_of_its_own() -> None:
    config = replace(CONFIG, world=World((Limp(legs=(1,), at_step=20),)))
    assert id_of(config) == id_of(CONFIG)
    assert id_of(config, 20) != id_of(CONFIG)
