"""Protocols of the benchmark: frozen data, which is read here and nowhere changed."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from hexapods.benchmarking.draws import drawn_body, drawn_damage
from hexapods.domain.errors import UnknownName
from hexapods.domain.gait import read_gait
from hexapods.domain.robot import Robot, read_document, robot
from hexapods.domain.world import parse_world
from hexapods.runs.config import WalkingProblem
from hexapods.runs.seeding import generator

PROTOCOLS: Mapping[str, str] = {"hexabench-1": "hexabench_1.json"}
"""Files of the protocols that this version knows, by name."""
DEFAULT_PROTOCOL = "hexabench-1"
PLAIN_SEED = 0
"""Root seed whose drawn tasks have a stored best known distance."""
_FOLDER = Path(__file__).parent
_BODY, _DAMAGE = 1, 2
"""Spawn keys of the generators that draw; those of the trials have two numbers."""


@dataclass(frozen=True, kw_only=True)
class BestKnown:
    """Farthest walk that is known of a task.

    Attributes:
        distance_m: along the track in 50 steps from rest, of the robot as designed [m].
        found_by: what walked it.
    """

    distance_m: float
    found_by: str


@dataclass(frozen=True, kw_only=True)
class BenchmarkTask:
    """A walking problem of a protocol.

    Attributes:
        name: by which it is chosen.
        title: for people.
        robot: a preset's name, a mapping as `hexapods.domain.robot.robot` takes it, or the `file`
            of a robot's document beside the protocol; None where it is drawn.
        gait: as `read_gait` takes it; None where it is drawn.
        world: as `parse_world` takes it; None where it is drawn.
        drawn: what the root seed draws: a `body` with its gait, a `damage` with a gait, or nothing.
        best_known: stored; of a drawn task for the root seed `PLAIN_SEED`.
    """

    name: str
    title: str
    robot: str | Mapping[str, Any] | None
    gait: str | Mapping[str, Any] | None
    world: str | None
    drawn: str | None
    best_known: BestKnown

    def walk(self, seed: int, tolerance: float) -> WalkingProblem:
        """Return the walking problem.

        Args:
            seed: root seed, by which bodies and damages are drawn.
            tolerance: build tolerance of the robots.
        """
        settings: dict[str, Any] = {"tolerance": tolerance}
        if self.robot is not None:
            settings["robot"] = _robot(self.robot)
        if self.gait is not None:
            settings["gait"] = read_gait(self.gait)
        if self.world is not None:
            settings["world"] = parse_world(self.world)
        if self.drawn == "body":
            settings["robot"], settings["gait"] = drawn_body(generator(seed, _BODY))
        elif self.drawn == "damage":
            settings["world"], settings["gait"] = drawn_damage(generator(seed, _DAMAGE))
        return WalkingProblem(**settings)


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """A frozen protocol.

    Attributes:
        name: by which it is chosen, and which score files have.
        tasks: by name, in their order.
        budgets: numbers of steps of practice, ascending, each a training of its own.
        seeds: number of seeds of each task and budget.
        tolerance: build tolerance of the robots, of which each seed draws one.
        steps_per_episode: number of steps for which ε is constant.
        beam_width: width of the beam, with a bonus for the next step, that finds the best known
            distance of other draws.
    """

    name: str
    tasks: Mapping[str, BenchmarkTask]
    budgets: tuple[int, ...]
    seeds: int
    tolerance: float
    steps_per_episode: int
    beam_width: int


@cache
def protocol(name: str) -> Protocol:
    """Return a protocol by its name.

    Raises:
        UnknownName: if this version knows none of this name.
    """
    if name not in PROTOCOLS:
        raise UnknownName("protocol", name, PROTOCOLS)
    data = json.loads((_FOLDER / PROTOCOLS[name]).read_text("utf-8"))
    return Protocol(
        name=name,
        tasks={row["name"]: _task(row) for row in data["tasks"]},
        budgets=tuple(data["budgets"]),
        seeds=data["seeds"],
        tolerance=data["tolerance"],
        steps_per_episode=data["steps_per_episode"],
        beam_width=data["beam_width"],
    )


def tasks_of(chosen: Protocol, names: Sequence[str] | None) -> list[BenchmarkTask]:
    """Return tasks of a protocol by their names, in the protocol's order; None for all.

    Raises:
        UnknownName: if it has no task of a name.
    """
    for name in names or ():
        if name not in chosen.tasks:
            raise UnknownName(f"task of {chosen.name}", name, chosen.tasks)
    return [task for name, task in chosen.tasks.items() if names is None or name in names]


def _task(row: Mapping[str, Any]) -> BenchmarkTask:
    parts = {name: row.get(name) for name in ("robot", "gait", "world", "drawn")}
    return BenchmarkTask(
        name=row["name"],
        title=row["title"],
        best_known=BestKnown(**row["best_known"]),
        **parts,
    )


def _robot(described: str | Mapping[str, Any]) -> Robot:
    if isinstance(described, Mapping) and "file" in described:
        path = _FOLDER / described["file"]
        return read_document(path.read_bytes(), path.stem)
    return robot(described)
