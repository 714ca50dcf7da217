"""`hexapods robots`: those built in and stored, what is known of one, and its model."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import AsJson, Data, Gait, read_gait, read_robot
from app.cli.setting_options import reads
from app.cli.stored_runs import open_for_reading
from app.cli.terminal import show_table
from app.features.robots import storing_commands
from app.settings import read_settings
from hexapods.domain.creatures import CREATURES, Creature, own_gait
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.gait import GAIT_TITLES, NAMED_GAITS, GaitSpec, gait_as_json
from hexapods.domain.gait import read_gait as read_gait_of
from hexapods.domain.records import to_json
from hexapods.domain.robot import PRESETS, Robot, as_mapping
from hexapods.domain.settings import declared_fields
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.preview import Preview, preview

if TYPE_CHECKING:
    from app.storage.stored_robot import StoredRobot


_GRID = declared_fields(WalkingProblem)
_ROBOT_HELP = f"{', '.join(PRESETS)}, a stored one's name or id, a TOML file, or JSON"
RobotName = Annotated[str, Parameter(name="NAME", completer=lambda _: [*PRESETS], help=_ROBOT_HELP)]


def robots() -> App:
    """Return the command with its verbs."""
    app = App(help="List, examine, store and export robots.")
    verbs: dict[str, Callable[..., int]] = {
        "list": list_robots,
        "show": show_robot,
        "export": export_robot,
        **storing_commands.VERBS,
    }
    for name, verb in verbs.items():
        app.command(verb, name=name)
    return app


def list_robots(
    *,
    hidden: bool = False,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """List the robots that are built in, and stored ones, each with a gait that suits it.

    Args:
        hidden: list hidden ones, too
    """
    listed = [*map(_built_in, CREATURES.values())]
    try:
        with open_for_reading(read_settings(data=data)) as store:
            listed += map(_stored, store.robots.readable(hidden=hidden))
    except HexapodError as error:
        print(f"Stored robots cannot be read: {error}", file=sys.stderr)
    if as_json:
        print(json.dumps(listed))
        return 0
    rows = [
        (
            robot["title"] if robot["id"] else robot["name"],
            robot["legs"],
            gait_text(read_gait_of(robot["gait"])),
            robot["description"],
        )
        for robot in listed
    ]
    show_table("Robots", ("name", "legs", "gait", "description"), rows, text=(0, 2, 3))
    return 0


def _built_in(creature: Creature) -> dict[str, Any]:
    return {
        "id": None,
        "name": creature.robot.name,
        "title": creature.title,
        "description": creature.description,
        "hidden": False,
        **_robot(creature.robot, creature.gait),
    }


def _stored(stored: "StoredRobot") -> dict[str, Any]:
    hidden = " It is hidden." if stored.hidden else ""
    robot = stored.robot
    return {
        "id": stored.id,
        "name": stored.name,
        "title": stored.name,
        "description": f"Stored as {stored.id}.{hidden}",
        "hidden": stored.hidden,
        **_robot(robot, own_gait(robot)),
    }


def _robot(robot: Robot, gait: str | GaitSpec) -> dict[str, Any]:
    return {"legs": len(robot.legs), "gait": gait_as_json(gait), "robot": as_mapping(robot)}


def show_robot(
    name: RobotName,
    /,
    *,
    gait: Annotated[
        Gait | None, Parameter(help=f"{', '.join(NAMED_GAITS)}, or JSON (default: its own)")
    ] = None,
    divisions: Annotated[
        int, Parameter(converter=reads(_GRID["divisions"]), help=_GRID["divisions"].about.help)
    ] = WalkingProblem.divisions,
    grid_side_m: Annotated[
        float | None,
        Parameter(
            converter=reads(_GRID["grid_side_m"]),
            help="side of the foot grid (default: one that suits its size)",
        ),
    ] = None,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Show support, reach, number of states and speed of a robot before anything runs.

    Raises:
        HexapodError: if robot, gait or grid are not valid.
    """
    del data  # by it the program has found the folder of stored robots
    robot = read_robot(name)
    spec = own_gait(robot) if gait is None else read_gait(gait)
    side_m = usual_grid_side_m(robot, spec) if grid_side_m is None else grid_side_m
    walk = WalkingProblem(gait=spec, robot=robot, divisions=divisions, grid_side_m=side_m)
    figures = preview(walk)
    if as_json:
        print(json.dumps({"robot": robot.name, "gait": gait_as_json(spec), **to_json(figures)}))
        return 0
    rows = [
        (
            " ".join(map(str, group.legs)),
            _millimetres(group.margin_m),
            "all" if group.back_m is None else _millimetres(group.back_m),
            "all" if group.ahead_m is None else _millimetres(group.ahead_m),
        )
        for group in figures.groups
    ]
    title = f"{robot.name}, {gait_text(spec)}: {len(figures.legs)} legs, {figures.mass_kg:.2f} kg"
    show_table(
        title, ("legs", "support margin, mm", "reach back, mm", "reach ahead, mm"), rows, text=(0,)
    )
    print("\n".join(_sentences(figures)))
    return 0


def export_robot(
    name: RobotName,
    /,
    *,
    out: Annotated[str, Parameter(metavar="FILE")],
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Write a robot as MJCF, as URDF, or as a document.

    `hexapods robots import` reads all of them as the same robot again.

    Args:
        out: file to write: .xml for MJCF, .urdf, .zip for URDF with meshes, or .json

    Raises:
        HexapodError: if the robot is not valid, or the file cannot be written.
    """
    del data  # by it the program has found the folder of stored robots
    from hexapods.exports.robot_files import ROBOT_FILES  # noqa: PLC0415 - slows other commands

    # Other programs choose how they read a file by its ending.
    ending = Path(out).suffix.removeprefix(".")
    if ending not in ROBOT_FILES:
        *endings, last = (f".{name}" for name in ROBOT_FILES)
        valid = f"{', '.join(endings)} or {last}"
        raise InvalidInput(f"the name of the file must end with {valid}: {out}")
    robot = read_robot(name)
    check_writable(out)
    _, write, use = ROBOT_FILES[ending]
    content = write(robot)
    write_whole(out, content)
    if as_json:
        print(json.dumps({"robot": robot.name, "file": out, "bytes": len(content)}))
    else:
        print(f"{robot.name} is in {out} ({size_text(len(content))}); {use}.")
    return 0


def gait_text(gait: str | GaitSpec) -> str:
    """Return a gait in one line: its name, or its groups."""
    if isinstance(gait, str):
        return GAIT_TITLES[gait].lower()
    groups = gait.pairs or gait.groups or gait.symmetry or ()
    return groups if isinstance(groups, str) else " ".join(str(list(group)) for group in groups)


def _millimetres(metres: float) -> str:
    return f"{round(1000 * metres)}"


def _sentences(preview: Preview) -> list[str]:
    fits = "fits into memory" if preview.table_fits else "does not fit into memory"
    sentences = [
        f"A table has {preview.states:,} states with {preview.actions:,} actions each, "
        f"{preview.values:,} values: it {fits}.",
        f"Without slip it advances {1000 * preview.law_m_per_step:.1f} mm a step, "
        f"{preview.law_m:.2f} m in {RACE_STEPS}.",
    ]
    if preview.out_of_reach is not None:
        sentences.append(f"It cannot walk on this grid: {preview.out_of_reach}.")
    if preview.largest_side_m is not None:
        safe = "none" if preview.safe_side_m is None else f"up to {preview.safe_side_m:g} m"
        sentences.append(
            f"It walks on grids of up to {preview.largest_side_m:g} m; every action is always "
            f"possible on {safe}."
        )
    if preview.beside_grid is not None:
        sentences.append(f"It walks beside its grid: {preview.beside_grid}.")
    if not preview.stands:
        sentences.append("It does not stand even on all of its feet.")
    if preview.tips:
        sentences.append(
            f"It tips: the least support margin is {_millimetres(preview.margin_m)} mm."
        )
    if preview.better is not None:
        sentences.append(
            f"With the groups {gait_text(preview.better.gait)} it stands: "
            f"{_millimetres(preview.better.margin_m)} mm, {preview.better.states:,} states."
        )
    elif preview.tips:
        sentences.append("No other groups that were tried let it stand.")
    sentences.append(
        f"Learner to begin with: {preview.recommended_agent}. {preview.recommended_because}"
    )
    return sentences
