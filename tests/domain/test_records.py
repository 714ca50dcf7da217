"""Configs as JSON: what is written is read again, and what earlier versions wrote."""

import json
from dataclasses import dataclass, replace

import pytest
from pydantic import TypeAdapter

from hexapods.domain.gait import GaitSpec, read_gait
from hexapods.domain.records import Record, from_json, to_json
from hexapods.domain.robot import robot
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import world
from hexapods.runs.config import Seed, TrainingConfig, training_config
from hexapods.runs.lane import LaneConfig, lane_config
from hexapods.runs.race_config import RaceConfig

GAIT = "left-right-origin"
LANES = (LaneConfig(agent="greedy"),)


@pytest.mark.parametrize(
    "gait", [GAIT, GaitSpec(6, 1, "vertical"), GaitSpec(1, 2, pairs=((1, 6), (2, 3), (4, 5)))]
)
def test_config_in_plain_types_is_valid_json_and_has_the_same_gait(
    gait: str | GaitSpec,
) -> None:
    body = robot({"preset": "compliant", "n_legs": 6, "friction": 0.5})
    shown = json.loads(json.dumps(to_json(training_config(gait=gait, robot=body))))

    assert read_gait(shown.pop("gait")) == gait
    assert robot(shown.pop("robot")) == body
    assert shown.pop("disturbances") == []
    assert training_config(gait=gait, robot=body, **shown) == training_config(gait=gait, robot=body)


@pytest.mark.parametrize(
    "config",
    [
        training_config(gait=GAIT),
        TrainingConfig(
            gait=GaitSpec(1, 4, pairs=((1, 4), (2, 6), (3, 5))),
            robot=robot({"preset": "slippery", "n_legs": 6, "mount_radius_m": 0.12}),
            simulator="kinematic",
            seed=2**70,
            pace=2.5,
            agent="my.module:Agent",
            settings=SettingValues({"width": 3, "mode": "wide"}),
        ),
        training_config(
            gait=GaitSpec(1, 3, "vertical"), robot=robot({"n_legs": 8, "femur_m": 0.1})
        ),
        RaceConfig(gait=GAIT, lanes=(*LANES, LaneConfig(agent="x", observation="commanded"))),
        RaceConfig(
            gait=GAIT,
            lanes=(
                lane_config("look-ahead", depth=2),
                lane_config("q-learning", keep_learning=True, alpha=0.5),
            ),
        ),
    ],
)
def test_config_round_trips_through_json(config: TrainingConfig | RaceConfig) -> None:
    assert from_json(type(config), json.loads(json.dumps(to_json(config)))) == config


def test_lane_in_plain_types_has_its_settings_as_a_member() -> None:
    race = RaceConfig(gait=GAIT, lanes=(lane_config("look-ahead", depth=2),))
    assert to_json(race)["lanes"] == [
        {
            "agent": "look-ahead",
            "observation": "measured",
            "keep_learning": False,
            "plans_with": None,
            "settings": {"depth": 2},
        }
    ]


def test_race_of_an_earlier_version_has_lanes_that_do_not_keep_learning() -> None:
    stored = {**to_json(RaceConfig(gait=GAIT, lanes=LANES))}
    stored["lanes"] = [{"agent": "greedy", "observation": "measured", "settings": {}}]
    assert from_json(RaceConfig, stored) == RaceConfig(gait=GAIT, lanes=LANES)


def test_a_stored_end_after_the_run_is_read_as_it_was_accepted() -> None:
    """Requests are refused one since; listings and archives of earlier runs must go on."""
    long = {"kind": "slope", "degrees": 8.0, "at_step": 0, "until_step": 900}
    for config in (training_config(gait=GAIT), RaceConfig(gait=GAIT, lanes=LANES)):
        stored = {**to_json(config), "disturbances": [long]}
        assert from_json(type(config), stored) == replace(config, world=world([long]))


def test_a_records_docstring_describes_it_and_its_fields() -> None:
    @dataclass(frozen=True)
    class Pace(Record):
        """How fast it walks.

        Attributes:
            speed_m_s: distance by time; None
                without a step.
            seed: of all that is random.
        """

        speed_m_s: float | None
        seed: Seed
        steps: int

    described = TypeAdapter(Pace).json_schema()
    assert described["description"] == "How fast it walks."
    members = {name: field.get("description") for name, field in described["properties"].items()}
    assert members["speed_m_s"] == "distance by time; null without a step."
    assert members["steps"] is None
    assert "random follows from this number" in members["seed"], "a setting's own help goes first"
