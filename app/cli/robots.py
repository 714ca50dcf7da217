"""`hexapods robots`: those built in, what is known of one before it walks, and its model."""

import argparse
import json
from pathlib import Path

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import CommandParser, read_gait, read_robot
from app.cli.terminal import show_table
from hexapods.domain.creatures import CREATURES, own_gait
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GAIT_TITLES, NAMED_GAITS, GaitSpec, gait_as_json
from hexapods.domain.grid import FootGrid
from hexapods.domain.records import to_json
from hexapods.domain.robot import PRESETS, as_mapping
from hexapods.runs.config import RACE_STEPS, WalkingProblem
from hexapods.runs.preview import Preview, preview


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "robots", help="list, examine and export robots", description=__doc__
    )
    verbs = parser.add_subparsers(
        dest="verb", required=True, metavar="VERB", parser_class=CommandParser
    )
    listing = verbs.add_parser("list", help="list the robots that are built in")
    listing.add_argument("--json", action="store_true", help="print JSON")
    listing.set_defaults(run=list_robots)
    showing = verbs.add_parser(
        "show", help="tell support, reach, number of states and speed before anything runs"
    )
    showing.add_argument(
        "--gait", help=f"gait: {', '.join(NAMED_GAITS)}, or JSON (default: the robot's own)"
    )
    showing.add_argument("--divisions", type=int, default=FootGrid.divisions)
    showing.add_argument("--grid-side-m", type=float, default=FootGrid.side_m)
    showing.add_argument("--json", action="store_true", help="print JSON")
    showing.set_defaults(run=show_robot)
    exporting = verbs.add_parser(
        "export", help="write a robot as MJCF, which MuJoCo opens without other files"
    )
    exporting.add_argument(
        "--out", required=True, metavar="FILE.xml", help="file to write, ending with .xml"
    )
    exporting.add_argument("--json", action="store_true", help="print JSON")
    exporting.set_defaults(run=export_robot)
    for verb in (showing, exporting):
        verb.add_argument(
            "robot", metavar="NAME", help=f"{', '.join(PRESETS)}, a TOML file, or JSON"
        )


def list_robots(options: argparse.Namespace) -> int:
    """Print the built-in robots, each with a gait that suits it."""
    if options.json:
        robots = [
            {
                "name": name,
                "title": one.title,
                "description": one.description,
                "legs": len(one.robot.legs),
                "gait": gait_as_json(one.gait),
                "robot": as_mapping(one.robot),
            }
            for name, one in CREATURES.items()
        ]
        print(json.dumps(robots))
        return 0
    rows = [
        (name, len(one.robot.legs), gait_text(one.gait), one.description)
        for name, one in CREATURES.items()
    ]
    show_table("Robots", ("name", "legs", "gait", "description"), rows, text=(0, 2, 3))
    return 0


def show_robot(options: argparse.Namespace) -> int:
    """Print what is known of a robot under a gait.

    Raises:
        HexapodError: if robot, gait or grid are not valid.
    """
    made = read_robot(options.robot)
    gait = own_gait(made) if options.gait is None else read_gait(options.gait)
    walk = WalkingProblem(
        gait=gait, robot=made, divisions=options.divisions, grid_side_m=options.grid_side_m
    )
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
    """Write a robot as a model for MuJoCo.

    Raises:
        HexapodError: if the robot is not valid, or the file cannot be written.
    """
    from hexapods.exports.robot_model import robot_mjcf  # noqa: PLC0415 - loads MuJoCo

    # MuJoCo chooses how it reads a file by its ending.
    if Path(options.out).suffix != ".xml":
        raise InvalidInput(f"the name of the file must end with .xml: {options.out}")
    made = read_robot(options.robot)
    check_writable(options.out)
    data = robot_mjcf(made).encode()
    write_whole(options.out, data)
    if options.json:
        print(json.dumps({"robot": made.name, "file": options.out, "bytes": len(data)}))
    else:
        print(
            f"{made.name} is in {options.out} ({size_text(len(data))}); its keyframe `home` has it "
            "standing."
        )
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
    return told
