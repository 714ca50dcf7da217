"""Robots: morphology, servos and step timing, with named presets and validated overrides."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Annotated, Any

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import JsonForm, Schema

MIN_LEGS, MAX_LEGS = 3, 12
_NO_NUMBERS = ("name", "legs")
"""Fields of a robot that are not a number."""


@dataclass(frozen=True)
class LegMount:
    """Position of a leg's coxa joint on the torso, in polar coordinates of the body frame."""

    azimuth_deg: float
    """Anticlockwise from body x, seen from above."""
    radius_m: float = 0.10


def ring(legs: int, radius_m: float = 0.10) -> tuple[LegMount, ...]:
    """Return the mounts of a regular ring, leg 1 along body x, numbered anticlockwise.

    Raises:
        InvalidInput: if the number of legs is out of range.
    """
    _check_count(legs)
    return tuple(LegMount(360 * i / legs, radius_m) for i in range(legs))


def _check_count(legs: int) -> None:
    if not MIN_LEGS <= legs <= MAX_LEGS:
        raise InvalidInput(f"a robot has {MIN_LEGS} to {MAX_LEGS} legs, not {legs}")


@dataclass(frozen=True)
class Robot:
    """Parameters of a robot. Lengths in m, masses in kg, times in s.

    The defaults are the `stiff` hexapod. All legs have the same dimensions.

    Raises:
        InvalidInput: if a value is out of range.
    """

    name: str = "stiff"
    """Name of the preset; with the suffix `(modified)` if fields differ from it."""
    legs: tuple[LegMount, ...] = ring(6)
    torso_radius_m: float = 0.10
    torso_half_height_m: float = 0.02
    coxa_m: float = 0.05
    femur_m: float = 0.08
    tibia_m: float = 0.13
    foot_radius_m: float = 0.012
    torso_kg: float = 1.2
    coxa_kg: float = 0.06
    femur_kg: float = 0.06
    tibia_kg: float = 0.03
    foot_kg: float = 0.01
    home_radius_m: float = 0.25
    """Horizontal distance of a foot at home from the torso's centre."""
    body_height_m: float = 0.09
    """Height of the torso's centre above the centres of the feet."""
    step_height_m: float = 0.03
    """Height of a foot at the middle of its swing."""
    swing_s: float = 0.2
    shift_s: float = 0.12
    servo_kp: float = 40.0
    """Position gain [N·m/rad]."""
    servo_kv: float = 1.0
    """Velocity gain [N·m·s/rad]."""
    servo_torque_nm: float = 1.5
    joint_armature: float = 0.002
    """Rotor inertia reflected to the joint [kg·m²]."""
    joint_damping: float = 0.05
    """[N·m·s/rad]."""
    friction: float = 1.0
    """Sliding friction between feet and ground."""
    dt_s: float = 0.004
    """Time step of the physics; with 0.008 s results begin to drift."""

    def __post_init__(self) -> None:
        numbers = {name: value for name, value in vars(self).items() if name not in _NO_NUMBERS}
        for name, value in numbers.items():
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise InvalidInput(f"robot.{name} must be a number, not {value!r}")
            if not (math.isfinite(value) and value > 0):
                raise InvalidInput(f"robot.{name} must be positive and finite, not {value}")
        legs: Any = self.legs  # as a user gave them
        if not isinstance(legs, tuple) or not all(isinstance(leg, LegMount) for leg in legs):
            raise InvalidInput(f"robot.legs must be a tuple of LegMount, not {legs!r}")
        _check_count(len(self.legs))
        if self.dt_s > 0.005:
            raise InvalidInput(f"robot.dt_s must be at most 0.005 s, not {self.dt_s}")
        for name in ("swing_s", "shift_s"):
            if not 2 * self.dt_s <= getattr(self, name) <= 5:
                raise InvalidInput(f"robot.{name} must be from two substeps to 5 s")

    @property
    def azimuths_deg(self) -> tuple[float, ...]:
        """Each leg's azimuth in the body frame, anticlockwise from body x."""
        return tuple(leg.azimuth_deg for leg in self.legs)

    @property
    def swing_substeps(self) -> int:
        """Physics substeps of the swing phase."""
        return max(1, round(self.swing_s / self.dt_s))

    @property
    def shift_substeps(self) -> int:
        """Physics substeps of the shift phase."""
        return max(1, round(self.shift_s / self.dt_s))

    @property
    def step_s(self) -> float:
        """Duration of one step's motion [s]."""
        return (self.swing_substeps + self.shift_substeps) * self.dt_s


PRESETS: dict[str, Robot] = {
    "stiff": Robot(),
    "compliant": Robot(name="compliant", servo_kp=10.0, servo_kv=0.5),
    "slippery": Robot(name="slippery", friction=0.1),
}

RANGES: dict[str, tuple[float, float]] = {
    "coxa_m": (0.001, 2.0),
    "femur_m": (0.001, 2.0),
    "tibia_m": (0.001, 2.0),
    "foot_radius_m": (0.001, 2.0),
    "torso_radius_m": (0.01, 2.0),
    "torso_half_height_m": (0.002, 1.0),
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


def robot(value: str | Mapping[str, Any] | Robot) -> Robot:
    """Build a robot from user input: a preset's name, or overrides of a preset.

    A mapping may have `preset` (default `stiff`), any number of `Robot`'s fields, and its legs
    either as `n_legs` (a regular ring, with `mount_radius_m`) or as `legs`, a list of
    `{azimuth_deg, radius_m}`.

    Raises:
        UnknownName: for an unknown preset or field.
        InvalidInput: for a value out of range.
    """
    if isinstance(value, Robot):
        return value
    if not isinstance(value, Mapping):
        return _preset(value)
    given = dict(value)
    for name in ("n_legs", "mount_radius_m", "legs"):
        if name in given and given[name] is None:
            raise InvalidInput(f"robot.{name} must not be null; leave it out for the preset's")
    base = _preset(given.pop("preset", "stiff"))
    legs = _legs(given, base)
    numbers = {f.name for f in fields(Robot)}.difference(_NO_NUMBERS)
    for name, number in given.items():
        if name not in numbers:
            valid = ["preset", "n_legs", "mount_radius_m", "legs", *sorted(numbers)]
            raise UnknownName("robot field", name, valid)
        given[name] = _number(name, number)
    changed = replace(base, legs=legs, **given)
    return changed if changed == base else replace(changed, name=f"{base.name} (modified)")


def as_mapping(value: Robot) -> dict[str, Any]:
    """Return a robot as its preset and overrides, fit for JSON; the inverse of `robot`."""
    if PRESETS.get(value.name) == value:
        return {"preset": value.name}
    preset = value.name.removesuffix(" (modified)")
    base, own = asdict(PRESETS[preset]), asdict(value)
    differs = {k: v for k, v in own.items() if k != "name" and v != base[k]}
    if "legs" in differs:
        differs["legs"] = list(differs["legs"])
    return {"preset": preset, **differs}


def _preset(name: object) -> Robot:
    if not isinstance(name, str) or name not in PRESETS:
        raise UnknownName("robot", name, PRESETS)
    return PRESETS[name]


def _legs(given: dict[str, Any], base: Robot) -> tuple[LegMount, ...]:
    """Pop `n_legs`, `mount_radius_m` and `legs` from the input and return the mounts."""
    count, radius = given.pop("n_legs", None), given.pop("mount_radius_m", None)
    mounts = given.pop("legs", None)
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
    shape = "robot.legs must be a list of {azimuth_deg, radius_m}"
    if not isinstance(mounts, Sequence) or isinstance(mounts, str):
        raise InvalidInput(shape)
    read = []
    for mount in mounts:
        if not isinstance(mount, Mapping) or set(mount) - {"azimuth_deg", "radius_m"}:
            raise InvalidInput(shape)
        azimuth = _number("legs.azimuth_deg", mount.get("azimuth_deg"))
        read.append(LegMount(azimuth, _number("mount_radius_m", mount.get("radius_m", 0.10))))
    return tuple(read)


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidInput(f"robot.{name} must be a number, not {value!r}")
    low, high = RANGES.get(name, MOUNT_RADIUS if name == "mount_radius_m" else AZIMUTH)
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
    "properties": _numbers({"azimuth_deg": AZIMUTH, "radius_m": MOUNT_RADIUS}),
    "additionalProperties": False,
}
_COUNTED: Schema = {
    "n_legs": {"type": "integer", "minimum": MIN_LEGS, "maximum": MAX_LEGS},
    **_numbers({"mount_radius_m": MOUNT_RADIUS}),
}
_GIVEN: Schema = {
    "type": "object",
    "properties": {
        "preset": _PRESET,
        "legs": {
            "type": "array",
            "minItems": MIN_LEGS,
            "maxItems": MAX_LEGS,
            "items": {**_LEG, "required": ["azimuth_deg"]},
        },
        **_COUNTED,
        **_numbers(RANGES),
    },
    "additionalProperties": False,
    "not": {"required": ["legs"], "anyOf": [{"required": [name]} for name in _COUNTED]},
}
_SENT: Schema = {
    "type": "object",
    "description": "A preset, and by name the parts that differ from it.",
    "properties": {
        "preset": _PRESET,
        "legs": {"type": "array", "items": {**_LEG, "required": ["azimuth_deg", "radius_m"]}},
    },
    "required": ["preset"],
    "additionalProperties": {"type": "number"},
}
AnyRobot = Annotated[
    Robot,
    JsonForm(robot, as_mapping, {"anyOf": [_PRESET, _GIVEN]}, _SENT),
]
"""A robot: in requests a preset's name too."""
