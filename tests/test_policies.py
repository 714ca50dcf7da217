"""`hx.policy`: any function from an observation to an action joins a race."""

from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

import hexapods as hx
import hexapods.environment  # registers it

QUICK: dict[str, Any] = {"simulator": "kinematic", "steps": 20}
CELLS = 5


def next_cell(observation: NDArray[np.int64]) -> int:
    """Send the group in the lowest cell to the next one, as a number of the environment."""
    group = int(observation.argmin())
    return group * CELLS + (int(observation[group]) + 1) % CELLS


class Model:
    """Like those of Stable-Baselines3: `predict` returns an array without axes, and a state."""

    def __init__(self) -> None:
        self.seen: list[Any] = []

    def predict(self, observation: Any, state: Any = None) -> tuple[Any, None]:
        self.seen.append(observation)
        return np.array(next_cell(observation)), None


class MaskedModel(Model):
    """Like those of sb3-contrib, which need to be told what is legal."""

    def predict(
        self, observation: Any, action_masks: NDArray[np.bool_] | None = None
    ) -> tuple[Any, None]:
        assert action_masks is not None
        return np.array([np.flatnonzero(action_masks)[-1]]), None


def test_a_function_joins_a_race_and_walks_as_in_the_environment() -> None:
    race = hx.race([hx.policy(next_cell), "greedy"], **QUICK)
    walk = gymnasium.make("RacingHexapods/Walk-v0", simulator="kinematic")
    observation, info = walk.reset()
    for _ in range(20):
        observation, *_, info = walk.step(next_cell(observation))

    [standing] = [standing for standing in race.standings if standing.lane == 0]
    assert standing.agent == "next_cell"
    assert standing.total_distance_m == info["distance_m"] != 0


def test_a_model_sees_the_environments_observation() -> None:
    model = Model()
    race = hx.race([hx.policy(model.predict), hx.policy(next_cell, name="The same")], **QUICK)

    assert [lane.agent for lane in race.config.lanes] == ["Model", "The same"]
    distances_m = [standing.total_distance_m for standing in race.standings]
    assert distances_m[0] == distances_m[1]
    space = gymnasium.make("RacingHexapods/Walk-v0", simulator="kinematic").observation_space
    assert len(model.seen) == 20
    assert all(observation in space for observation in model.seen)


def test_a_policy_that_takes_action_masks_gets_the_legal_actions() -> None:
    race = hx.race([hx.policy(MaskedModel().predict)], **QUICK)
    assert len(race.recording[0].steps) == 20
    assert race.recording[0].steps[0].action == (2, 4)


@pytest.mark.test
def test_it_reads_its_state_as_its_lane_says(tmp_path: Path) -> None:
    lanes = [hx.lane(hx.policy(next_cell), observation=how) for how in ("measured", "commanded")]
    race = hx.race(lanes, **QUICK)

    assert [lane.observation for lane in race.config.lanes] == ["measured", "commanded"]
    again = hx.load(race.save(tmp_path / "race.npz"))
    assert isinstance(again, hx.Race)
    assert again.standings == race.standings
    assert "next_cell" in hx.view(again).title


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (0, r"Model chose action 0, group 1 to cell 0, which is not legal .* legal are 1, 2, 3, 4"),
        (15, r"Model returned 15, which is no action: .* a whole number from 0 to 14"),
        (1.0, "Model returned 1.0, which is no action"),
        (None, "Model returned None, which is no action"),
        (True, "Model returned True, which is no action"),
        (np.array([1, 2]), r"Model returned array\(\[1, 2\]\), which is no action"),
        ((0, 1), r"Model returned \(0, 1\)|Model chose action 0"),
    ],
)
def test_an_illegal_action_is_an_error_that_says_what_is_legal(answer: Any, message: str) -> None:
    with pytest.raises(hx.IllegalAction, match=message):
        hx.race([hx.policy(lambda _: answer, name="Model"), "greedy"], **QUICK)


def test_an_exception_of_the_function_is_raised() -> None:
    def broken(observation: Any) -> int:
        raise KeyError("weights")

    with pytest.raises(KeyError, match="weights"):
        hx.race([hx.policy(broken)], **QUICK)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: hx.policy(cast(Any, 3)), "a policy is a function such as model.predict, not 3"),
        (lambda: hx.policy(next_cell, name="greedy"), "'greedy' is the name of an agent"),
        (lambda: hx.policy(next_cell, name="a:b"), "without a colon"),
        (lambda: hx.policy(next_cell, name=""), "without a colon"),
        (lambda: hx.policy(next_cell, name=cast(Any, 3)), "without a colon"),
        (lambda: hx.lane(hx.policy(next_cell), alpha=0.3), "unknown argument of a policy's lane"),
        (lambda: hx.lane(hx.policy(next_cell), keep_learning=True), "a policy does not learn"),
        (lambda: hx.lane(hx.policy(next_cell), plans_with="world"), "plans with no simulator"),
        (lambda: hx.lane(hx.policy(next_cell), table="q.npz"), "leave out table"),
        (lambda: hx.lane(hx.policy(next_cell), observation=cast(Any, "x")), "unknown observation"),
    ],
)
def test_what_is_not_valid_is_refused_at_the_call(make: Any, message: str) -> None:
    with pytest.raises(hx.InvalidInput, match=message):
        make()
