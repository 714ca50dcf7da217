"""`hexapods runs servos`: a run's walk for the servos of a real robot.

A servo map says where each servo is connected, and its pulse for an angle. What the servos cannot
follow at their speed is told, and how much slower they could.
"""

import argparse
import json
from pathlib import Path

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import CommandParser, integer
from app.cli.stored_runs import add_data, add_run, find_run, open_for_reading
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.exports.servo_files import SERVO_FILES
from hexapods.exports.servo_map import BUILT_IN_MAPS
from hexapods.exports.servo_walk import FRAME_S, ServoSpeed, ServoWalk, servo_walk


def add_to(verbs: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the parser of the verb."""
    parser = verbs.add_parser(
        "servos", help="export pulses for the servos of a real robot", description=__doc__
    )
    add_run(parser)
    parser.add_argument(
        "--map",
        required=True,
        metavar="FILE",
        help=f"servo map: a YAML file, or {' or '.join(BUILT_IN_MAPS)}",
    )
    endings = " or ".join(f".{ending}" for ending in SERVO_FILES)
    parser.add_argument(
        "--out", required=True, metavar="FILE.csv", help=f"file to write, ending with {endings}"
    )
    parser.add_argument(
        "--lane", type=integer, default=0, help="lane of a race, from 0 on (default 0)"
    )
    parser.add_argument(
        "--slow-down", action="store_true", help="scale time so that all servos can follow"
    )
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=write_servos)


def write_servos(given: argparse.Namespace) -> int:
    """Write the file; works beside a running server.

    Raises:
        HexapodError: if the run, the map or the lane is not valid, a servo would get a pulse
            outside of its limits, or the file cannot be written.
    """
    # Imported here, as these modules would slow the start of other commands.
    from app.features.exports.stored_walks import recorded_walks  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415
    from hexapods.exports.servo_map_file import load_servo_map  # noqa: PLC0415

    ending = Path(given.out).suffix.removeprefix(".")
    if ending not in SERVO_FILES:
        valid = " or ".join(f".{one}" for one in SERVO_FILES)
        raise InvalidInput(f"the name of the file must end with {valid}: {given.out}")
    _, write = SERVO_FILES[ending]
    check_writable(given.out)
    with open_for_reading(read_settings(data=given.data)) as store:
        run = store.get(find_run(store, given.run_id).id)
        walks = recorded_walks(run, Recordings(store))
        joints = [joint.label for joint in legs_of(walks.problem.robot).joints]
        servo_map = load_servo_map(given.map, joints)
        walk = servo_walk(walks, servo_map, given.lane, slow_down=given.slow_down)
    data = "".join(write(walk, run.name or f"{run.kind} {run.id}")).encode()
    write_whole(given.out, data)
    if given.json:
        print(json.dumps({"id": run.id, "file": given.out, "bytes": len(data), **_as_json(walk)}))
        return 0
    print(
        f"{run.kind.capitalize()} {run.id}, lane {walk.lane} ({walk.agent}), steps {walk.steps[0]} "
        f"to {walk.steps[1]}: {len(walk.pulses_us)} frames of {1000 * FRAME_S:g} ms, "
        f"{walk.duration_s:.2f} s, are in {given.out} ({size_text(len(data))})."
    )
    print("\n".join(speed_sentences(walk)))
    return 0


def speed_sentences(walk: ServoWalk) -> list[str]:
    """Tell which servos cannot follow, or what was done so that they can."""
    known = [one for one in walk.speeds if one.usable_deg_s is not None]
    if not known:
        return ["The map has no speed_deg_s: whether the servos can follow is not known."]
    told = []
    if len(known) < len(walk.speeds):
        unknown = [one.servo.joint for one in walk.speeds if one.usable_deg_s is None]
        told.append(f"Of {', '.join(unknown)} the map has no speed_deg_s: they are not checked.")
    share = f"{100 * walk.map.speed_share:g} % of the no-load speed"
    hardest = max(known, key=lambda one: one.times_slower)
    if walk.slowed > 1:
        told.append(
            f"Slowed down: it takes {walk.slowed:g} times as long as recorded, so that "
            f"{hardest.servo.joint} can follow, which needed {_need(hardest)}."
        )
    elif walk.too_slow:
        count = len(walk.too_slow)
        servos = "1 servo cannot follow" if count == 1 else f"{count} servos cannot follow"
        told.append(f"{servos} at {share}, which is counted on:")
        told += [f"  {one.servo.title} needs {_need(one)}" for one in walk.too_slow]
        told.append(
            f"All can if it takes {walk.slow_enough:g} times as long: --slow-down does that."
        )
    else:
        told.append(
            f"The servos can follow at {share}; the fastest, {hardest.servo.joint}, needs "
            f"{_need(hardest)}."
        )
    return told


def _need(speed: ServoSpeed) -> str:
    return f"{speed.needed_deg_s:.0f} of {speed.usable_deg_s:.0f} °/s at {speed.at_s:.2f} s"


def _as_json(walk: ServoWalk) -> dict[str, object]:
    return {
        "lane": walk.lane,
        "agent": walk.agent,
        "steps": list(walk.steps),
        "frames": len(walk.pulses_us),
        "duration_s": round(walk.duration_s, 2),
        "slowed": walk.slowed,
        "slow_enough": walk.slow_enough,
        "too_slow": [
            {
                "joint": one.servo.joint,
                "needed_deg_s": round(one.needed_deg_s, 1),
                "usable_deg_s": one.usable_deg_s,
                "at_s": round(one.at_s, 2),
            }
            for one in walk.too_slow
        ],
    }
