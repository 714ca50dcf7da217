"""`hexapods robots`: those built in and stored, what is known of one, and its model."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import CommandParser, read_gait, read_robot
from app.cli.stored_runs import add_data, open_for_reading
from app.cli.terminal import show_table
from app.features.robots import storing_commands
from app.settings import read_settings
from hexapods.domain.creatures import CREATURES, Creature, own_gait
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.gait import GAIT_TITLES, NAMED_GAITS, GaitSpec, gait_as_json
from hexapods.domain.gait import read_gait as read_gait_of
from hexapods.domain.grid import FootGrid
from hexapods.domain.records import to_json
from hexapods.domain.robot import PRESETS, Robot, as_mapping, document_of
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.preview import Preview, preview

if TYPE_CHECKING:
    from app.storage.stored_robot import StoredRobot


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "robots", help="list, examine and export robots", description=__doc__
    )
    verbs = parser.add_subparsers(
        dest="verb", required=True, metavar="VERB", parser_class=CommandParser
    )
    listing = verbs.add_parser("list", help="list the robots that are built in, and stored ones")
    listing.add_argument("--hidden", action="store_true", help="list hidden ones, too")
    add_data(listing)
    listing.add_argument("--json", action="store_true", help="print JSON")
    listing.set_defaults(run=list_robots)
    showing = verbs.add_parser(
        "show", help="tell support, reach, number of states and speed before anything runs"
    )
    showing.add_argument(
        "--gait", help=f"gait: {', '.join(NAMED_GAITS)}, or JSON (default: the robot's own)"
    )
    showing.add_argument("--divisions", type=int, default=FootGrid.divisions)
    showing.add_argument(
        "--grid-side-m", type=float, help="side of the foot grid (default: one that suits its size)"
    )
    showing.add_argument("--json", action="store_true", help="print JSON")
    showing.set_defaults(run=show_robot)
    exporting = verbs.add_parser(
        "export",
        help="write a robot as MJCF, which MuJoCo opens without other files, or as the document "
        "that `hexapods robots import` stores elsewhere",
    )
    exporting.add_argument(
        "--out", required=True, metavar="FILE", help="file to write: .xml for MJCF, or .json"
    )
    exporting.add_argument("--json", action="store_true", help="print JSON")
    exporting.set_defaults(run=export_robot)
    for verb in (showing, exporting):
        add_data(verb)
        verb.add_argument(
            "robot",
            metavar="NAME",
            help=f"{', '.join(PRESETS)}, a stored one's name or id, a TOML file, or JSON",
        )
    storing_commands.add_to(verbs)


def list_robots(options: argparse.Namespace) -> int:
    """Print the robots, each with a gait that suits it."""
    robots = [*map(_built_in, CREATURES.values())]
    try:
        with open_for_reading(read_settings(data=options.data)) as store:
            robots += map(_stored, store.robots.readable(hidden=options.hidden))
    except HexapodError as error:
        print(f"Stored robots cannot be read: {error}", file=sys.stderr)
    if options.json:
        print(json.dumps(robots))
        return 0
    rows = [
        (
            one["title"] if one["id"] else one["name"],
            one["legs"],
            gait_text(read_gait_of(one["gait"])),
            one["description"],
        )
        for one in robots
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
    made = stored.robot
    return {
        "id": stored.id,
        "name": stored.name,
        "title": stored.name,
        "description": f"Stored as {stored.id}.{hidden}",
        "hidden": stored.hidden,
        **_robot(made, own_gait(made)),
    }


def _robot(made: Robot, gait: str | GaitSpec) -> dict[str, Any]:
    return {"legs": len(made.legs), "gait": gait_as_json(gait), "robot": as_mapping(made)}


def show_robot(options: argparse.Namespace) -> int:
    """Print what is known of a robot under a gait.

    Raises:
        HexapodError: if robot, gait or grid are not valid.
    """
    made = read_robot(options.robot)
    gait = own_gait(made) if options.gait is None else read_gait(options.gait)
    side_m = usual_grid_side_m(made, gait) if options.grid_side_m is None else options.grid_side_m
    walk = WalkingProblem(gait=gait, robot=made, divisions=options.divisions, grid_side_m=side_m)
    known = preview(walk)
    if options.json:
        print(json.dumps({"robot": made.name, "gait": gait_as_json(gait), **to_json(known)}))
        return 0
    rows = [
        (
            " ".join(map(str, group.legs)),
            _millimetres(group.margin_m),
            "all" if group.back_m is None else _millimetres(group.back_m),
            "all" if group.ahead_m is None else _millimetres(group.ahead_m),
        )
        for group in known.groups
    ]
    title = f"{made.name}, {gait_text(gait)}: {len(known.legs)} legs, {known.mass_kg:.2f} kg"
    show_table(
        title, ("legs", "support margin, mm", "reach back, mm", "reach ahead, mm"), rows, text=(0,)
    )
    print("\n".join(_sentences(known)))
    return 0


def export_robot(options: argparse.Namespace) -> int:
    """Write a robot as a model for MuJoCo, or as a document.

    Raises:
        HexapodError: if the robot is not valid, or the file cannot be written.
    """
    # MuJoCo chooses how it reads a file by its ending.
    ending = Path(options.out).suffix
    if ending not in (".xml", ".json"):
        raise InvalidInput(f"the name of the file must end with .xml or .json: {options.out}")
    made = read_robot(options.robot)
    check_writable(options.out)
    if ending == ".json":
        data, told = document_of(made), "`hexapods robots import` stores it elsewhere"
    else:
        from hexapods.exports.robot_model import robot_mjcf  # noqa: PLC0415 - loads MuJoCo

        data, told = robot_mjcf(made).encode(), "its keyframe `home` has it standing"
    write_whole(options.out, data)
    if options.json:
        print(json.dumps({"robot": made.name, "file": options.out, "bytes": len(data)}))
    else:
        print(f"{made.name} is in {options.out} ({size_text(len(data))}); {told}.")
    return 0


def gait_text(gait: str | GaitSpec) -> str:
    """Return a gait in one line: its name, or its groups."""
    if isinstance(gait, str):
        return GAIT_TITLES[gait].lower()
    groups = gait.pairs or gait.groups or gait.symmetry or ()
    return groups if isinstance(groups, str) else " ".join(str(list(group)) for group in groups)


def _millimetres(metres: float) -> str:
    return f"{round(1000 * metres)}"


def _sentences(known: Preview) -> list[str]:
    fits = "fits into memory" if known.table_fits else "does not fit into memory"
    told = [
        f"A table has {known.states:,} states with {known.actions:,} actions each, "
        f"{known.values:,} values: it {fits}.",
        f"Without slip it advances {1000 * known.law_m_per_step:.1f} mm a step, "
        f"{known.law_m:.2f} m in {RACE_STEPS}.",
    ]
    if known.out_of_reach is not None:
        told.append(f"It cannot walk on this grid: {known.out_of_reach}.")
    if known.largest_side_m is not None:
        safe = "none" if known.safe_side_m is None else f"up to {known.safe_side_m:g} m"
        told.append(
            f"It walks on grids of up to {known.largest_side_m:g} m; every action is always "
            f"possible on {safe}."
        )
    if known.beside_grid is not None:
        told.append(f"It walks beside its grid: {known.beside_grid}.")
    if not known.stands:
        told.append("It does not stand even on all of its feet.")
    if known.tips:
        told.append(f"It tips: the least support margin is {_millimetres(known.margin_m)} mm.")
    if known.better is not None:
        told.append(
            f"With the groups {gait_text(known.better.gait)} it stands: "
            f"{_millimetres(known.better.margin_m)} mm, {known.better.states:,} states."
        )
    elif known.tips:
        told.append("No other groups that were tried let it stand.")
    told.append(f"Learner to begin with: {known.recommended_agent}. {known.recommended_because}")
    return told
