"""Robots from user input: presets and stored robots, and validated overrides of them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields, replace
from functools import lru_cache
from typing import Annotated, Any

from hexapods.domain import robot_documents
from hexapods.domain.body import MAX_LEGS, MIN_LEGS, NO_NUMBERS, LegMount, Robot, ring
from hexapods.domain.creatures import PRESETS
from hexapods.domain.errors import DamagedFile, InvalidInput, UnknownName
from hexapods.domain.model_documents import model_content, read_model_content
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.records import JsonForm, Schema
from hexapods.domain.robot_documents import RobotDocument
from hexapods.domain.robot_library import LIBRARY, RobotLibrary
from hexapods.domain.text import MAX_NAME

__all__ = ["MAX_LEGS", "MIN_LEGS", "PRESETS", "LegMount", "Robot", "ring"]

RANGES: dict[str, tuple[float, float]] = {
    "coxa_m": (0.001, 2.0),
    "femur_m": (0.001, 2.0),
    "tibia_m": (0.001, 2.0),
    "foot_radius_m": (0.001, 2.0),
    "torso_radius_m": (0.01, 2.0),
    "torso_half_height_m": (0.002, 1.0),
    "torso_length_m": (0.02, 4.0),
    "torso_width_m": (0.02, 4.0),
    "home_radius_m": (0.01, 5.0),
    "body_height_m": (0.01, 3.0),
    "step_height_m": (0.001, 1.0),
    "servo_kp": (0.1, 1000.0),
    "servo_kv": (0.001, 100.0),
    "servo_torque_nm": (0.01, 100.0),
    "friction": (0.01, 5.0),
    "torso_kg": (0.01, 100.0),
    "coxa_kg": (0.001, 10.0),
    "femur_kg": (0.001, 10.0),
    "tibia_kg": (0.001, 10.0),
    "foot_kg": (0.001, 10.0),
    "joint_armature": (0.0001, 1.0),
    "joint_damping": (0.0001, 10.0),
    "swing_s": (0.02, 5.0),
    "shift_s": (0.02, 5.0),
    "dt_s": (0.0005, 0.005),
}
MOUNT_RADIUS, AZIMUTH = (0.0, 2.0), (-360.0, 360.0)
_LEG_OVERRIDES = (
    "coxa_m",
    "femur_m",
    "tibia_m",
    "coxa_kg",
    "femur_kg",
    "tibia_kg",
    "foot_kg",
    "servo_kp",
    "servo_kv",
    "servo_torque_nm",
)
"""Fields of a robot that a leg may override."""
_LINKS = tuple(name for name in _LEG_OVERRIDES if not name.startswith("servo_"))
LEG_RANGES: dict[str, tuple[float, float]] = {
    "azimuth_deg": AZIMUTH,
    "radius_m": MOUNT_RADIUS,
    "z_m": (-1.0, 1.0),
    "yaw_deg": AZIMUTH,
    "foot_out_m": (0.001, 5.0),
    **{name: RANGES[name] for name in _LEG_OVERRIDES},
}
_BOX = {"torso_length_m", "torso_width_m"}
"""Fields that a robot with a round torso does not have."""
_MODIFIED = " (modified)"
_PLACE = ("x_m", "y_m")
"""Fields of a leg in a request that may stand for its azimuth and radius."""
_COORDINATE = (-MOUNT_RADIUS[1], MOUNT_RADIUS[1])
PLACED_RANGES = dict.fromkeys(_PLACE, _COORDINATE) | LEG_RANGES
"""Limits of a leg's fields in a request: its place in either form, and its overrides."""


def robot(value: str | Mapping[str, Any] | Robot, library: RobotLibrary = LIBRARY) -> Robot:
    """Build a robot from user input: a preset's name, a stored robot's id, or overrides of either.

    A mapping may have `preset` (default `stiff`), or the `id` of a stored robot and its `name`,
    which is ignored where the robot has one; any number of `Robot`'s fields; and its legs either
    as `n_legs` (a regular ring, with `mount_radius_m`) or as `legs`, a list of mappings with the
    fields of `LegMount`; `x_m` and `y_m` may stand for azimuth and radius.

    Args:
        value: the input.
        library: where a robot is found by its id.

    Raises:
        UnknownName: for an unknown preset or field.
        InvalidInput: for a value out of range, or if the library has no robot of this id.
    """
    if isinstance(value, Robot):
        return value
    if not isinstance(value, Mapping):
        is_id = robot_documents.is_id(value)
        return _by_id(str(value), None, library) if is_id else _preset(value)
    values = dict(value)
    if "id" in values:
        return _changed(_stored(values, library), values)
    return _changed(_preset(values.pop("preset", "stiff")), values)


def _changed(base: Robot, values: dict[str, Any]) -> Robot:
    """Return a robot with the fields of an input in place of its own."""
    for name in ("n_legs", "mount_radius_m", "legs"):
        if name in values and values[name] is None:
            raise InvalidInput(f"robot.{name} must not be null; leave it out for the preset's")
    if isinstance(base, ModelRobot):
        return changed_model(base, values)
    legs = _legs(values, base)
    numbers = {f.name for f in fields(Robot)}.difference(NO_NUMBERS)
    for name, number in values.items():
        if name not in numbers:
            valid = ["preset", "id", "n_legs", "mount_radius_m", "legs", *sorted(numbers)]
            raise UnknownName("robot field", name, valid)
        values[name] = _number(name, number)
    changed = replace(base, legs=legs, **values)
    return changed if changed == base else replace(changed, name=f"{base.name}{_MODIFIED}")


def changed_model(base: ModelRobot, values: Mapping[str, Any]) -> ModelRobot:
    """Return a robot from a file with other servos, friction or times.

    Raises:
        UnknownName: for a field that its file fixes, such as a length or a mass.
        InvalidInput: for a value out of range.
    """
    changes: dict[str, Any] = {}
    for name, value in values.items():
        if name not in base.changeable:
            raise UnknownName("field that can differ from a robot's file", name, base.changeable)
        # Servos of large robots are far stronger than those of a hexapod.
        present = getattr(base, name)
        limits = (present / 100, present * 100) if name.startswith("servo_") else RANGES[name]
        changes[name] = _limited(name, value, limits)
    changed = replace(base, **changes)
    return changed if changed == base else replace(changed, name=f"{base.name}{_MODIFIED}")


def as_mapping(value: Robot) -> dict[str, Any]:
    """Return a robot as its preset or id and overrides, fit for JSON; the inverse of `robot`.

    A robot without an id whose name is no preset's, as `Robot(name="x")`, is written as overrides
    of `stiff`, without its name.

    Raises:
        InvalidInput: for a robot from a file without a document.
    """
    name = value.name.removesuffix(_MODIFIED)
    if value.document is not None:
        stored = parse_document(value.document.data)
        return {"id": value.id, "name": name, **_differing(value, stored)}
    if isinstance(value, ModelRobot):
        raise InvalidInput(
            f"the robot {value.name} is of no document, by which it could be found again: take "
            "hexapods.load_robot"
        )
    base = PRESETS.get(name, PRESETS["stiff"])
    if None in _differing(value, base).values():  # no override says that there is no box
        base = PRESETS["stiff"]
    return {"preset": base.name, **_differing(value, base)}


def _differing(value: Robot, from_base: Robot) -> dict[str, Any]:
    differs = {
        field.name: getattr(value, field.name)
        for field in fields(value)
        if field.compare and getattr(value, field.name) != getattr(from_base, field.name)
    }
    if "legs" in differs:
        differs["legs"] = [_leg_as_mapping(leg) for leg in value.legs]
    return differs


def by_value(value: Robot) -> dict[str, Any] | None:
    """Return a body as overrides of a preset, fit for JSON; None for a robot from a file."""
    if isinstance(value, ModelRobot):
        return None
    base = PRESETS["stiff"]
    return {"preset": base.name, **_differing(value, base)}


def document_of(value: Robot) -> bytes:
    """Return a robot by value as a document, which depends on no preset and no name."""
    if isinstance(value, ModelRobot):
        return robot_documents.encode(model_content(value))
    numbers = {
        name: number + 0.0 for name, number in written_out(value).items() if number is not None
    }
    legs = [
        {name: number + 0.0 for name, number in _leg_as_mapping(leg).items()} for leg in value.legs
    ]
    return robot_documents.encode({"robot": {**numbers, "legs": legs}})


def read_document(data: bytes, name: str | None = None, library: RobotLibrary = LIBRARY) -> Robot:
    """Return the robot of a document, and add the document to a library.

    Raises:
        DamagedFile: if the bytes are not a document.
        InvalidInput: if its robot is not valid.
    """
    parsed = parse_document(data)
    library.add(data)
    return _named(parsed, name, library)


@lru_cache(maxsize=32)
def parse_document(data: bytes) -> Robot:
    """Return the robot of a document, without its name and gait; errors as of `read_document`."""
    content = robot_documents.decode(data)
    if "model" in content:
        parsed: Robot = read_model_content(content)
        return replace(parsed, id=robot_documents.id_of(data), document=RobotDocument(data))
    values = content.pop("robot", None)
    # It must be complete, so that no other document holds the same robot.
    if content or not isinstance(values, dict) or {*values} | _BOX != {*RANGES, "legs"}:
        raise DamagedFile("the document of a robot is damaged: it must have its legs and numbers")
    parsed = _changed(Robot(), values)
    return replace(parsed, id=robot_documents.id_of(data), document=RobotDocument(data))


def _stored(values: dict[str, Any], library: RobotLibrary) -> Robot:
    """Pop `id` and `name` from an input, and return the stored robot."""
    robot_id, name = values.pop("id"), values.pop("name", None)
    if name is not None and not (isinstance(name, str) and len(name) <= MAX_NAME):
        raise InvalidInput(f"robot.name must be a text of at most {MAX_NAME} characters")
    if "preset" in values:
        raise InvalidInput("robot: give the id of a stored robot, or a preset, not both")
    if not robot_documents.is_id(robot_id):
        raise InvalidInput(
            f"robot.id must have {robot_documents.ID_DIGITS} hexadecimal digits, not {robot_id!r}"
        )
    return _by_id(robot_id, name, library)


def _by_id(robot_id: str, name: str | None, library: RobotLibrary) -> Robot:
    return _named(parse_document(library.find(robot_id, name)), name, library)


def _named(parsed: Robot, name: str | None, library: RobotLibrary) -> Robot:
    """Return the robot of a document with the name and the gait that are stored beside it.

    Args:
        parsed: the robot.
        name: its name where none is stored.
        library: has what is stored beside it.
    """
    robot_id, document = str(parsed.id), parsed.document
    about = library.about(robot_id)
    if about is None or document is None:
        return replace(parsed, name=name or f"robot {robot_id[:6]}")
    return replace(parsed, name=about.name, document=document._replace(gait=about.gait))


def _leg_as_mapping(leg: LegMount) -> dict[str, float]:
    """Return a leg's place, and what differs from the robot's other legs."""
    place = {"azimuth_deg": leg.azimuth_deg, "radius_m": leg.radius_m}
    usual = {field.name: field.default for field in fields(LegMount)}
    return place | {k: v for k, v in asdict(leg).items() if k not in place and v != usual[k]}


def written_out(value: Robot) -> dict[str, float | None]:
    """Return every number of a robot but those of single legs; of a round torso the box is None.

    Lengths and masses of links are left out for a robot from a file: each link has its own.
    """
    left_out = {"home_radius_m", *_LINKS} if isinstance(value, ModelRobot) else set()
    return {name: getattr(value, name) for name in RANGES if name not in left_out}


def legs_written_out(value: Robot) -> list[dict[str, float]]:
    """Return every number of each leg, as in a request, with those that all legs share."""
    is_from_file = isinstance(value, ModelRobot)
    columns = {} if is_from_file else {name: value.of_legs(name) for name in _LEG_OVERRIDES}
    return [
        {
            "x_m": leg.radius_m * math.cos(math.radians(leg.azimuth_deg)),
            "y_m": leg.radius_m * math.sin(math.radians(leg.azimuth_deg)),
            "z_m": leg.z_m,
            "yaw_deg": leg.direction_deg,
            "foot_out_m": out_m,
            **{name: values[number] for name, values in columns.items()},
        }
        for number, (leg, out_m) in enumerate(zip(value.legs, value.feet_out_m, strict=True))
    ]


def _preset(name: object) -> Robot:
    if not isinstance(name, str) or name not in PRESETS:
        raise UnknownName("robot", name, PRESETS)
    return PRESETS[name]


def _legs(values: dict[str, Any], base: Robot) -> tuple[LegMount, ...]:
    """Pop `n_legs`, `mount_radius_m` and `legs` from the input and return the mounts."""
    count, radius = values.pop("n_legs", None), values.pop("mount_radius_m", None)
    mounts = values.pop("legs", None)
    if mounts is not None:
        if count is not None or radius is not None:
            raise InvalidInput("robot: give legs one by one, or n_legs and mount_radius_m")
        return _mounts(mounts)
    if count is None and radius is None:
        return base.legs
    if count is None:
        count = len(base.legs)
    if isinstance(count, float) and count.is_integer():
        count = int(count)
    if not isinstance(count, int) or isinstance(count, bool):
        raise InvalidInput(f"robot.n_legs must be a whole number, not {count!r}")
    return ring(count, 0.10 if radius is None else _number("mount_radius_m", radius))


def _mounts(mounts: object) -> tuple[LegMount, ...]:
    shape = "robot.legs must be a list of {azimuth_deg, radius_m} or {x_m, y_m}"
    if not isinstance(mounts, Sequence) or isinstance(mounts, str):
        raise InvalidInput(shape)
    read = []
    for number, mount in enumerate(mounts, start=1):
        if not isinstance(mount, Mapping) or set(mount) - {*PLACED_RANGES}:
            optional = ", ".join(
                name for name in LEG_RANGES if name not in ("azimuth_deg", "radius_m")
            )
            raise InvalidInput(f"{shape}, each of which may have {optional}")
        read.append(_mount(number, mount))
    return tuple(read)


def _mount(number: int, mount: Mapping[str, Any]) -> LegMount:
    """Read a leg; its number is for messages."""
    values = dict(mount)
    if any(name in values for name in _PLACE):
        if "azimuth_deg" in values or "radius_m" in values:
            raise InvalidInput(
                f"robot.legs: leg {number} has azimuth_deg and radius_m, or x_m and y_m, not both"
            )
        x, y = (_limited(f"legs.{name}", values.pop(name, None), _COORDINATE) for name in _PLACE)
        values |= {"azimuth_deg": math.degrees(math.atan2(y, x)), "radius_m": math.hypot(x, y)}
    values.setdefault("azimuth_deg", None)
    return LegMount(
        **{
            name: _limited(f"legs.{name}", value, LEG_RANGES[name])
            for name, value in values.items()
        }
    )


def _number(name: str, value: object) -> float:
    return _limited(name, value, RANGES.get(name, MOUNT_RADIUS))


def _limited(name: str, value: object, limits: tuple[float, float]) -> float:
    """Return a number of the input.

    Raises:
        InvalidInput: if it is not a number, or out of its limits.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidInput(f"robot.{name} must be a number, not {value!r}")
    low, high = limits
    if not low <= value <= high:
        raise InvalidInput(f"robot.{name} must be from {low:g} to {high:g}, not {value}")
    return float(value)


def _numbers(ranges: Mapping[str, tuple[float, float]]) -> Schema:
    return {
        name: {"type": "number", "minimum": low, "maximum": high}
        for name, (low, high) in ranges.items()
    }


_PRESET: Schema = {"type": "string", "enum": list(PRESETS)}
_LEG: Schema = {
    "type": "object",
    "properties": _numbers(LEG_RANGES),
    "additionalProperties": False,
}
LEG_SCHEMA: Schema = {
    "type": "object",
    "properties": _numbers(PLACED_RANGES),
    "additionalProperties": False,
    "oneOf": [{"required": ["azimuth_deg"]}, {"required": list(_PLACE)}],
    "not": {
        "anyOf": [
            {"required": [place, polar]}
            for place in _PLACE
            for polar in ("azimuth_deg", "radius_m")
        ]
    },
}
_COUNTED: Schema = {
    "n_legs": {"type": "integer", "minimum": MIN_LEGS, "maximum": MAX_LEGS},
    **_numbers({"mount_radius_m": MOUNT_RADIUS}),
}
ROBOT_SCHEMA: Schema = {
    "type": "object",
    "properties": {
        "preset": _PRESET,
        "legs": {
            "type": "array",
            "minItems": MIN_LEGS,
            "maxItems": MAX_LEGS,
            "items": LEG_SCHEMA,
        },
        **_COUNTED,
        **_numbers(RANGES),
    },
    "additionalProperties": False,
    "not": {"required": ["legs"], "anyOf": [{"required": [name]} for name in _COUNTED]},
}
_ID: Schema = {"type": "string", "pattern": f"^[0-9a-f]{{{robot_documents.ID_DIGITS}}}$"}
_NAME: Schema = {"type": "string", "maxLength": MAX_NAME}
STORED_ROBOT_SCHEMA: Schema = {
    **ROBOT_SCHEMA,
    "properties": {
        "id": _ID,
        "name": _NAME,
        **{name: shape for name, shape in ROBOT_SCHEMA["properties"].items() if name != "preset"},
    },
    "required": ["id"],
}
_OUTPUT: Schema = {
    "type": "object",
    "description": "A preset, or the id and the name of a stored robot, and by name the parts that "
    "differ from it.",
    "properties": {
        "preset": _PRESET,
        "id": _ID,
        "name": _NAME,
        "legs": {"type": "array", "items": {**_LEG, "required": ["azimuth_deg", "radius_m"]}},
    },
    "additionalProperties": {"type": "number"},
}


def _read(value: Any, library: RobotLibrary | None) -> Robot:
    return robot(value, LIBRARY if library is None else library)


def _write(value: Robot, library: RobotLibrary | None) -> dict[str, Any]:
    if library is not None and value.document is not None:
        library.add(value.document.data)
    return as_mapping(value)


AnyRobot = Annotated[
    Robot,
    JsonForm(
        _read,
        _write,
        {"anyOf": [_PRESET, _ID, ROBOT_SCHEMA, STORED_ROBOT_SCHEMA]},
        _OUTPUT,
        takes_context=True,
    ),
]
"""A robot: in requests a preset's name or a stored robot's id, too.

The context of `from_json` may be the library in which it is found by its id, and that of `to_json`
a library, to which its document is added.
"""
