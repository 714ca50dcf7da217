"""Imports robots' files: `python benchmarks/robot_files.py FILE_OR_FOLDER[:DOCUMENT] …`.

A folder is packed into a zip, as a person would do it; after a colon follows the document in it, if
there are several. Prints a line for each, with what was guessed and repaired below it, and ends
with 1 if one is refused. With `--walk` each also walks in MuJoCo, on the grid that suits its size:
50 steps by greedy and 100 by `linear-model`, which begins untrained. With `--in-this-process` a
profiler sees the import.
"""

import argparse
import io
import sys
import time
import zipfile
from pathlib import Path

import hexapods as hx
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import resolve
from hexapods.domain.model_robot import model_robot
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.imports.child import inspect_robot_file
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import silence_mujoco
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.reading import read_in_this_process

_STEPS = 50


def main() -> int:
    """Import all that is named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", metavar="FILE_OR_FOLDER[:DOCUMENT]")
    parser.add_argument("--walk", action="store_true")
    parser.add_argument("--in-this-process", action="store_true")
    options = parser.parse_args()
    refused = 0
    for named in options.files:
        path, _, document = named.partition(":")
        data = _content(Path(path))
        choices = Choices(file=document or None)
        read = read_in_this_process if options.in_this_process else inspect_robot_file
        if options.in_this_process:
            silence_mujoco()
        began_s = time.perf_counter()
        try:
            robot = read(data, Path(path).name, choices).valid_robot()
        except InvalidInput as error:
            refused += 1
            print(f"{named}: refused: {error}")
            continue
        _print(named, robot, len(data), time.perf_counter() - began_s)
        if options.walk:
            _walk(robot)
    return min(refused, 1)


def _content(path: Path) -> bytes:
    """Return a file, or a folder as a zip."""
    if path.is_file():
        return path.read_bytes()
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(path.rglob("*")):
            if file.is_file():
                archive.write(file, file.relative_to(path))
    return buffer.getvalue()


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
    robot = model_robot(imported.model, imported.name)
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


if __name__ == "__main__":
    sys.exit(main())
