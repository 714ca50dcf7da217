"""Configs of trainings and races: valid values and refusals."""

import math
from typing import Annotated, Any

import pytest

from hexapods.agents import registry
from hexapods.agents.q_learning import QLearning
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import robot
from hexapods.domain.settings import Setting
from hexapods.runs.config import (
    TrainingConfig,
    WalkingProblem,
    agent_settings,
    changeable_settings,
    training_config,
    usable_agents,
)
from tests.own_agents import Restless

GAIT = "left-right-origin"


def test_the_defaults_are_the_papers() -> None:
    config = training_config(gait=GAIT)

    assert dict(config.settings) == {
        "alpha": 0.3,
        "gamma": 0.9,
        "objective": "discounted",
        "average_rate": 0.3,  # of the other objective
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


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"gait": "canter"}, "unknown gait 'canter'"),
        ({"simulator": "gazebo"}, "unknown simulator 'gazebo'; choose one of: mujoco, kinematic"),
        ({"observation": "guessed"}, "unknown observation"),
        ({"reward": "sideways"}, "reward must be forward, or track, not 'sideways'"),
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
    settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        training_config(**{"gait": GAIT, **settings})


def test_a_config_of_an_earlier_version_has_the_reward_of_that_time() -> None:
    stored = to_json(training_config(gait=GAIT, steps=7))
    del stored["reward"]

    assert from_json(TrainingConfig, stored).reward == "forward"


def test_gait_with_legs_that_the_robot_lacks_is_refused() -> None:
    with pytest.raises(InvalidInput, match="no leg 6; this robot has legs 1 to 4"):
        WalkingProblem(gait=GaitSpec(6, 1, "origin"), robot=robot({"n_legs": 4}))


@pytest.mark.parametrize("pace", ["max", 0.01, 1, 1000])
def test_pace_is_max_or_a_multiple_of_real_time(pace: float | str) -> None:
    assert training_config(gait=GAIT, pace=pace).pace == pace


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
    settings = agent_settings(f"{__name__}:Older")
    assert {name: setting.default for name, setting in settings.items()} == {
        "alpha": 0.3,
        "gamma": 0.5,
    }
    assert settings["alpha"].valid == "a number over 0 and at most 1"
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
    monkeypatch.setattr(registry, "registered", lambda: {**registry.BUILT_IN, "clashing": Clashing})
    monkeypatch.setattr(registry, "find", registry.registered().__getitem__)
    assert usable_agents() == tuple(registry.BUILT_IN)
    assert "agent clashing is left out" in caplog.text
