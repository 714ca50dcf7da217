"""Files of a walk for servos: a table, a ROS 2 `JointTrajectory`, and a header for an Arduino."""

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence

from hexapods.exports.export_format import FileType
from hexapods.exports.servo_walk import FRAME_S, ServoWalk
from hexapods.runs.clocks import CLOCK_SENTENCES
from hexapods.version import __version__

_FRAME_MS = round(1000 * FRAME_S)


def servo_csv(walk: ServoWalk, title: str) -> Iterator[str]:
    """Yield a table: the time [s], and the pulse of each servo [µs], a row for each frame."""
    del title
    yield ",".join(["time_s", *(f"{servo.joint}_us" for servo in walk.map.servos)]) + "\r\n"
    for frame, pulses in enumerate(walk.pulses_us.tolist()):
        yield f"{frame * FRAME_S:.2f}," + ",".join(map(str, pulses)) + "\r\n"


def joint_trajectory(walk: ServoWalk, title: str) -> Iterator[str]:
    """Yield a `trajectory_msgs/JointTrajectory` in JSON: the angles of the joints [rad]."""
    del title  # a message has no other fields than its own
    names = [servo.joint for servo in walk.map.servos]
    yield f'{{"joint_names": {json.dumps(names)},\n"points": [\n'
    for frame, angles in enumerate(walk.angles_rad.round(5).tolist()):
        sec, ms = divmod(frame * _FRAME_MS, 1000)
        point = {
            "positions": angles,
            "time_from_start": {"sec": sec, "nanosec": 1_000_000 * ms},
        }
        yield (",\n" if frame else "") + json.dumps(point)
    yield "\n]}\n"


def arduino_header(walk: ServoWalk, title: str) -> Iterator[str]:
    """Yield a C header with the pulses in flash memory."""
    servos, frames = walk.map.servos, len(walk.pulses_us)
    about = f"{title}, lane {walk.lane} ({walk.agent}), steps {walk.steps[0]} to {walk.steps[1]}"
    slowed = "" if walk.slowed == 1 else f", {walk.slowed:g} times as long as recorded"
    yield f"""\
/*
 * Servo pulses of a walk: {frames} frames of {_FRAME_MS} ms{slowed}.
 * {_comment(about)}. {CLOCK_SENTENCES["free"]}
 * Servo map {_comment(walk.map.name)}. Written by Racing Hexapods {__version__}.
 *
 * WALK_US takes {2 * frames * len(servos)} bytes of flash memory. To walk:
 *
 *   for (uint32_t frame = 0; frame < WALK_FRAMES; frame++) {{
 *     for (uint8_t servo = 0; servo < WALK_SERVOS; servo++)
 *       send(pgm_read_byte(&WALK_BOARD[servo]), pgm_read_byte(&WALK_CHANNEL[servo]),
 *            pgm_read_word(&WALK_US[frame][servo]));
 *     delay(WALK_FRAME_MS);
 *   }}
 *
 * where send(board, channel, us) is yours.
 */
#pragma once

#ifdef ARDUINO
#include <Arduino.h>
#else
#include <stdint.h>
#define PROGMEM
#endif

#define WALK_SERVOS {len(servos)}
#define WALK_FRAMES {frames}
#define WALK_FRAME_MS {_FRAME_MS}

/* Of each servo its board and channel: {_wrapped([servo.joint for servo in servos])}. */
const uint8_t WALK_BOARD[WALK_SERVOS] PROGMEM = {_list([servo.board for servo in servos])};
const uint8_t WALK_CHANNEL[WALK_SERVOS] PROGMEM = {_list([servo.channel for servo in servos])};

/* Of each frame the pulse of each servo, in microseconds. */
const uint16_t WALK_US[WALK_FRAMES][WALK_SERVOS] PROGMEM = {{
"""
    for pulses in walk.pulses_us.tolist():
        yield f"  {_list(pulses)},\n"
    yield "};\n"


def _list(numbers: Sequence[int]) -> str:
    return "{" + ", ".join(map(str, numbers)) + "}"


def _wrapped(names: Sequence[str]) -> str:
    lines = [", ".join(names[first : first + 6]) for first in range(0, len(names), 6)]
    return ",\n   ".join(lines)


def _comment(text: str) -> str:
    """Return text without what could end a comment: a user chose it."""
    return re.sub(r"[^A-Za-z0-9 .,:;()+=-]", "_", text)


SERVO_FILES: Mapping[str, tuple[FileType, Callable[[ServoWalk, str], Iterator[str]]]] = {
    file.ending: (file, write)
    for file, write in (
        (FileType("csv", "Servo pulses (CSV)", "text/csv; charset=utf-8"), servo_csv),
        (FileType("json", "Joint trajectory (ROS 2)", "application/json"), joint_trajectory),
        (FileType("h", "Servo pulses (Arduino)", "text/x-c"), arduino_header),
    )
}
"""Types of file with their functions, which take a walk and the title of its run, by ending."""
