"""Beam search over a whole walk, plain and with a bonus for the next step."""

from dataclasses import replace
from itertools import pairwise

import pytest

from hexapods.assembly import build_simulator
from hexapods.domain.creatures import CREATURES
from hexapods.domain.observation import legal_actions, observe
from hexapods.domain.robot import robot
from hexapods.domain.world import named_world
from hexapods.runs.beam_search import search
from hexapods.runs.config import WalkingProblem

WALK = WalkingProblem(gait="left-right-origin")
IDEAL = WalkingProblem(gait="left-right-origin", simulator="kinematic")


def test_wide_beam_is_an_exhaustive_search() -> None:
    simulator = build_simulator(IDEAL)
    ends = [simulator.rest()]
    for _ in range(2):
        ends = [
            simulator.step(state, action).state
            for state in ends
            for action in legal_actions(observe(simulator, state, "measured"), 4)
        ]

    assert search(simulator, width=200, steps=2) == max(end.distance_m for end in ends)


def test_beam_of_the_kinematic_problem_is_as_good_as_greedy() -> None:
    # Nothing is better than greedy without slip: every look-ahead comes to 24.833 h (docs/figures).
    assert search(build_simulator(IDEAL), width=8) == pytest.approx(24.833 * 0.02, abs=2e-5)


def test_search_is_deterministic_at_any_number_of_threads() -> None:
    walk = replace(WALK, world=named_world("limp-pair"))
    distances = {search(build_simulator(walk, threads), width=2, steps=3) for threads in (1, 2)}

    assert len(distances) == 1


def test_longer_walks_come_farther() -> None:
    simulator = build_simulator(IDEAL)
    distances = [search(simulator, width=4, steps=steps) for steps in (2, 6, 12)]

    assert all(near < far for near, far in pairwise(distances))


@pytest.mark.promises
def test_bonus_makes_a_narrow_beam_better_than_a_wide_one_without() -> None:
    starfish = replace(IDEAL, robot=robot("starfish"), gait=CREATURES["starfish"].gait)
    simulator = build_simulator(starfish)

    with_bonus = search(simulator, width=48, bonus=True)
    assert with_bonus > max(search(simulator, width) for width in (8, 48, 200))


def test_bonus_does_not_count_after_the_last_step() -> None:
    simulator = build_simulator(IDEAL)

    # From rest the first step moves the body by a third of the half side at most.
    assert search(simulator, width=8, steps=1, bonus=True) == pytest.approx(0.02 / 3)
