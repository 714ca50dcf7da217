"""Best known distances: the farthest walks of several searches and learners, which are kept.

`best_known.json` holds the distances of the preset robots in the named worlds, one for each search
or learner that has walked there; `benchmarks/best_known.py` computes them again.
"""

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from hexapods.domain.disturbances import Push, SensorNoise, is_nothing
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.world import WORLDS, World
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.race_config import RaceConfig

DEFINITION = (
    "Best known is the farthest walk from rest of beam searches, searchers and learners, for the "
    "robot as designed; nothing proves that none is farther."
)
"""Definition of a best known distance, for readers of reports and of the page."""
COVERAGE = (
    "It was computed in MuJoCo for preset robots in named gaits and worlds on the usual grid; "
    "elsewhere a dash stands."
)
"""Sentence that follows the definition where a best known distance exists."""
PATH = Path(__file__).with_name("best_known.json")
Key = tuple[str, str, str]
"""Names of robot, world and gait."""


def best_known_m(walk: WalkingProblem, conditions: World | None = None) -> float | None:
    """Return the kept distance of a walking problem [m]; None where it was not computed.

    With a build tolerance it is that of the robot as designed; sensor noise changes no physics.

    Args:
        walk: the walking problem.
        conditions: what holds during the walk, a result of `World.as_of`; by default what holds
            from the start of the problem's world.
    """
    if walk.simulator != "mujoco" or walk.grid != FootGrid():
        return None
    robot = next((name for name, preset in PRESETS.items() if preset == walk.robot), None)
    holds = walk.world.as_of(0) if conditions is None else conditions
    physical = _physical(holds, walk.robot)
    world = next((name for name, named in WORLDS.items() if named.world.as_of(0) == physical), None)
    if robot is None or world is None:
        return None
    return kept().get((robot, world, walk.resolved_gait.name))


def best_known_in_race_m(race: RaceConfig) -> float | None:
    """Return the best known distance of a race [m].

    None where it was not computed: also if the physics changes in the middle of the race, or if it
    has another number of steps than the kept walks.
    """
    world = race.world
    physics = _physical(world.as_of(0), race.robot)
    later = (world.as_of(step) for step in world.change_steps if step < race.steps)
    changes = world.all_of(Push) or any(
        _physical(conditions, race.robot) != physics for conditions in later
    )
    return None if changes or race.steps != RACE_STEPS else best_known_m(race)


def _physical(conditions: World, robot: Robot) -> World:
    """Return the conditions without sensor noise, and without ends of earlier ones."""
    kept_on = (
        disturbance
        for disturbance in conditions.disturbances
        if not isinstance(disturbance, SensorNoise) and not is_nothing(disturbance, robot)
    )
    return World(tuple(kept_on))


@lru_cache(maxsize=1)
def kept() -> Mapping[Key, float]:
    """Return the farthest kept distance of each walking problem [m]."""
    farthest: dict[Key, float] = {}
    for row in read(PATH):
        key, distance_m = (row["robot"], row["world"], row["gait"]), float(row["distance_m"])
        farthest[key] = max(distance_m, farthest.get(key, distance_m))
    return farthest


def read(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table, one for each walking problem and what walked there.

    Each has `robot`, `world` and `gait`; `found_by`, and of beams the `width`; the `version` that
    computed it, and `distance_m`.
    """
    rows: list[dict[str, Any]] = json.loads(path.read_text("utf-8"))["distances"]
    return rows
