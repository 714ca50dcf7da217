"""Best known distances: a wide beam search over the whole walk, computed once and kept.

`best_known.json` holds the distances of the preset robots in the named worlds, as far as they were
computed; `hexapods best-known` computes them again.
"""

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from hexapods.domain.disturbances import Push, SensorNoise, is_nothing
from hexapods.domain.grid import FootGrid
from hexapods.domain.observation import legal_in, observe
from hexapods.domain.robot import PRESETS, Robot
from hexapods.domain.simulator import Simulator
from hexapods.domain.types import Cells
from hexapods.domain.world import WORLDS, World
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.race_config import RaceConfig

WIDTH = 48
SAME_CELLS = 2
"""Number of walks that the beam keeps among those whose feet are planned to be in the same cells.

Without this limit it fills with copies of one walk: stuck-leg in left-right-vertical came to 0.05 m
instead of 0.27 m.
"""
DEFINITION = (
    "Best known is the farthest walk that a wide beam search found for the robot as designed; "
    "nothing proves that none is farther."
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


def search(simulator: Simulator[Any], width: int = WIDTH, steps: int = RACE_STEPS) -> float:
    """Return the largest distance along the track that a beam search finds [m].

    The beam keeps the walks that have come farthest, layer by layer over all steps; ties go to the
    walk that was found first. It knows the simulator, and reads the state without errors. What it
    finds is possible; that nothing is better is not proven.

    Args:
        simulator: of the walking problem.
        width: number of walks that are kept after each step.
        steps: number of steps.

    Raises:
        Diverged: if the physics diverges.
    """
    states = [simulator.rest()]
    for _ in range(steps):
        branches = [
            (state, action)
            for state in states
            for action in legal_in(simulator, state, observe(simulator, state, "measured"))
        ]
        parents, actions = zip(*branches, strict=True)
        states = _keep(simulator, simulator.expand(parents, actions).states, width)
    distance: float = states[0].distance_m
    return distance


def _keep(simulator: Simulator[Any], ends: list[Any], width: int) -> list[Any]:
    """Return the states that came farthest, of those with the same planned cells only a few."""
    kept: list[Any] = []
    taken: dict[Cells, int] = {}
    for index in np.argsort([-end.distance_m for end in ends], kind="stable").tolist():
        cells = tuple(simulator.grid.nearest(x, y) for x, y in ends[index].feet.offsets_m)
        if taken.get(cells, 0) < SAME_CELLS:
            taken[cells] = taken.get(cells, 0) + 1
            kept.append(ends[index])
        if len(kept) == width:
            break
    return kept


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
    robot = next((name for name, one in PRESETS.items() if one == walk.robot), None)
    holds = walk.world.as_of(0) if conditions is None else conditions
    physical = _physical(holds, walk.robot)
    world = next((name for name, one in WORLDS.items() if one.world.as_of(0) == physical), None)
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
    changes = world.all_of(Push) or any(_physical(one, race.robot) != physics for one in later)
    return None if changes or race.steps != RACE_STEPS else best_known_m(race)


def _physical(conditions: World, robot: Robot) -> World:
    """Return the conditions without sensor noise, and without ends of earlier ones."""
    kept_on = (
        one
        for one in conditions.disturbances
        if not isinstance(one, SensorNoise) and not is_nothing(one, robot)
    )
    return World(tuple(kept_on))


@lru_cache(maxsize=1)
def kept() -> Mapping[Key, float]:
    """Return all kept distances [m]."""
    return {_key(row): float(row["distance_m"]) for row in read(PATH)}


def read(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table: robot, world, gait, width, version and distance_m."""
    rows: list[dict[str, Any]] = json.loads(path.read_text("utf-8"))["distances"]
    return rows


def _key(row: Mapping[str, Any]) -> Key:
    return row["robot"], row["world"], row["gait"]
