"""The rules of a tournament, and its secret draws."""

import hashlib
from collections import Counter
from typing import Any

import pytest

from hexapods.domain.body import MAX_LEGS
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.grid import MAX_DIVISIONS, FootGrid
from hexapods.domain.records import from_json, to_json
from hexapods.domain.robot import PRESETS, robot
from hexapods.domain.world import named_world
from hexapods.experiments.statistics import MIN_RESAMPLED
from hexapods.runs.config import RACE_STEPS
from hexapods.tournaments.rules import (
    DEFAULT_TRANSITIONS,
    MIN_DRAWS,
    TournamentRules,
    commitment_of,
    draws_of,
)
from tests.tournaments.sample_tournaments import SECRET, rules_of

SMALL = robot({"preset": "dog", "body_height_m": 0.2})
"""It stands on stretched legs."""


def test_the_draws_are_enough_for_intervals_that_decide() -> None:
    assert MIN_DRAWS == MIN_RESAMPLED


def test_the_draws_follow_from_the_secret() -> None:
    rules = rules_of(simulator="mujoco", draws=8, worlds=("flat", "ice", "limp:legs=1,4"))
    draws = draws_of(rules, SECRET)
    assert draws == draws_of(rules, SECRET)
    assert len({draw.seed for draw in draws}) == 8
    assert all(0 <= draw.seed < 2**53 for draw in draws)
    assert sorted(Counter(draw.world for draw in draws).values()) == [2, 3, 3]
    assert draws != draws_of(rules, SECRET[::-1])


def test_the_commitment_is_the_sha256_of_the_secret() -> None:
    assert commitment_of(SECRET) == hashlib.sha256(SECRET.encode("ascii")).hexdigest()


@pytest.mark.parametrize("secret", ["", "ab" * 31, "AB" * 32, "xy" * 32, f"{SECRET}\n"])
def test_a_secret_is_64_digits(secret: str) -> None:
    with pytest.raises(InvalidInput, match="64 hexadecimal digits"):
        commitment_of(secret)
    with pytest.raises(InvalidInput, match="64 hexadecimal digits"):
        draws_of(rules_of(), secret)


def test_rules_of_before_there_was_a_limit_of_transitions_have_that_of_then() -> None:
    plain = to_json(rules_of())
    del plain["transitions"]
    assert from_json(TournamentRules, plain) == rules_of(transitions=40_000)


def test_the_limit_of_then_allows_greedy_everywhere() -> None:
    # Each leg may be a group.
    cells = len(FootGrid(divisions=MAX_DIVISIONS))
    assert RACE_STEPS * MAX_LEGS * (cells - 1) <= DEFAULT_TRANSITIONS


def test_the_gaits_of_creatures_are_written_out() -> None:
    rules = rules_of(robots=(PRESETS["ant"], PRESETS["dog"]))
    assert rules.gaits == ("tripod", "trot")
    assert rules.gait_of(PRESETS["dog"]) == "trot"
    assert rules.gait_of(PRESETS["stiff"]) == rules.gait
    assert from_json(TournamentRules, to_json(rules)) == rules


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"draws": 4}, "draws must be a whole number from 5 to 100, not 4"),
        ({"draws": 101}, "draws must be a whole number from 5 to 100, not 101"),
        ({"steps": 5001}, "steps must be a whole number from 1 to 5,000"),
        ({"steps": 0}, "steps must be"),
        ({"transitions": 499}, "transitions must be a whole number from 500 to 100,000, not 499"),
        ({"transitions": 100_001}, "transitions must be a whole number from 500 to 100,000"),
        ({"transitions": True}, "transitions must be a whole number"),
        ({"transitions": 599}, "transitions must be at least 600 here, .* greedy simulates"),
        ({"divisions": 3, "transitions": 1199}, "transitions must be at least 1,200 here"),
        ({"worlds": ()}, "worlds must be 1 to 20, not 0"),
        ({"worlds": ("flat", "moon")}, "unknown world 'moon'"),
        ({"worlds": ("flat", "ice")}, "the kinematic simulator knows no friction"),
        ({"worlds": ("flat", "flat")}, "flat is there twice"),
        ({"worlds": ("noise", "sensor-noise:sd_m=0.001:at=5")}, "leave out at and until"),
        ({"world": named_world("noise")}, "leave out disturbances"),
        ({"tolerance": 0.03}, "the kinematic simulator knows no build tolerance"),
        ({"robots": (PRESETS["ant"], PRESETS["ant"])}, "ant is there twice"),
        ({"robots": (PRESETS["stiff"],)}, "stiff is there twice"),
        ({"robots": tuple(robot({"femur_m": 0.1 + n / 1e4}) for n in range(21))}, "at most 20"),
        ({"robots": (PRESETS["dog"],), "gaits": ("trot", "trot")}, "as many as robots, 1, not 2"),
        ({"robots": (PRESETS["dog"],), "gaits": ("tripod",)}, "tripod"),
        ({"robots": (SMALL,)}, "^dog .*: leg 1 cannot reach"),
    ],
)
def test_rules_that_are_not_valid_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(HexapodError, match=message):
        rules_of(**options)


def test_every_creature_must_be_able_to_walk_in_every_world() -> None:
    with pytest.raises(InvalidInput, match="leg"):
        rules_of(simulator="mujoco", worlds=("limp:legs=6",), robots=(PRESETS["dog"],))
