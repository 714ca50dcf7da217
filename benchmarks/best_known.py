"""Computes best known distances: `python benchmarks/best_known.py --world ice --out FILE`.

Beam searches over the whole walk, searchers and learners walk 50 steps from rest on the robot as
designed, in MuJoCo; the farthest of these walks is the best known. `--out
hexapods/runs/best_known.json` renews the distances that the product has.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from hexapods import __version__
from hexapods.agents import registry
from hexapods.assembly import build_simulator
from hexapods.domain.checks import check_whole
from hexapods.domain.creatures import own_gait
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS
from hexapods.domain.robot import robot
from hexapods.domain.world import WORLDS, named_world
from hexapods.experiments.report.walks import reported_walks
from hexapods.practice import train
from hexapods.races import lane, race
from hexapods.runs import beam_search, best_known
from hexapods.runs.config import WalkingProblem

MAX_WIDTH = 4096
OWN = "own"
"""In place of a gait: the one that suits each robot."""
BEAM, BONUS_BEAM = "beam", "bonus-beam"
DEFAULT_FINDERS = (BONUS_BEAM, BEAM, "greedy", "two-step", "informed", "linear-model")
DEFAULT_WIDTHS = (16, 48)
INFORMED_BUDGETS = (3, 40)
PRACTICE_STEPS, EVALUATE_EVERY = 250, 50
"""Practice of a learner; the farthest walk of all its evaluations counts."""
_PHYSICAL = [name for name, named in WORLDS.items() if named.world.one_of(SensorNoise) is None]
_COMPUTED_BY = "benchmarks/best_known.py, in MuJoCo"


def main(arguments: Sequence[str] | None = None) -> int:
    """Search as the arguments say; return 2 if they are not valid."""
    try:
        _run(_parser().parse_args(arguments))
    except HexapodError as error:
        print(f"best_known: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__)
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
        "--by",
        default=",".join(DEFAULT_FINDERS),
        metavar="LIST",
        help=f"what walks: {BEAM}, which keeps the farthest walks, {BONUS_BEAM}, which also counts "
        "what the next step is predicted to add, or names of agents; a learner practises "
        f"{PRACTICE_STEPS} steps (default {','.join(DEFAULT_FINDERS)})",
    )
    parser.add_argument(
        "--width",
        type=lambda text: tuple(map(int, _split(text))),
        default=DEFAULT_WIDTHS,
        metavar="LIST",
        help="walks that beams keep after each step "
        f"(default {','.join(map(str, DEFAULT_WIDTHS))})",
    )
    parser.add_argument(
        "--threads", type=int, default=0, help="threads of the simulator (default: one per core)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="JSON file to add every walk to; those that it has of this version are not repeated, "
        "and one of another version is replaced if this one is farther",
    )
    parser.add_argument(
        "--reports",
        metavar="FOLDERS",
        help="instead of searching, add the farthest walk of each agent in these reports of "
        "experiments, by commas; robots with a build tolerance do not count",
    )
    return parser


def _run(options: argparse.Namespace) -> None:
    """Search walk by walk, print each distance, and write it to the table at once.

    Raises:
        HexapodError: if the options are not valid.
        OSError: if the table cannot be read or written.
    """
    if options.reports:
        _add_reports(options)
        return
    finders = list(_finders(options))
    tasks = [(names, walk, finder) for names, walk in _problems(options) for finder in finders]
    rows = _read(options.out) if options.out else []
    done = {(*_key(row), row["version"]) for row in rows}
    for names, walk, finder in tasks:
        row = {**names, **finder, "version": __version__}
        if (*_key(row), row["version"]) in done:
            continue
        distance_m = _distance_m(walk, finder, options.threads)
        label = " ".join(map(str, (*names.values(), *finder.values())))
        print(f"{label}: {distance_m:.3f} m", flush=True)
        rows = _with({**row, "distance_m": round(distance_m, 6)}, rows)
        if options.out:
            _write(options.out, rows)


def _add_reports(options: argparse.Namespace) -> None:
    """Add the farthest walk of each agent in some reports, and print each that is added.

    Raises:
        InvalidInput: if a folder has no report, or there is no table to add to.
    """
    if options.out is None:
        raise InvalidInput("--reports needs --out, the table to which it adds their walks")
    farthest: dict[tuple[Any, ...], dict[str, Any]] = {}
    for walk in chain.from_iterable(map(reported_walks, map(Path, _split(options.reports)))):
        if walk.world not in _PHYSICAL or best_known.best_known_m(walk.problem) is None:
            continue
        row = {
            "robot": walk.problem.robot.name,
            "world": walk.world,
            "gait": walk.problem.resolved_gait.name,
            "found_by": walk.agent,
            "version": walk.version,
            "distance_m": round(walk.distance_m, 6),
        }
        same = farthest.setdefault(_key(row), row)
        if row["distance_m"] > same["distance_m"]:
            farthest[_key(row)] = row
    rows = _read(options.out)
    for row in farthest.values():
        after = _with(row, rows)
        if after != rows:
            print(f"{' '.join(map(str, _key(row)[:-1]))}: {row['distance_m']:.3f} m", flush=True)
        rows = after
    _write(options.out, rows)


def _finders(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Return what searches: `found_by`, and of beams the `width`.

    Raises:
        UnknownName, InvalidInput: if a name or a width is not valid.
    """
    for width in options.width:
        check_whole("width", width, 1, MAX_WIDTH)
    for name in _split(options.by):
        if name in (BEAM, BONUS_BEAM):
            yield from ({"found_by": name, "width": width} for width in options.width)
            continue
        try:
            registry.find(name)
        except UnknownName as error:
            raise UnknownName(
                "search or agent", name, [BEAM, BONUS_BEAM, *registry.registered()]
            ) from error
        yield {"found_by": name}


def _distance_m(walk: WalkingProblem, finder: Mapping[str, Any], threads: int) -> float:
    """Return the distance of the farthest walk of a search or agent [m]."""
    name = finder["found_by"]
    if "width" in finder:
        simulator = build_simulator(walk, threads)
        return beam_search.search(simulator, finder["width"], bonus=name == BONUS_BEAM)
    problem: dict[str, Any] = {"gait": walk.gait, "robot": walk.robot, "world": walk.world}
    if registry.learns(name):
        practice = train(name, steps=PRACTICE_STEPS, evaluate_every=EVALUATE_EVERY, **problem)
        return max(point.distance_m for point in practice.curve)
    budgets: list[dict[str, Any]] = [{}]
    if name == "informed":
        budgets = [{"budget": budget} for budget in INFORMED_BUDGETS]
    lanes = race([lane(name, **settings) for settings in budgets], **problem).result.lanes
    return max(each.total_distance_m or 0.0 for each in lanes)


def _problems(options: argparse.Namespace) -> Iterable[tuple[dict[str, str], WalkingProblem]]:
    """Return the walking problems that were asked for, each with its names."""
    gaits = _split(options.gait)
    for gait in gaits:
        if gait != OWN and gait not in NAMED_GAITS:
            raise UnknownName("gait", gait, [*NAMED_GAITS, OWN])
    chosen = [(name, robot(name)) for name in _split(options.robot)]
    for robot_name, design in chosen:
        for world in _split(options.world):
            walks = named_world(world)
            for gait in gaits:
                chosen_gait = own_gait(design) if gait == OWN else gait
                walk = WalkingProblem(gait=chosen_gait, robot=design, world=walks)
                name = walk.resolved_gait.name
                yield {"robot": robot_name, "world": world, "gait": name}, walk


def _with(row: dict[str, Any], rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return a table with one more row, or with that of the same key that came farther."""
    keys = [_key(entry) for entry in rows]
    if _key(row) not in keys:
        return [*rows, row]
    return [
        row if key == _key(row) and row["distance_m"] > entry["distance_m"] else entry
        for entry, key in zip(rows, keys, strict=True)
    ]


def _key(row: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(row.get(name) for name in ("robot", "world", "gait", "found_by", "width"))


def _read(path: Path) -> list[dict[str, Any]]:
    return best_known.read(path) if path.exists() and path.stat().st_size else []


def _write(path: Path, rows: list[dict[str, Any]]) -> None:
    lines = ",\n".join(f"    {json.dumps(row)}" for row in rows)
    text = f'{{\n  "computed_by": {json.dumps(_COMPUTED_BY)},\n  "distances": [\n{lines}\n  ]\n}}\n'
    whole = path.with_suffix(".new")
    whole.write_text(text, "utf-8")
    whole.replace(path)


def _split(text: str) -> list[str]:
    return [item.strip() for item in text.split(",")]


if __name__ == "__main__":
    sys.exit(main())
