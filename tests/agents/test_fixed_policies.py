"""Policies that neither learn nor look ahead: the order of the wave, and the random walk."""

import time
from collections import Counter

import numpy as np
import pytest

from hexapods.agents.fixed_policies import RandomWalk, Wave
from hexapods.agents.protocol import Problem
from hexapods.assembly import build_walkers
from hexapods.domain.gait import GaitSpec
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action
from hexapods.runs.config import WalkingProblem, problem_of
from hexapods.runs.gait_analysis import gait_figures
from hexapods.runs.lane import LaneConfig, lane_config
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.recorded_walk import walk_of_lane
from hexapods.runs.recording import LaneRecording

RIPPLE = GaitSpec(1, 2, pairs=((1, 4), (5, 3), (6, 2)))
FRONT_LEFT, FRONT_RIGHT = 1, 2


def problem(gait: str | GaitSpec, divisions: int = 2) -> Problem:
    return problem_of(WalkingProblem(gait=gait, simulator="kinematic", divisions=divisions))


def raced(lane: LaneConfig, gait: str | GaitSpec = "left-right-origin") -> LaneRecording:
    config = RaceConfig(gait=gait, simulator="kinematic", lanes=(lane,))
    *_, lanes = record_race(build_walkers(config, [None]), config, time.perf_counter)
    return lanes[0]


def pairs_of(wave: Wave, gait: str | GaitSpec, steps: int) -> list[tuple[int, ...]]:
    """Return the pairs of legs that swing, where every foot is observed at home."""
    legal = legal_actions((0, 0, 0), 5)
    return [problem(gait).groups[wave.act((0, 0, 0), legal).group] for _ in range(steps)]


@pytest.mark.parametrize(
    ("gait", "pairs"),
    [
        ("left-right-vertical", [(5, 4), (6, 3), (1, 2)]),
        ("left-right-origin", [(2, 5), (3, 6), (1, 4)]),  # on the right 5, 6, 1
        ("front-back-vertical", [(6, 4), (2, 5), (1, 3)]),
        (RIPPLE, [(5, 3), (6, 2), (1, 4)]),  # on the right 5, 6, 1, on the left 4, 3, 2
    ],
)
def test_a_wave_runs_from_back_to_front(gait: str | GaitSpec, pairs: list[tuple[int, int]]) -> None:
    assert pairs_of(Wave(problem(gait)), gait, 6) == pairs * 2
    retrograde = Wave(problem(gait), direction="retrograde")
    assert pairs_of(retrograde, gait, 3) == pairs[::-1]


def test_a_wave_puts_feet_straight_ahead_or_to_the_other_corner_of_the_front_edge() -> None:
    wave = Wave(problem("left-right-vertical"))
    cells = (0, 0, FRONT_LEFT)  # pair 2 is the one at the back
    assert wave.act(cells, legal_actions(cells, 5)) == Action(2, FRONT_RIGHT)
    finer = Wave(problem("left-right-vertical", divisions=3))
    assert finer.act((0, 0, 0), legal_actions((0, 0, 0), 9)) == Action(2, 2)  # front middle


@pytest.mark.parametrize("gait", ["left-right-origin", "left-right-vertical", RIPPLE])
def test_a_wave_walks_as_far_as_a_robot_can_without_slip(gait: str | GaitSpec) -> None:
    lane = raced(lane_config("wave"), gait)
    assert lane.distance_m == pytest.approx(24.833 * 0.02, abs=1e-4)
    config = WalkingProblem(gait=gait, simulator="kinematic")
    figures = gait_figures(walk_of_lane(lane, config, config.world), 0, 16)
    assert figures is not None
    assert figures.cycle is not None
    assert figures.cycle.steps == 3


def test_a_wave_continues_from_its_state() -> None:
    gait = "left-right-vertical"
    first, second = Wave(problem(gait)), Wave(problem(gait))
    pairs_of(first, gait, 2)
    second.load(first.state())
    assert pairs_of(second, gait, 1) == [(1, 2)]


def test_a_random_walk_takes_every_legal_step_equally_often() -> None:
    walker = RandomWalk(np.random.default_rng(0))
    legal = legal_actions((0, 0, 0), 5)
    taken = Counter(walker.act((0, 0, 0), legal) for _ in range(6000))
    assert set(taken) == set(legal)
    assert all(abs(count - 500) < 5 * np.sqrt(500) for count in taken.values())


def test_a_random_walk_gets_nowhere() -> None:
    assert abs(raced(lane_config("random-walk")).distance_m) < 0.1
