"""`hexapods runs servos`: a run's walk for the servos of a real robot."""

import json
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from app.cli.files import check_writable, size_text, write_whole
from app.cli.options import AsJson, Data, RunId, WholeNumber
from app.cli.stored_runs import find_run, open_for_reading
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.exports.servo_files import SERVO_FILES
from hexapods.exports.servo_map import BUILT_IN_MAPS
from hexapods.exports.servo_walk import FRAME_S, ServoSpeed, ServoWalk, servo_walk

_ENDINGS = " or ".join(f".{ending}" for ending in SERVO_FILES)


def add_to(verbs: App) -> None:
    """Add the verb."""
    verbs.command(servos)


def servos(
    run_id: RunId,
    /,
    *,
    servo_map: Annotated[
        str,
        Parameter(
            name="--map",
            metavar="FILE",
            completer=lambda _: [*BUILT_IN_MAPS],
            help=f"servo map: a YAML file, or {' or '.join(BUILT_IN_MAPS)}",
        ),
    ],
    out: Annotated[
        str, Parameter(metavar="FILE.csv", help=f"file to write, ending with {_ENDINGS}")
    ],
    lane: WholeNumber = 0,
    slow_down: bool = False,
    data: Data = None,
    as_json: AsJson = False,
) -> int:
    """Export pulses for the servos of a real robot; works beside a running server.

    A servo map says where each servo is connected, and its pulse for an angle. The command says
    what the servos cannot follow at their speed, and how much slower they could.

    Args:
        lane: lane of a race, from 0 on
        slow_down: scale time so that all servos can follow

    Raises:
        HexapodError: if the run, the map or the lane is not valid, a servo would get a pulse
            outside of its limits, or the file cannot be written.
    """
    # Imported here, as these modules would slow the start of other commands.
    from app.features.exports.stored_walks import recorded_walks  # noqa: PLC0415
    from app.storage.recordings import Recordings  # noqa: PLC0415
    from hexapods.exports.servo_map_file import load_servo_map  # noqa: PLC0415

    ending = Path(out).suffix.removeprefix(".")
    if ending not in SERVO_FILES:
        raise InvalidInput(f"the name of the file must end with {_ENDINGS}: {out}")
    _, write = SERVO_FILES[ending]
    check_writable(out)
    with open_for_reading(read_settings(data=data)) as store:
        run = store.get(find_run(store, run_id).id)
        walks = recorded_walks(run, Recordings(store))
        joints = [joint.label for joint in legs_of(walks.problem.robot).joints]
        pulses_of = load_servo_map(servo_map, joints)
        walk = servo_walk(walks, pulses_of, lane, slow_down=slow_down)
    content = "".join(write(walk, run.name or f"{run.kind} {run.id}")).encode()
    write_whole(out, content)
    if as_json:
        print(json.dumps({"id": run.id, "file": out, "bytes": len(content), **_as_json(walk)}))
        return 0
    print(
        f"{run.kind.capitalize()} {run.id}, lane {walk.lane} ({walk.agent}), steps {walk.steps[0]} "
        f"to {walk.steps[1]}: {len(walk.pulses_us)} frames of {1000 * FRAME_S:g} ms, "
        f"{walk.duration_s:.2f} s, are in {out} ({size_text(len(content))})."
    )
    print("\n".join(speed_sentences(walk)))
    return 0


def speed_sentences(walk: ServoWalk) -> list[str]:
    """Say which servos cannot follow, or what was done so that they can."""
    limited = [speed for speed in walk.speeds if speed.usable_deg_s is not None]
    if not limited:
        return ["The map has no speed_deg_s: whether the servos can follow is not known."]
    sentences = []
    if len(limited) < len(walk.speeds):
        joints = [speed.servo.joint for speed in walk.speeds if speed.usable_deg_s is None]
        sentences.append(
            f"Of {', '.join(joints)} the map has no speed_deg_s: they are not checked."
        )
    share = f"{100 * walk.map.speed_share:g} % of the no-load speed"
    hardest = max(limited, key=lambda speed: speed.times_slower)
    if walk.slowed > 1:
        sentences.append(
            f"Slowed down: it takes {walk.slowed:g} times as long as recorded, so that "
            f"{hardest.servo.joint} can follow, which needed {_need(hardest)}."
        )
    elif walk.too_slow:
        count = len(walk.too_slow)
        subject = "1 servo" if count == 1 else f"{count} servos"
        sentences.append(f"{subject} cannot follow at {share}, which is counted on:")
        sentences += [f"  {speed.servo.title} needs {_need(speed)}" for speed in walk.too_slow]
        sentences.append(
            f"All can if it takes {walk.slow_enough:g} times as long: --slow-down does that."
        )
    else:
        sentences.append(
            f"The servos can follow at {share}; the fastest, {hardest.servo.joint}, needs "
            f"{_need(hardest)}."
        )
    return sentences


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
                "joint": speed.servo.joint,
                "needed_deg_s": round(speed.needed_deg_s, 1),
                "usable_deg_s": speed.usable_deg_s,
                "at_s": round(speed.at_s, 2),
            }
            for speed in walk.too_slow
        ],
    }
