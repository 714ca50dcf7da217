"""Validation and defaults of an experiment's config."""

import json
from typing import Any

import pytest

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import PAPER_GAITS, GaitSpec
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import robot
from hexapods.experiments.config import (
    MAX_SEEDS,
    ExperimentConfig,
    by_option,
    experiment_config,
    settings_by_name,
)
from hexapods.experiments.presets import GRID, PRESETS


def test_table_1_defaults_to_the_papers_gaits_with_both_observations() -> None:
    config = experiment_config("table1", {})
    assert config.seeds == 30
    assert config.gaits == tuple(PAPER_GAITS)
    assert config.observations == ("measured", "commanded")
    assert [robot_of_config.name for robot_of_config in config.robots] == ["stiff", "compliant"]
    assert (config.steps, config.blocks) == ((500, 1000), 1)


def test_figure_4_practises_2000_steps_in_eight_blocks() -> None:
    config = experiment_config("figure4", {"agents": ("q-learning", "tests.own_agents:Restless")})
    assert (config.steps, config.blocks) == ((250,), 8)
    assert len(config.agents) == 2


def test_a_sweep_can_vary_every_grid_parameter() -> None:
    grid: dict[str, Any] = {
        "steps": (100, 200),
        "alpha": (0.1, 0.3),
        "gamma": (0.5,),
        "objective": ("discounted", "average"),
        "average_rate": (0.1, 0.3),
        "epsilon_start": (1.0, 0.5),
        "epsilon_end": (0.0, 0.1),
        "steps_per_episode": (25, 50),
        "divisions": (2, 3),
        "grid_side_m": (0.03, 0.04),
    }
    assert set(grid) == {*GRID, *settings_by_name(["q-learning"])}
    shown = by_option(to_json(experiment_config("sweep", grid)))
    assert {name: tuple(shown[name]) for name in grid} == grid
    assert shown["observations"] == ["measured"]


def test_groups_compare_pairs_with_a_tripod() -> None:
    groups = experiment_config("groups", {})

    assert groups.gaits == ("left-right-origin", "left-right-vertical", "tripod")
    assert (groups.steps, groups.steps_per_episode, groups.seeds) == ((250,), (25,), 30)


def test_bodies_have_no_gaits_of_their_own() -> None:
    bodies = experiment_config("bodies", {})

    assert bodies.gaits == ()
    assert [robot_of_config.name for robot_of_config in bodies.robots][-1] == "centipede"
    with pytest.raises(UnknownName, match="unknown field of bodies 'gaits'"):
        experiment_config("bodies", {"gaits": ("tripod",)})
    with pytest.raises(InvalidInput, match="gaits must name at least one"):
        experiment_config("groups", {"gaits": ()})


def test_league_and_recovery_vary_robots_and_worlds() -> None:
    league, recovery = (experiment_config(name, {}) for name in ("league", "recovery"))
    assert league.tolerance == recovery.tolerance == 0.03
    assert league.worlds == ("flat", "limp-pair", "slope", "ice")
    assert {"linear-model", "informed"} < set(league.agents)
    assert (league.steps, recovery.steps) == ((250,), (100,))


def test_papers_experiments_keep_no_tolerance() -> None:
    for name in ("table1", "figure4", "sweep"):
        config = experiment_config(name, {})
        assert (config.worlds, config.tolerance) == (("flat",), 0.0)
        with pytest.raises(UnknownName, match="tolerance"):
            experiment_config(name, {"tolerance": 0.03})


def test_config_of_an_earlier_version_is_on_flat_ground() -> None:
    config = experiment_config("figure4", {})
    stored = to_json(config)
    del stored["worlds"], stored["tolerance"]
    assert from_json(ExperimentConfig, stored) == config


def test_none_counts_as_not_given() -> None:
    values = {"seeds": None, "robots": None, "seed": 0}
    assert experiment_config("table1", values) == experiment_config("table1", {})


_OWN: dict[str, Any] = {
    "seeds": 7,
    "seed": 2**60,
    "gaits": (
        "front-back-origin",
        GaitSpec(right_leg=1, left_leg=2, symmetry="origin"),
        GaitSpec(right_leg=1, left_leg=2, pairs=((1, 4), (2, 5), (3, 6))),
    ),
    "robots": (robot("slippery"), robot({"preset": "compliant", "femur_m": 0.09})),
    "simulator": "kinematic",
}


@pytest.mark.parametrize("experiment", [*PRESETS])
@pytest.mark.parametrize("values", [{}, _OWN], ids=["defaults", "own"])
def test_a_config_round_trips_through_json(experiment: str, values: dict[str, Any]) -> None:
    accepted = PRESETS[experiment].fields
    config = experiment_config(experiment, {k: v for k, v in values.items() if k in accepted})
    assert from_json(ExperimentConfig, json.loads(json.dumps(to_json(config)))) == config


@pytest.mark.parametrize(
    ("experiment", "values", "names"),
    [
        ("table2", {}, "table1, figure4, sweep, league, recovery, groups, bodies"),
        ("table1", {"seeds": 0}, f"seeds must be a whole number from 1 to {MAX_SEEDS:,}"),
        ("table1", {"seeds": MAX_SEEDS + 1}, f"from 1 to {MAX_SEEDS:,}"),
        ("table1", {"seeds": 2.5}, "a whole number"),
        ("table1", {"seeds": True}, "a whole number"),
        ("table1", {"seed": -1}, "seed must be a whole number of at least 0"),
        ("table1", {"alpha": (0.1,)}, "seeds, seed, gaits, observations, robots, simulator"),
        ("figure4", {"steps": (100,)}, "agents"),
        ("sweep", {"blocks": 3}, "grid_side_m"),
        ("sweep", {"alpha": ()}, "alpha must name at least one; valid: a number over 0 and"),
        ("sweep", {"steps": ()}, "steps must name at least one; valid: a whole number from 1 to"),
        ("sweep", {"gaits": ()}, "gaits must name at least one; valid: left-right"),
        ("sweep", {"agents": ()}, "agents must name at least one; valid: q-learning"),
        ("sweep", {"robots": ()}, "robots must name at least one; valid: stiff, compliant"),
        ("sweep", {"alpha": (0.1, 0.3, 0.1)}, "alpha names something twice"),
        ("sweep", {"robots": (robot("stiff"), robot("stiff"))}, "robots names something twice"),
        ("sweep", {"worlds": ("ice",)}, "grid_side_m"),
        ("league", {"worlds": ("moon",)}, "limp-pair"),
        ("league", {"worlds": ("slope:degrees=80",)}, "degrees"),
        ("recovery", {"worlds": ("limp:legs=1:at=25",)}, "leave out at and until"),
        ("league", {"worlds": ()}, "worlds must name at least one; valid: flat, "),
        ("league", {"tolerance": 0.3}, "from 0 to 0.2"),
    ],
)
def test_an_invalid_config_is_refused_in_one_sentence(
    experiment: str, values: dict[str, Any], names: str
) -> None:
    with pytest.raises(InvalidInput) as refused:
        experiment_config(experiment, values)
    assert names in str(refused.value)


def test_an_unknown_experiment_raises_unknown_name() -> None:
    with pytest.raises(UnknownName):
        ExperimentConfig(experiment="table2")
