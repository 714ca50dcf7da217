"""Best known distances: the beam search over a whole walk, and the table that is kept."""

from dataclasses import replace
from itertools import pairwise

import pytest

from hexapods.assembly import build_simulator
from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbances import Friction, Payload, Push, Slope
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS, resolve
from hexapods.domain.observation import legal_actions, observe
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.world import WORLDS, World, named_world
from hexapods.runs.best_known import PATH, best_known_in_race_m, best_known_m, kept, read, search
from hexapods.runs.config import WalkingProblem
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig

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
    found = {search(build_simulator(walk, threads), width=2, steps=3) for threads in (1, 2)}

    assert len(found) == 1


def test_longer_walks_come_farther() -> None:
    simulator = build_simulator(IDEAL)
    found = [search(simulator, width=4, steps=steps) for steps in (2, 6, 12)]

    assert all(near < far for near, far in pairwise(found))


def test_table_says_how_its_distances_were_computed() -> None:
    for row in read(PATH):
        assert row["robot"] in PRESETS
        assert row["world"] in WORLDS
        own = resolve(CREATURES[row["robot"]].gait, PRESETS[row["robot"]].azimuths_deg).name
        assert row["gait"] in (*NAMED_GAITS, own)
        assert row["width"] >= 48
    assert len(kept()) == len(read(PATH))
    assert all(("stiff", "flat", gait) in kept() for gait in PAPER_GAITS)


def test_distance_is_known_of_preset_robots_in_named_worlds() -> None:
    flat, limp = WALK, replace(WALK, world=named_world("limp-pair"))

    assert best_known_m(flat) == kept()["stiff", "flat", "left-right-origin"]
    assert best_known_m(limp) == kept()["stiff", "limp-pair", "left-right-origin"]
    assert best_known_m(flat, limp.world.as_of(0)) == best_known_m(limp)
    assert best_known_m(replace(WALK, world=named_world("noise"))) == best_known_m(flat)
    flat_again = World(
        (Slope(degrees=0.0, direction_deg=90.0), Payload(kg=0.0, x_m=0.1), Friction(value=1.0))
    )
    assert best_known_m(replace(WALK, world=flat_again)) == best_known_m(flat)
    assert best_known_m(replace(WALK, robot=robot("stiff"), tolerance=0.03)) == best_known_m(flat)


@pytest.mark.parametrize(
    "walk",
    [
        IDEAL,
        replace(WALK, divisions=3),
        replace(WALK, grid_side_m=0.03),
        replace(WALK, robot=replace(Robot(), femur_m=0.081, name="stiff (modified)")),
        replace(
            WALK,
            world=World(
                (*named_world("limp-pair").disturbances, *named_world("slope").disturbances)
            ),
        ),
    ],
)
def test_distance_of_any_other_walk_is_not_known(walk: WalkingProblem) -> None:
    assert best_known_m(walk) is None


def test_distance_of_a_race_is_known_unless_something_happens_in_between() -> None:
    race = RaceConfig(gait="left-right-origin", lanes=(LaneConfig(agent="greedy"),))
    limp = named_world("limp-pair")

    assert best_known_in_race_m(race) == best_known_m(WALK)
    in_damage = replace(race, world=limp)
    assert best_known_in_race_m(in_damage) == best_known_m(replace(WALK, world=limp))
    assert best_known_in_race_m(replace(race, world=limp.later(25))) is None
    for unphysical in (named_world("noise").later(25), World((Payload(kg=0.0, at_step=9),))):
        in_both = replace(race, world=limp + unphysical.disturbances)
        assert best_known_in_race_m(in_both) == best_known_in_race_m(in_damage)
    ends = World((Slope(degrees=8.0, until_step=49),))
    assert best_known_in_race_m(replace(race, world=ends)) is None
    at_the_end = World((Slope(degrees=8.0, until_step=50),))
    assert best_known_in_race_m(replace(race, world=at_the_end)) == best_known_m(
        replace(WALK, world=named_world("slope"))
    )
    assert best_known_in_race_m(replace(race, world=World((Push(impulse_ns=2.0),)))) is None
    assert best_known_in_race_m(replace(race, steps=60)) is None
