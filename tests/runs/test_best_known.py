"""Best known distances: the table that is kept, and whose walks it bounds."""

from dataclasses import replace
from pathlib import Path

import pytest

from hexapods.agents.registry import registered
from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbances import Friction, Payload, Push, Slope
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS, resolve
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.world import WORLDS, World, named_world
from hexapods.experiments.report.walks import reported_walks
from hexapods.runs.best_known import PATH, best_known_in_race_m, best_known_m, kept, read
from hexapods.runs.config import WalkingProblem
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from tests.cli.running import ROOT

WALK = WalkingProblem(gait="left-right-origin")
REPORTS = ROOT / "docs" / "reproduction"
BEAMS = ("beam", "bonus-beam")
IDEAL = WalkingProblem(gait="left-right-origin", simulator="kinematic")


def test_table_says_how_its_distances_were_computed() -> None:
    for row in read(PATH):
        assert row["robot"] in PRESETS
        assert row["world"] in WORLDS
        own_gait = resolve(CREATURES[row["robot"]].gait, PRESETS[row["robot"]].azimuths_deg).name
        assert row["gait"] in (*NAMED_GAITS, own_gait)
        assert row["found_by"] in (*BEAMS, *registered())
        assert (row["found_by"] in BEAMS) == ("width" in row)
    assert all(("stiff", "flat", gait) in kept() for gait in PAPER_GAITS)


def test_the_papers_gaits_and_the_body_of_each_robot_were_searched_with_the_bonus() -> None:
    walked: dict[tuple[str, ...], set[str]] = {}
    for row in read(PATH):
        walked.setdefault((row["robot"], row["world"], row["gait"]), set()).add(row["found_by"])

    searches = {"bonus-beam", "greedy", "informed"}
    for gait in PAPER_GAITS:
        assert walked["stiff", "flat", gait] >= {*searches, "two-step", "linear-model"}
    for name, robot_of in PRESETS.items():
        gait = resolve(CREATURES[name].gait, robot_of.azimuths_deg).name
        assert (name, "flat", gait) in walked


def test_the_farthest_of_all_walks_is_best_known() -> None:
    for key, best_m in kept().items():
        walks = [row for row in read(PATH) if (row["robot"], row["world"], row["gait"]) == key]
        assert best_m == max(row["distance_m"] for row in walks)


@pytest.mark.parametrize(
    "report",
    sorted(path.parent for path in REPORTS.glob("*/summary.json")),
    ids=lambda path: path.name,
)
def test_no_agent_in_a_committed_report_walks_more_than_a_millimetre_farther(report: Path) -> None:
    walks = [(walk, best_known_m(walk.problem)) for walk in reported_walks(report)]

    assert len(walks) > 200
    assert all(best_m is not None for _, best_m in walks)
    assert [walk for walk, best_m in walks if walk.distance_m > (best_m or 0) + 0.001] == []


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
