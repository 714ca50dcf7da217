"""Servo maps as YAML files, in the form that `docs/servos.md` describes.

Their content is untrusted: it is limited in size and depth, may not repeat itself by aliases, and
only numbers are read from it, so that tags of Python construct nothing.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import yaml

from hexapods.domain.errors import InvalidInput
from hexapods.domain.plain_yaml import root_node
from hexapods.exports.servo_map import (
    BUILT_IN_MAPS,
    USUAL_LIMITS_US,
    USUAL_SPEED_SHARE,
    Servo,
    ServoMap,
)

MAX_MAP_BYTES = 64 * 1024

_MAX_DIGITS = 100
"""Most digits of a number: YAML reads colons as base 60, in time quadratic in the length."""
_FRAME_US = 20_000.0
"""Servos get a pulse every 20 ms, so none is longer."""
_ZERO_US = (-2 * _FRAME_US, 2 * _FRAME_US)
"""Limits of the pulse at angle 0, which may be an angle that the servo does not reach."""
_OF_ALL = ("limits_us", "speed_deg_s")
"""Fields of a map for all servos, and of a servo for itself."""
_BY_SLOPE = ("us_at_zero", "us_per_rad")
_BY_POINTS = ("us_at_minus_45_deg", "us_at_plus_45_deg")
_OF_SERVO = ("board", "channel", *_BY_SLOPE, *_BY_POINTS, "zero_deg", *_OF_ALL)
_OF_MAP = ("servos", "speed_share", *_OF_ALL)


def load_servo_map(name: str, joints: Sequence[str]) -> ServoMap:
    """Read a built-in map, by its name, or that of a file, by its path.

    Args:
        name: the name or the path.
        joints: labels of the robot's joints, in the order of poses.

    Raises:
        InvalidInput: if there is no such map, or as `read_servo_map` says.
    """
    path = BUILT_IN_MAPS.get(name, Path(name))
    try:
        with path.open("rb") as file:
            content = file.read(MAX_MAP_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InvalidInput(
            f"the servo map {name} cannot be read: {reason}; name a YAML file, or a map that is "
            f"built in: {', '.join(BUILT_IN_MAPS)}"
        ) from error
    return read_servo_map(content, name, joints)


def read_servo_map(content: bytes, name: str, joints: Sequence[str]) -> ServoMap:
    """Read a servo map.

    Args:
        content: the YAML file.
        name: its name, for messages.
        joints: labels of the robot's joints, in the order of poses.

    Raises:
        InvalidInput: naming the line, and what is valid: if it is no YAML, is too large, has an
            unknown or no servo of a joint, two servos on one channel, or a value that is no number
            or out of its range.
    """
    if len(content) > MAX_MAP_BYTES:
        raise InvalidInput(f"{name} is no servo map: it is larger than {MAX_MAP_BYTES // 1024} kB")
    return _Reader(name, joints).map(root_node(content, name, "servo map"))


class _Reader:
    """Reads the nodes of a map for a robot with these joints."""

    def __init__(self, name: str, joints: Sequence[str]) -> None:
        self._name, self._joints = name, joints

    def map(self, root: Any) -> ServoMap:
        """Return the map whose root this is."""
        if root is None:
            self._refuse(None, f"it is empty; a servo map has {', '.join(_OF_MAP)}")
        whole = self._fields(root, "a servo map", _OF_MAP)
        if "servos" not in whole:
            self._refuse(root, "servos is missing: a servo for each joint, by its name")
        share = self._number(whole, "speed_share", (0.01, 1), USUAL_SPEED_SHARE)
        of_all = self._of_all(whole, "", USUAL_LIMITS_US, None)
        servos: dict[str, Servo] = {}
        taken: dict[tuple[int, int], str] = {}
        for joint, node in self._pairs(whole["servos"], "servos").items():
            if joint not in self._joints:
                valid = ", ".join(self._joints)
                self._refuse(
                    node, f"this robot has no joint {_quoted(joint)}; its joints are: {valid}"
                )
            servo = self._servo(joint, node, of_all)
            other = taken.setdefault((servo.board, servo.channel), joint)
            if other != joint:
                self._refuse(
                    node,
                    f"{joint}: channel {servo.channel} of board {servo.board} is that of {other} "
                    "already; each servo has its own",
                )
            servos[joint] = servo
        missing = [joint for joint in self._joints if joint not in servos]
        if missing:
            self._refuse(
                whole["servos"],
                f"no servo is given for {', '.join(missing)}; a map has one for each joint",
            )
        return ServoMap(self._name, tuple(servos[joint] for joint in self._joints), share)

    def _servo(self, joint: str, node: Any, of_all: "_OfAll") -> Servo:
        fields = self._fields(node, joint, _OF_SERVO)
        for name in ("board", "channel"):
            if name not in fields:
                self._refuse(node, f"{joint}: {name} is missing")
        board = self._whole(fields, "board", 127, joint)
        channel = self._whole(fields, "channel", 63, joint)
        us_at_zero, us_per_rad = self._line(joint, node, fields)
        zero_deg = self._number(fields, "zero_deg", (-180, 180), 0.0, joint)
        limits_us, speed_deg_s = self._of_all(fields, joint, *of_all)
        return Servo(
            joint,
            board,
            channel,
            us_at_zero - us_per_rad * math.radians(zero_deg),
            us_per_rad,
            limits_us,
            speed_deg_s,
        )

    def _line(self, joint: str, node: Any, fields: Mapping[str, Any]) -> tuple[float, float]:
        """Return the pulse at angle 0 [µs] and its change by angle [µs/rad]."""
        for names, other_names in ((_BY_SLOPE, _BY_POINTS), (_BY_POINTS, _BY_SLOPE)):
            if all(name in fields for name in names) and not any(
                name in fields for name in other_names
            ):
                break
        else:
            either, other = (" and ".join(names) for names in (_BY_SLOPE, _BY_POINTS))
            self._refuse(node, f"{joint} needs either {either}, or {other}")
        if names == _BY_SLOPE:
            us_at_zero = self._number(fields, "us_at_zero", _ZERO_US, None, joint)
            us_per_rad = self._number(fields, "us_per_rad", (-_FRAME_US, _FRAME_US), None, joint)
        else:
            low, high = (
                self._number(fields, name, (1, _FRAME_US), None, joint) for name in _BY_POINTS
            )
            us_at_zero, us_per_rad = (low + high) / 2, (high - low) / math.radians(90)
        if us_per_rad == 0:
            self._refuse(node, f"{joint}: its pulse must change with the angle, but is constant")
        return us_at_zero, us_per_rad

    def _of_all(
        self,
        fields: Mapping[str, Any],
        joint: str,
        limits_us: tuple[float, float],
        speed_deg_s: float | None,
    ) -> "_OfAll":
        if "limits_us" in fields:
            node = fields["limits_us"]
            what = _named("limits_us", joint)
            if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
                self._refuse(node, f"{what} must be a list of two numbers: [500, 2500]")
            low, high = (self._checked(pulse, what, (1, _FRAME_US)) for pulse in node.value)
            if low >= high:
                self._refuse(node, f"{what} must be the lowest pulse, then the highest")
            limits_us = low, high
        if "speed_deg_s" in fields:
            speed_deg_s = self._number(fields, "speed_deg_s", (1, 10_000), None, joint)
        return limits_us, speed_deg_s

    def _number(
        self,
        fields: Mapping[str, Any],
        name: str,
        limits: tuple[float, float],
        default: float | None,
        joint: str = "",
    ) -> float:
        if name not in fields and default is not None:
            return default
        return self._checked(fields[name], _named(name, joint), limits)

    def _whole(self, fields: Mapping[str, Any], name: str, high: int, joint: str) -> int:
        number = self._checked(fields[name], _named(name, joint), (0, high))
        if number != int(number):
            self._refuse(fields[name], f"{_named(name, joint)} must be a whole number")
        return int(number)

    def _checked(self, node: Any, what: str, limits: tuple[float, float]) -> float:
        """Return a number within its limits, which NaN is not."""
        low, high = limits
        valid = f"{what} must be a number from {low:g} to {high:g}"
        if not isinstance(node, yaml.ScalarNode):
            self._refuse(node, f"{valid}, not a list or mapping")
        if node.tag not in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float"):
            self._refuse(node, f"{valid}, not {_quoted(node.value)}")
        if len(node.value) > _MAX_DIGITS:
            self._refuse(node, f"{valid}, not {_quoted(node.value)}")
        try:
            number = float(yaml.constructor.SafeConstructor().construct_object(node))
        except (ValueError, LookupError, OverflowError):
            number = math.nan  # the tag stands before what is no number, or there are many digits
        if not low <= number <= high:
            self._refuse(node, f"{valid}, not {_quoted(node.value)}")
        return number

    def _fields(self, node: Any, what: str, valid: Sequence[str]) -> dict[str, Any]:
        fields = self._pairs(node, what)
        for name, value in fields.items():
            if name not in valid:
                self._refuse(
                    value, f"{what} has no field {_quoted(name)}; it may have {', '.join(valid)}"
                )
        return fields

    def _pairs(self, node: Any, what: str) -> dict[str, Any]:
        if not isinstance(node, yaml.MappingNode) or node.tag != "tag:yaml.org,2002:map":
            self._refuse(node, f"{what} must be a mapping, of names to values")
        pairs: dict[str, Any] = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._refuse(key, f"{what}: a name is a word, not a list or mapping")
            if key.value in pairs:
                self._refuse(key, f"{what} has {_quoted(key.value)} twice")
            pairs[key.value] = value
        return pairs

    def _refuse(self, node: Any, problem: str) -> NoReturn:
        line = "" if node is None else f", line {node.start_mark.line + 1}"
        raise InvalidInput(f"{self._name}{line}: {problem}")


_OfAll = tuple[tuple[float, float], float | None]
"""Limits of the pulse [µs], and no-load speed [°/s]."""


def _named(name: str, joint: str) -> str:
    return f"{joint}: {name}" if joint else name


def _quoted(text: str) -> str:
    """Return the beginning of a text of the file for a message."""
    return repr(text if len(text) <= 40 else f"{text[:40]}…")
