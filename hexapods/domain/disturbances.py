"""Disturbances: what can happen to a robot or to the ground it walks on; one class for each kind.

Each begins with a step and may end with one. Steps are counted from 0, so that `at_step: 0` holds
from the start. Each field is declared once, as `hexapods.domain.settings` describes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, NamedTuple

from annotated_types import Ge, Gt, Le

from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import JOINT_LIMITS_RAD, legs_of
from hexapods.domain.robot import MAX_LEGS, RANGES, Robot
from hexapods.domain.robot_model import JOINT_NAME, MAX_ANGLE_RAD
from hexapods.domain.settings import Setting, declared_fields

MAX_STEP = 10_000_000
"""The highest step in which something may begin or end; no run has more."""
Direction = Annotated[
    float,
    Ge(-180),
    Le(180),
    Setting(
        title="Direction",
        unit="°",
        help="0 along the track, 90 to the left, 180 against it.",
    ),
]
_Friction = Annotated[
    float,
    Ge(RANGES["friction"][0]),
    Le(RANGES["friction"][1]),
    Setting(title="Friction", symbol="μ", help="Sliding friction of all that touches the ground."),
]
LEGS = Setting(title="Legs", help="The numbers of the legs, from 1.")
"""Description of the field `legs`."""
Key = tuple[Any, ...]
"""Name of the part that a disturbance changes; a leg's is a prefix of those of its joints."""


class RangesByChoice(NamedTuple):
    """Limits of a field that depend on the choice of another field.

    Attributes:
        field: the other field.
        ranges: (low, high) of each of its choices.
    """

    field: str
    ranges: Mapping[str, tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class Disturbance:
    """Something that happens to a robot or to the ground; subclasses are the kinds.

    Attributes:
        at_step: the first step in which it holds, counted from 0.
        until_step: the first step in which it no longer holds; None if it stays.

    Raises:
        InvalidInput: if a value is out of its limits; the message names them.
    """

    kind: ClassVar[str]
    title: ClassVar[str]
    help: ClassVar[str]
    """One sentence for users."""
    size: ClassVar[str | None] = None
    """The field with the strength of the disturbance; None if that does not vary."""
    nothing: ClassVar[float | str | None] = 0.0
    """The size without an effect: a number, or the field of the robot that has it; None if every
    size has an effect."""
    ranges: ClassVar[Mapping[str, RangesByChoice]] = MappingProxyType({})
    """Narrower limits of fields, by the choice of another field."""
    lasts: ClassVar[bool] = True
    """Whether it holds until another disturbance of the same part; a push does not."""
    identified_by: ClassVar[tuple[str, ...]] = ()
    """The fields that name, with the kind, the part that it changes."""
    part: ClassVar[Key] = ()
    """The part of a leg to which it happens; by default all of it."""
    repairs: ClassVar[bool] = False
    """Whether it only ends earlier disturbances."""
    adjective: ClassVar[str] = ""
    """Adjective of a leg to which it has happened; empty where `kind` is one."""

    at_step: Annotated[
        int,
        Ge(0),
        Le(MAX_STEP),
        Setting(title="Begins at step", help="The first step in which it holds; 0 is the start."),
    ] = 0
    until_step: (
        Annotated[
            int,
            Ge(1),
            Le(MAX_STEP),
            Setting(title="Ends at step", help="The first step in which it no longer holds."),
        ]
        | None
    ) = None

    def __post_init__(self) -> None:
        for setting in declared_fields(type(self)).values():  # type: ignore[arg-type]  # mypy: no hash
            try:
                value = setting.normalized(getattr(self, setting.name))
            except InvalidInput as error:
                raise InvalidInput(f"{self.kind}: {error}") from error
            object.__setattr__(self, setting.name, value)
        if self.until_step is not None and self.until_step <= self.at_step:
            raise InvalidInput(
                f"{self.kind}: until_step must be over at_step, {self.at_step}, not "
                f"{self.until_step}"
            )

    def holds_at(self, step: int) -> bool:
        """Whether the disturbance holds in a step."""
        return self.at_step <= step and (self.until_step is None or step < self.until_step)

    def parts(self) -> "Mapping[Key, Disturbance]":
        """Return the disturbance of each part that it changes; the newest of a part holds."""
        return {(self.kind, *(getattr(self, name) for name in self.identified_by)): self}

    def check(self, robot: Robot) -> None:
        """Check that the disturbance can happen to this robot.

        Raises:
            InvalidInput: if the robot has no such leg.
        """


@dataclass(frozen=True, kw_only=True)
class _LegDisturbance(Disturbance):
    """Base class of disturbances of legs, by their numbers from 1."""

    identified_by = ("legs",)
    legs: Sequence[int]

    def __post_init__(self) -> None:
        super().__post_init__()
        legs: Any = self.legs  # not validated
        is_list = isinstance(legs, list | tuple)
        if is_list:  # JSON does not distinguish 2.0 from 2
            legs = [int(x) if isinstance(x, float) and x.is_integer() else x for x in legs]
        if not is_list or not legs or any(type(leg) is not int for leg in legs):
            raise InvalidInput(f"{self.kind}: legs must be a list of numbers of legs, such as 1,4")
        if len(set(legs)) < len(legs) or not 1 <= min(legs) <= max(legs) <= MAX_LEGS:
            raise InvalidInput(
                f"{self.kind}: legs must be different numbers from 1 to {MAX_LEGS}, not "
                f"{', '.join(map(str, legs))}"
            )
        object.__setattr__(self, "legs", tuple(sorted(legs)))

    def parts(self) -> "Mapping[Key, Disturbance]":
        return {("leg", leg, *self.part): replace(self, legs=(leg,)) for leg in self.legs}

    def check(self, robot: Robot) -> None:
        for leg in self.legs:
            _check_leg(self.kind, leg, robot)


def _check_leg(kind: str, leg: int, robot: Robot) -> None:
    if leg > len(robot.legs):
        raise InvalidInput(
            f"{kind}: there is no leg {leg}; this robot has legs 1 to {len(robot.legs)}"
        )


@dataclass(frozen=True, kw_only=True)
class Limp(_LegDisturbance):
    """Legs whose servos are without power."""

    kind = "limp"
    title = "Limp legs"
    help = "The servos of these legs have no power: the legs hang and are dragged along."
    part = ("power",)


@dataclass(frozen=True, kw_only=True)
class Stuck(Disturbance):
    """A joint whose servo holds one angle, whatever its command."""

    kind = "stuck"
    title = "Stuck joint"
    help = "One joint holds this angle, whatever it is told."
    ranges = MappingProxyType({"angle_rad": RangesByChoice("joint", JOINT_LIMITS_RAD)})
    identified_by = ("leg", "joint")
    leg: Annotated[
        int, Ge(1), Le(MAX_LEGS), Setting(title="Leg", help="The number of the leg, from 1.")
    ]
    joint: Annotated[
        str,
        Setting(
            title="Joint",
            help="Coxa turns the leg, femur lifts it, tibia bends it; robots from files have "
            "others.",
        ),
    ]
    angle_rad: Annotated[
        float,
        Ge(-MAX_ANGLE_RAD),
        Le(MAX_ANGLE_RAD),
        Setting(title="Angle", unit="rad", help="Positive lifts; 0 is straight."),
    ]

    def __post_init__(self) -> None:
        super().__post_init__()
        if JOINT_NAME.fullmatch(self.joint) is None:
            raise InvalidInput(
                f"stuck: joint must be the name of a joint, such as {', '.join(JOINT_LIMITS_RAD)}, "
                f"not {self.joint[:40]!r}"
            )

    def parts(self) -> "Mapping[Key, Disturbance]":
        """Return itself by the joint's key."""
        return {("leg", self.leg, self.joint): self}

    def check(self, robot: Robot) -> None:
        """Check that the robot has the leg and the joint, which turns so far."""
        _check_leg(self.kind, self.leg, robot)
        legs = legs_of(robot)
        low, high = legs.joints[legs.index(self.leg, self.joint)].limits_rad
        if not low <= self.angle_rad <= high:
            raise InvalidInput(
                f"stuck: the {self.joint} of leg {self.leg} turns from {low:g} to {high:g} rad, "
                f"not to {self.angle_rad:g}"
            )


@dataclass(frozen=True, kw_only=True)
class Lost(_LegDisturbance):
    """Legs that are gone."""

    kind = "lost"
    title = "Lost legs"
    help = "These legs are gone, with their weight."


@dataclass(frozen=True, kw_only=True)
class Weak(_LegDisturbance):
    """Legs whose servos have less torque."""

    kind = "weak"
    title = "Weak servos"
    help = "The servos of these legs have only a share of their torque."
    part = ("power",)
    size, nothing = "torque_share", 1.0
    torque_share: Annotated[
        float, Gt(0), Le(1), Setting(title="Share of torque", help="1 is all of it.")
    ]


@dataclass(frozen=True, kw_only=True)
class Repair(_LegDisturbance):
    """Legs that work again as they were built: ends their earlier disturbances."""

    kind = "repair"
    title = "Repaired legs"
    help = "These legs work again as they were built."
    repairs, adjective = True, "repaired"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.until_step is not None:
            raise InvalidInput("repair: a repaired leg stays so; leave out until_step")


@dataclass(frozen=True, kw_only=True)
class Slope(Disturbance):
    """Tilted ground: gravity is tilted instead, and the track lies in the plane."""

    kind = "slope"
    title = "Slope"
    help = "The ground rises in this direction."
    size = "degrees"
    degrees: Annotated[float, Ge(0), Le(30), Setting(title="Slope", unit="°", help="0 is flat.")]
    direction_deg: Direction = 0.0


@dataclass(frozen=True, kw_only=True)
class Rough(Disturbance):
    """Rough ground: a height field from a seed, repeated along the track."""

    kind = "rough"
    title = "Rough ground"
    help = "Bumps up to this height; the seed decides where they are."
    size = "amplitude_m"
    amplitude_m: Annotated[
        float, Ge(0), Le(0.04), Setting(title="Height of bumps", unit="m", help="0 is flat.")
    ]
    seed: Annotated[
        int, Ge(0), Le(2**32 - 1), Setting(title="Seed of the ground", help="Where the bumps are.")
    ] = 0


@dataclass(frozen=True, kw_only=True)
class Friction(Disturbance):
    """Another friction of the whole ground."""

    kind = "friction"
    title = "Friction"
    help = "How much the ground grips: 1 is rubber on wood, 0.1 is ice."
    size, nothing = "value", "friction"
    value: _Friction


@dataclass(frozen=True, kw_only=True)
class Patch(Disturbance):
    """A strip across the track with another friction."""

    kind = "patch"
    title = "Patch"
    help = "A strip across the track with another friction."
    # On other ground, such as ice, a strip with the robot's own friction has an effect.
    size, nothing = "friction", None
    identified_by = ("from_m", "to_m")
    from_m: Annotated[
        float, Ge(-10), Le(1000), Setting(title="From", unit="m", help="Where the strip begins.")
    ]
    to_m: Annotated[
        float, Ge(-10), Le(1000), Setting(title="To", unit="m", help="Where the strip ends.")
    ]
    friction: _Friction

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.to_m <= self.from_m:
            raise InvalidInput(f"patch: to_m must be over from_m, {self.from_m:g}")


@dataclass(frozen=True, kw_only=True)
class Payload(Disturbance):
    """A mass on top of the torso."""

    kind = "payload"
    title = "Payload"
    help = "A mass on top of the robot, in its middle or beside it."
    size = "kg"
    kg: Annotated[float, Ge(0), Le(20), Setting(title="Mass", unit="kg", help="0 is none.")]
    x_m: Annotated[
        float, Ge(-1), Le(1), Setting(title="To the right", unit="m", help="From the middle.")
    ] = 0.0
    y_m: Annotated[
        float, Ge(-1), Le(1), Setting(title="Forward", unit="m", help="From the middle.")
    ] = 0.0


@dataclass(frozen=True, kw_only=True)
class Push(Disturbance):
    """A push at the beginning of one step, spread over the whole robot by mass."""

    kind = "push"
    title = "Push"
    help = "A push at the beginning of the step."
    lasts = False
    size = "impulse_ns"
    impulse_ns: Annotated[
        float, Ge(0), Le(20), Setting(title="Impulse", unit="N·s", help="Of the push.")
    ]
    direction_deg: Direction = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.until_step is not None:
            raise InvalidInput("push: it happens in one step; leave out until_step")


@dataclass(frozen=True, kw_only=True)
class SensorNoise(Disturbance):
    """Normally distributed errors of the measured offsets of the feet."""

    kind = "sensor-noise"
    title = "Sensor noise"
    help = "Where the feet are is measured with this error."
    size = "sd_m"
    sd_m: Annotated[
        float,
        Ge(0),
        Le(0.05),
        Setting(title="Standard deviation", unit="m", help="0 is none; sideways and forward."),
    ]


@dataclass(frozen=True, kw_only=True)
class Delay(Disturbance):
    """Servos that receive every command later."""

    kind = "delay"
    title = "Servo delay"
    help = "Servos execute commands this much later."
    size = "seconds"
    seconds: Annotated[float, Ge(0), Le(0.1), Setting(title="Delay", unit="s", help="0 is none.")]


@dataclass(frozen=True, kw_only=True)
class DeadBand(Disturbance):
    """Servos that ignore a command which differs too little from the one they hold."""

    kind = "dead-band"
    title = "Servo dead band"
    help = "Servos ignore changes of their command that are smaller than this."
    size = "radians"
    radians: Annotated[
        float, Ge(0), Le(0.2), Setting(title="Dead band", unit="rad", help="0 is none.")
    ]


KINDS: Mapping[str, type[Disturbance]] = {
    kind.kind: kind
    for kind in (
        Limp, Stuck, Lost, Weak, Repair, Slope, Rough, Friction, Patch, Payload, Push,
        SensorNoise, Delay, DeadBand,
    )
}  # fmt: skip


def is_nothing(disturbance: Disturbance, robot: Robot) -> bool:
    """Whether a disturbance only ends an earlier one: a slope of 0°, the robot's own friction."""
    if disturbance.size is None:
        return False
    nothing = (
        getattr(robot, disturbance.nothing)
        if isinstance(disturbance.nothing, str)
        else disturbance.nothing
    )
    return bool(getattr(disturbance, disturbance.size) == nothing)
