"""Imports robots' files: `python benchmarks/robot_files.py FILE_OR_FOLDER[:DOCUMENT] …`.

A folder is packed as the command line does it; after a colon follows the document in it, if there
are several. Prints a line for each, with what was guessed and repaired below it, and ends with 1 if
one is refused. With `--walk` each also walks in MuJoCo, on the grid that suits its size: 50 steps
by greedy and 100 by `linear-model`, which begins untrained. With `--in-this-process` a profiler
sees the import.

`--collection FOLDER` reads the robots of `public_robots.csv` instead, from copies of their
repositories in `FOLDER/OWNER+NAME`, and prints a table in Markdown: whether each is imported, with
the legs and the forward direction that a person sees in it, what it takes of processor and memory,
and with `--walk` the share of the law that greedy walks. Robots with fewer than three legs, and
files that MuJoCo refuses as well (0 legs), are to be refused.
"""

import argparse
import csv
import json
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hexapods as hx
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.gait import resolve
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.imports.child import inspect_robot_file
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import silence_mujoco
from hexapods.imports.documents.folder import read_robot_path
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.reading import read_in_this_process

_STEPS = 50
_FORWARD_DEG = {"x": 0.0, "y": 90.0, "-x": 180.0, "-y": -90.0}
_COLLECTION = Path(__file__).with_name("public_robots.csv")


def main() -> int:
    """Import all that is named on the command line, or the collection."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", metavar="FILE_OR_FOLDER[:DOCUMENT]")
    parser.add_argument("--walk", action="store_true")
    parser.add_argument("--in-this-process", action="store_true")
    parser.add_argument("--collection", type=Path, metavar="FOLDER")
    parser.add_argument("--measure", metavar="FILE_OR_FOLDER:DOCUMENT", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure is not None:
        print(json.dumps(_measured(options.measure, walks=options.walk)))
        return 0
    if options.collection is not None:
        print_collection(options.collection, walks=options.walk)
        return 0
    refused = 0
    for named in options.files:
        path, _, document = named.partition(":")
        choices = Choices(file=document or None)
        read = read_in_this_process if options.in_this_process else inspect_robot_file
        if options.in_this_process:
            silence_mujoco()
        began_s = time.perf_counter()
        try:
            data, name = read_robot_path(Path(path))
            robot = read(data, name, choices).valid_robot()
        except InvalidInput as error:
            refused += 1
            print(f"{named}: refused: {error}")
            continue
        _print(named, robot, len(data), time.perf_counter() - began_s)
        if options.walk:
            _walk(robot)
    return min(refused, 1)


def _print(named: str, robot: ImportedRobot, size: int, took_s: float) -> None:
    joints = sorted({len(leg.joints) for leg in robot.legs})
    triangles = sum(link.mesh.triangles for link in robot.model.links if link.mesh)
    print(
        f"{named}: {robot.name}, {robot.file_format}, {size / 1e6:.1f} MB, {took_s:.2f} s, "
        f"{robot.mass_kg:.1f} kg, {len(robot.legs)} legs of {'/'.join(map(str, joints))} joints, "
        f"stands {robot.body_height_m:.3f} m high, reaches a grid: {robot.reaches_grid}, "
        f"{triangles:,} triangles, gait {robot.gait}"
    )
    for sentence in robot.guesses:
        print(f"  guess: {sentence}")
    for sentence in robot.repairs:
        print(f"  repair: {sentence}")


def _walk(imported: ImportedRobot) -> None:
    robot = imported.robot(imported.name)
    side_m = usual_grid_side_m(robot, imported.gait)

    def distance_m(agent: str, steps: int) -> float:
        race = hx.race([agent], robot=robot, gait=imported.gait, grid_side_m=side_m, steps=steps)
        return race.standings[0].total_distance_m

    groups = len(resolve(imported.gait, robot.azimuths_deg).groups)
    first, distance_of_100 = (distance_m("linear-model", steps) for steps in (_STEPS, 2 * _STEPS))
    print(
        f"  grid {side_m:.3f} m, law {_STEPS * side_m / (groups + 1):.2f} m, greedy "
        f"{distance_m('greedy', _STEPS):.2f} m, linear-model 1-50 {first:.2f} m, 51-100 "
        f"{distance_of_100 - first:.2f} m"
    )


def print_collection(folder: Path, *, walks: bool) -> None:
    """Print a row for each robot of the collection, and what holds for all."""
    robots = expected_robots()
    rows = []
    print("| robot | imported | legs | forward | greedy, of the law | CPU [s] | memory [MB] |")
    print("|---|---|---|---|---|---|---|")
    for robot in robots:
        path = folder / robot["repository"].replace("/", "+") / robot["path"]
        if not path.exists():
            print(f"| {robot['robot']} | not in the folder | | | | | |", flush=True)
            continue
        command = [sys.executable, __file__, "--measure", f"{path}:{robot['document']}"]
        output = subprocess.run(
            [*command, *(["--walk"] if walks else [])], capture_output=True, text=True, check=True
        ).stdout
        row = _compared(robot, json.loads(output.splitlines()[-1]))
        rows.append(row)
        print(_as_markdown(row), flush=True)
    legged = [row for row in rows if row["has_legs"]]
    for name in ("is_imported", "legs_right", "forward_right"):
        judged = [row for row in legged if row[name] is not None]
        print(f"{name}: {sum(row[name] for row in judged)} of {len(judged)}")
    right = sum(not row["is_imported"] for row in rows if not row["has_legs"])
    print(f"refused rightly: {right} of {len(rows) - len(legged)}")


def expected_robots() -> list[dict[str, str]]:
    """Return the collection, each with what a person sees in it."""
    with _COLLECTION.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _measured(named: str, *, walks: bool) -> dict[str, Any]:
    """Return what came of one robot, in a process that has read no other."""
    path, _, document = named.rpartition(":")
    choices = Choices(file=document or None)
    try:
        data, name = read_robot_path(Path(path))
        reading = inspect_robot_file(data, name, choices)
        robot = reading.valid_robot()
    except HexapodError as error:
        return {"problem": str(error)}
    silence_mujoco()
    before_kb, began_s = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    read_in_this_process(data, name, choices)
    seconds = time.process_time() - began_s
    megabytes = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb) / 1024
    return {
        "problem": None,
        "legs": len(robot.legs),
        "joints": sorted({len(leg.joints) for leg in robot.legs}),
        "forward_deg": robot.forward_deg,
        "seconds": seconds,
        "megabytes": megabytes,
        "share": _share_of_law(robot) if walks else None,
    }


def _share_of_law(imported: ImportedRobot) -> float | str:
    """Return the distance that greedy walks as a share of the law, or why it does not walk."""
    robot = imported.robot(imported.name)
    gait = resolve(imported.gait, robot.azimuths_deg)
    try:
        side_m = usual_grid_side_m(robot, imported.gait)
        race = hx.race(
            ["greedy"], robot=robot, gait=imported.gait, grid_side_m=side_m, steps=_STEPS
        )
    except HexapodError as error:
        return str(error)
    return race.standings[0].total_distance_m / (_STEPS * side_m / (len(gait.groups) + 1))


def _compared(robot: dict[str, str], measured: dict[str, Any]) -> dict[str, Any]:
    """Return a row: what came, and whether it is what a person sees; None if no one has said."""
    is_imported = measured["problem"] is None
    legs, forward = robot["legs"], robot["forward"]
    return {
        **measured,
        "robot": robot["robot"],
        "has_legs": legs not in ("0", "2"),
        "is_imported": is_imported,
        "legs_right": is_imported and measured["legs"] == int(legs) if legs else None,
        "forward_right": is_imported
        and abs((measured["forward_deg"] - _FORWARD_DEG[forward] + 180) % 360 - 180) < 1
        if forward
        else None,
    }


def _as_markdown(row: dict[str, Any]) -> str:
    if not row["is_imported"]:
        return f"| {row['robot']} | no: {row['problem']} | | | | | |"
    share = row["share"]
    return "| " + " | ".join(_cells(row, share)) + " |"


def _cells(row: dict[str, Any], share: float | str | None) -> Iterator[str]:
    yield row["robot"]
    yield "yes"
    joints = "/".join(map(str, row["joints"]))
    yield f"{row['legs']} of {joints}{'' if row['legs_right'] is not False else ' (wrong)'}"
    wrong = " (wrong)" if row["forward_right"] is False else ""
    yield f"{row['forward_deg']:g}°{wrong}"
    yield "" if share is None else share if isinstance(share, str) else f"{100 * share:.0f} %"
    yield f"{row['seconds']:.2f}"
    yield f"{row['megabytes']:.0f}"


if __name__ == "__main__":
    sys.exit(main())
