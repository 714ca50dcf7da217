"""Configs of trainings and races: valid values and refusals."""

import json
import math
from typing import Annotated, Any

import pytest

from app.agents import registry
from app.agents.q_learning import QLearning
from app.domain.errors import InvalidInput, UnknownName
from app.domain.gait import GaitSpec
from app.domain.robot import robot
from app.domain.settings import Setting, SettingValues
from app.runs.config import (
    TrainingConfig,
    WalkingProblem,
    agent_settings,
    changeable_settings,
    training_config,
    usable_agents,
)
from app.runs.config_json import as_json, config_from_json, gait_from_json
from app.runs.lane import LaneConfig, lane_config
from app.runs.race_config import RaceConfig
from tests.own_agents import Restless

GAIT = "left-right-origin"
LANES = (LaneConfig(agent="greedy"),)


def test_the_defaults_are_the_papers() -> None:
    config = training_config(gait=GAIT)

    assert dict(config.settings) == {
        "alpha": 0.3,
        "gamma": 0.9,
        "epsilon_start": 1,
        "epsilon_end": 0,
    }
    assert config.steps_per_episode == 50
    assert (config.steps, config.divisions, config.grid_side_m) == (500, 2, 0.04)
    assert (config.observation, config.simulator, config.robot.name) == (
        "measured",
        "mujoco",
        "stiff",
    )
    assert RaceConfig(gait=GAIT, lanes=LANES).steps == 50


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"gait": "tripod"}, "unknown gait 'tripod'"),
        ({"simulator": "gazebo"}, "unknown simulator 'gazebo'; choose one of: mujoco, kinematic"),
        ({"observation": "guessed"}, "unknown observation"),
        ({"divisions": 1}, "divisions must be a whole number from 2 to 8"),
        ({"grid_side_m": 0.001}, "grid_side_m must be a number from"),
        ({"steps": 0}, r"steps must be a whole number from 1 to 10,000,000, not 0"),
        ({"steps": -1}, "steps must be a whole number from 1"),
        ({"steps": 10**12}, "steps must be a whole number from 1"),
        ({"steps": 1e3}, "steps must be a whole number"),
        ({"steps": math.nan}, "steps must be a whole number"),
        ({"steps": True}, "steps must be a whole number"),
        ({"seed": -1}, "seed must be a whole number of at least 0, not -1"),
        ({"steps_per_episode": 0}, "steps_per_episode must be a whole number from 1"),
        ({"evaluate_every": -1}, "evaluate_every must be a whole number from 0"),
        ({"alpha": 0}, "alpha must be a number over 0 and at most 1"),
        ({"alpha": 1.1}, "alpha must be a number over 0 and at most 1"),
        ({"alpha": math.nan}, "alpha must be a number over 0 and at most 1"),
        ({"gamma": 1}, "gamma must be a number from 0 to under 1"),
        ({"gamma": -0.1}, "gamma must be a number from 0 to under 1"),
        ({"epsilon_start": 1.1}, "epsilon_start must be a number from 0 to 1"),
        ({"epsilon_end": -0.1}, "epsilon_end must be a number from 0 to 1"),
        ({"pace": 0}, "pace must be max, or a number from 0.01 to 1,000"),
        ({"pace": "fast"}, "pace must be max, or a number from"),
        ({"pace": math.inf}, "pace must be max, or a number from"),
    ],
)
def test_invalid_training_is_refused_with_the_valid_values(
    asked: dict[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        training_config(**{"gait": GAIT, **asked})


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"lanes": ()}, "a race has 1 to 6 lanes, not 0"),
        ({"lanes": LANES * 7}, "a race has 1 to 6 lanes, not 7"),
        ({"steps": 0}, "steps must be a whole number from 1"),
        ({"seed": -3}, "seed must be a whole number of at least 0"),
    ],
)
def test_invalid_race_is_refused_with_the_valid_values(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        RaceConfig(**{"gait": GAIT, "lanes": LANES, **asked})


def test_gait_with_legs_that_the_robot_lacks_is_refused() -> None:
    with pytest.raises(InvalidInput, match="no leg 6; this robot has legs 1 to 4"):
        WalkingProblem(gait=GaitSpec(6, 1, "origin"), robot=robot({"n_legs": 4}))


def test_unknown_observation_mode_of_a_lane_is_refused() -> None:
    with pytest.raises(UnknownName, match="observation"):
        LaneConfig(agent="greedy", observation="guessed")  # type: ignore[arg-type]


@pytest.mark.parametrize("pace", ["max", 0.01, 1, 1000])
def test_pace_is_max_or_a_multiple_of_real_time(pace: float | str) -> None:
    assert training_config(gait=GAIT, pace=pace).pace == pace


@pytest.mark.parametrize(
    "gait", [GAIT, GaitSpec(6, 1, "vertical"), GaitSpec(1, 2, pairs=((1, 6), (2, 3), (4, 5)))]
)
def test_config_in_plain_types_is_valid_json_and_has_the_same_gait(
    gait: str | GaitSpec,
) -> None:
    made = robot({"preset": "compliant", "n_legs": 6, "friction": 0.5})
    shown = json.loads(json.dumps(as_json(training_config(gait=gait, robot=made))))

    assert gait_from_json(shown.pop("gait")) == gait
    assert robot(shown.pop("robot")) == made
    assert shown.pop("disturbances") == []
    assert training_config(gait=gait, robot=made, **shown) == training_config(gait=gait, robot=made)


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
    assert config_from_json(json.loads(json.dumps(as_json(config)))) == config


def test_lane_in_plain_types_has_its_settings_as_flat_fields() -> None:
    race = RaceConfig(gait=GAIT, lanes=(lane_config("look-ahead", depth=2),))
    assert as_json(race)["lanes"] == [
        {
            "agent": "look-ahead",
            "observation": "measured",
            "keep_learning": False,
            "plans_with": None,
            "depth": 2,
        }
    ]


def test_race_of_an_earlier_version_has_lanes_that_do_not_keep_learning() -> None:
    stored = {**as_json(RaceConfig(gait=GAIT, lanes=LANES))}
    stored["lanes"] = [{"agent": "greedy", "observation": "measured"}]
    assert config_from_json(stored) == RaceConfig(gait=GAIT, lanes=LANES)


def test_lane_has_the_defaults_of_its_agent() -> None:
    assert dict(lane_config("look-ahead").settings) == {"depth": 3}
    assert lane_config("q-learning", keep_learning=True).settings["alpha"] == 0.3
    eager = f"{__name__}:Eager"
    assert lane_config(eager).keep_learning
    assert not lane_config(eager, keep_learning=False).keep_learning
    assert not lane_config("q-learning", has_training=True).keep_learning
    assert dict(lane_config("q-learning", has_training=True).settings) == {}


class Eager(Restless):
    """An agent that learns in a race unless it is told otherwise."""

    keeps_learning = True


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"agent": "look-ahead", "depth": 0}, "depth must be a whole number from 1 to 50, not 0"),
        ({"agent": "look-ahead", "width": 2}, "unknown setting of look-ahead 'width'.*: depth"),
        ({"agent": "greedy", "depth": 2}, "greedy has no settings, so none named 'depth'"),
        (
            {"agent": "greedy", "keep_learning": True},
            "greedy does not learn, so it cannot keep learning; leave out keep_learning",
        ),
        (
            {"agent": "q-learning", "has_training": True, "alpha": 0.1, "gamma": 0.5},
            "a lane with training takes its settings from there; leave out alpha, gamma",
        ),
        (
            {"agent": "q-learning", "has_training": True, "keep_learning": 1},
            "keep_learning must be true or false, not 1",
        ),
    ],
)
def test_invalid_lane_is_refused_with_the_valid_values(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        lane_config(**asked)


class Older(Restless):
    """An agent that names settings of Q-learning without declaring them, as was the rule before."""

    def __init__(self, rng: object, alpha: float, gamma: float = 0.5, width: int = 3) -> None:
        self.given = alpha, gamma, width

    def tune(self, alpha: float | None = None, epsilon: float | None = None) -> None:
        pass


class Clashing(Restless):
    """An agent with a setting that would hide a field of requests."""

    def __init__(self, seeds: Annotated[int, Setting(title="Seeds", help="")] = 1) -> None:
        self.seeds = seeds


class Untunable(QLearning):
    """An agent with a live setting that its `tune` does not take."""

    def __init__(
        self,
        *args: Any,
        hope: Annotated[float, Setting(title="Hope", help="", live=True)] = 1.0,
        **settings: Any,
    ) -> None:
        super().__init__(*args, **settings)


def test_a_parameter_named_like_a_usual_setting_is_that_setting() -> None:
    found = agent_settings(f"{__name__}:Older")
    assert {name: one.default for name, one in found.items()} == {"alpha": 0.3, "gamma": 0.5}
    assert found["alpha"].valid == "a number over 0 and at most 1"
    assert list(changeable_settings(f"{__name__}:Older")) == ["pace", "alpha", "epsilon"]


def test_a_live_setting_that_tune_does_not_take_cannot_change() -> None:
    name = f"{__name__}:Untunable"
    assert "hope" in agent_settings(name)
    assert list(changeable_settings(name)) == ["pace", "alpha", "gamma", "epsilon"]


def test_a_setting_with_a_reserved_name_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"declares a setting named 'seeds'.*rename"):
        agent_settings(f"{__name__}:Clashing")


def test_an_agent_that_cannot_be_offered_is_left_out(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(registry, "registered", lambda: {**registry.OURS, "clashing": Clashing})
    monkeypatch.setattr(registry, "find", registry.registered().__getitem__)
    assert usable_agents() == tuple(registry.OURS)
    assert "agent clashing is left out" in caplog.text
