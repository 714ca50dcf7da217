"""Lanes of races: their agents' settings and defaults, refusals, and what a search knows."""

import sys
from pathlib import Path
from typing import Any

import pytest

from hexapods.domain.disturbances import Limp, Push, Slope
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.world import World
from hexapods.runs.config import WalkingProblem
from hexapods.runs.lane import LaneConfig, lane_config, observation_of, plans_with
from tests.own_agents import Restless


def test_unknown_observation_mode_of_a_lane_is_refused() -> None:
    with pytest.raises(UnknownName, match="observation"):
        LaneConfig(agent="greedy", observation="guessed")  # type: ignore[arg-type]


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
    ("settings", "message"),
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
def test_invalid_lane_is_refused_with_the_valid_values(
    settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        lane_config(**settings)


def test_a_lane_reads_its_state_as_its_training_did_or_else_as_it_says() -> None:
    assert observation_of(None, None) == "measured"
    assert observation_of(None, None, "commanded") == "commanded"
    assert observation_of("planned", None, "commanded") == "planned"
    assert observation_of(None, "planned") == observation_of("planned", "planned") == "planned"
    with pytest.raises(InvalidInput, match="must be planned, in which its training was learned"):
        observation_of("measured", "planned")


NOW, LATER = Slope(degrees=5.0), Limp(legs=(1,), at_step=9)


@pytest.mark.parametrize(
    ("happens", "tolerance", "model"),
    [
        ((), 0.0, "world"),
        ((), 0.03, "world"),
        ((NOW,), 0.0, "world"),
        ((Push(impulse_ns=1.0, direction_deg=0.0),), 0.0, "world"),
        ((LATER,), 0.0, "nominal"),
        ((LATER,), 0.03, "start"),  # the nominal robot has no build tolerance
        ((NOW, LATER), 0.0, "start"),
        ((Slope(degrees=5.0, until_step=9),), 0.0, "start"),
    ],
)
def test_what_a_search_knows_by_default_has_a_name(
    happens: tuple[Any, ...], tolerance: float, model: str
) -> None:
    walk = WalkingProblem(gait="left-right-origin", world=World(happens), tolerance=tolerance)
    assert plans_with(lane_config("greedy"), walk) == model


def test_a_search_knows_what_its_lane_says_and_other_agents_plan_with_nothing() -> None:
    walk = WalkingProblem(gait="left-right-origin")
    for model in ("world", "start", "nominal"):
        assert plans_with(lane_config("beam", plans_with=model), walk) == model
    assert plans_with(lane_config("linear-model"), walk) is None
    assert plans_with(LaneConfig(agent="tests.own_agents:ThreeStep"), walk) == "world"
    for agent in ("removed", "no_such_module:Agent", "tests.own_agents:Removed", "os:path"):
        assert plans_with(LaneConfig(agent=agent), walk) is None
    with pytest.raises(InvalidInput, match="must be world, or start, or nominal, not 'hope'"):
        lane_config("beam", plans_with="hope")


def test_naming_what_a_search_knows_imports_no_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "agent_of_a_stored_race.py").write_text("from hexapods.agents.beam import Beam\n")
    monkeypatch.syspath_prepend(tmp_path)
    lane = LaneConfig(agent="agent_of_a_stored_race:Beam")

    assert plans_with(lane, WalkingProblem(gait="left-right-origin")) is None
    assert "agent_of_a_stored_race" not in sys.modules
