"""Configs of races: valid values and refusals."""

from typing import Any

import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig

GAIT = "left-right-origin"
LANES = (LaneConfig(agent="greedy"),)


def test_a_race_has_fifty_steps_by_default() -> None:
    assert RaceConfig(gait=GAIT, lanes=LANES).steps == 50


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"lanes": ()}, "a race has 1 to 6 lanes, not 0"),
        ({"lanes": LANES * 7}, "a race has 1 to 6 lanes, not 7"),
        ({"steps": 0}, "steps must be a whole number from 1"),
        ({"seed": -3}, "seed must be a whole number of at least 0"),
    ],
)
def test_invalid_race_is_refused_with_the_valid_values(
    fields: dict[str, Any], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        RaceConfig(**{"gait": GAIT, "lanes": LANES, **fields})
