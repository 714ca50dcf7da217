"""Walks from rest that a finished report has, read from its files."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import PRESETS
from hexapods.domain.world import parse_world
from hexapods.runs.config import WalkingProblem


class ReportedWalk(NamedTuple):
    """An evaluation in a report: a walk of 50 steps from rest."""

    trial: str
    agent: str
    world: str
    """Name of the world, or its disturbances, as the report has it."""
    problem: WalkingProblem
    distance_m: float
    """Displacement along the track."""
    version: str
    """Of the library that walked."""


def reported_walks(folder: Path) -> Iterator[ReportedWalk]:
    """Return the walks of preset robots as designed that a report has.

    Robots with a build tolerance are others, each of which may walk farther than the design: a
    report of them has no walk here.

    Args:
        folder: with `summary.json` and `trials.csv` of an experiment.

    Raises:
        InvalidInput: if it has no report that can be read.
    """
    try:
        summary = json.loads((folder / "summary.json").read_text("utf-8"))
        rows = list(csv.DictReader((folder / "trials.csv").read_text("utf-8").splitlines()))
        config, version = summary["config"], summary["versions"]["racing-hexapods"]
        if config.get("tolerance"):
            return
        for row in rows:
            if row["distance_m"] and row["robot"] in PRESETS:
                world = row.get("world", "flat")
                problem = WalkingProblem(
                    gait=row["gait"],
                    robot=PRESETS[row["robot"]],
                    simulator=config["simulator"],
                    divisions=int(row["divisions"]),
                    grid_side_m=float(row["grid_side_m"]),
                    world=parse_world(world),
                )
                distance_m = float(row["distance_m"])
                yield ReportedWalk(row["trial"], row["agent"], world, problem, distance_m, version)
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{folder} has no report of an experiment: {error}") from error
