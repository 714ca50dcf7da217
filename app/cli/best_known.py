"""`hexapods best-known`: find the farthest walks by a wide beam search, per world and gait."""

import argparse
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from app.cli.files import check_writable, write_whole
from app.cli.options import CommandParser, integer, split
from app.cli.terminal import progress
from hexapods import __version__
from hexapods.assembly import build_simulator
from hexapods.domain.checks import check_whole
from hexapods.domain.creatures import own_gait
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import UnknownName
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS
from hexapods.domain.robot import robot
from hexapods.domain.world import WORLDS, named_world
from hexapods.runs import best_known
from hexapods.runs.config import WalkingProblem

MAX_WIDTH = 4096
OWN = "own"
"""In place of a gait: the one that suits each robot."""
_PHYSICAL = [name for name, one in WORLDS.items() if one.world.one_of(SensorNoise) is None]
_COMPUTED_BY = "hexapods best-known: a beam search over the whole walk, in MuJoCo"


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "best-known", help="search for the farthest walks", description=__doc__
    )
    parser.add_argument("--robot", default="stiff", help="presets, by commas (default stiff)")
    parser.add_argument(
        "--world",
        default=",".join(_PHYSICAL),
        help=f"one or more of {', '.join(WORLDS)} (default all in which the physics differs)",
    )
    parser.add_argument(
        "--gait",
        default=",".join(PAPER_GAITS),
        help=f"one or more of {', '.join(NAMED_GAITS)}, or own for each robot's own "
        "(default the paper's four)",
    )
    parser.add_argument(
        "--width",
        type=integer,
        default=best_known.WIDTH,
        help=f"walks that are kept after each step (default {best_known.WIDTH})",
    )
    parser.add_argument(
        "--threads",
        type=integer,
        default=0,
        help="threads of the simulator (default: one per core)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="JSON file to update with every distance that is farther than its own; searches that "
        "it has for this width and version are not repeated",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Search walk by walk, print each distance, and keep it at once.

    Raises:
        HexapodError: if the options are not valid, or the table cannot be written.
    """
    check_whole("width", options.width, 1, MAX_WIDTH)
    problems = list(_problems(options))
    rows = _read(options.out) if options.out else []
    done = {_key(row) for row in rows}
    with progress() as bar:
        task = bar.add_task("searching", total=len(problems))
        for names, walk in problems:
            row = {**names, "width": options.width, "version": __version__}
            if _key(row) not in done:
                found = best_known.search(build_simulator(walk, options.threads), options.width)
                print(f"{' '.join(names.values())}: {found:.3f} m", flush=True)
                rows = _with({**row, "distance_m": round(found, 6)}, rows)
                if options.out:
                    _write(options.out, rows)
            bar.update(task, advance=1)
    return 0


def _problems(options: argparse.Namespace) -> Iterable[tuple[dict[str, str], WalkingProblem]]:
    """Return the walking problems that were asked for, each with its names."""
    gaits = split(options.gait)
    for gait in gaits:
        if gait != OWN and gait not in NAMED_GAITS:
            raise UnknownName("gait", gait, [*NAMED_GAITS, OWN])
    chosen = [(name, robot(name)) for name in split(options.robot)]
    for robot_name, one in chosen:
        for world in split(options.world):
            walks = named_world(world)
            for gait in gaits:
                chosen_gait = own_gait(one) if gait == OWN else gait
                walk = WalkingProblem(gait=chosen_gait, robot=one, world=walks)
                name = walk.resolved_gait.name
                yield {"robot": robot_name, "world": world, "gait": name}, walk


def _with(row: dict[str, Any], rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return a table with one more row, or with that of the same walk that came farther."""
    same = [_walk(one) == _walk(row) for one in rows]
    if not any(same):
        return [*rows, row]
    return [
        row if is_same and row["distance_m"] > one["distance_m"] else one
        for one, is_same in zip(rows, same, strict=True)
    ]


def _walk(row: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in ("robot", "world", "gait"))


def _key(row: Mapping[str, Any]) -> tuple[Any, ...]:
    return (*_walk(row), row["width"], row["version"])


def _read(path: Path) -> list[dict[str, Any]]:
    check_writable(str(path))
    return best_known.read(path) if path.exists() and path.stat().st_size else []


def _write(path: Path, rows: list[dict[str, Any]]) -> None:
    lines = ",\n".join(f"    {json.dumps(row)}" for row in rows)
    text = f'{{\n  "computed_by": {json.dumps(_COMPUTED_BY)},\n  "distances": [\n{lines}\n  ]\n}}\n'
    write_whole(str(path), text.encode())
