"""The body of a robot: its torso, its legs, servos and step timing.

In the body frame x points right, y forward and z up where a gait leads along the body; a regular
ring has leg 1 along x, so that forward is where its gait says. Legs are numbered anticlockwise.
"""

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from hexapods.domain.errors import ImpossibleLegs, InvalidInput
from hexapods.domain.robot_documents import RobotDocument
from hexapods.domain.short_repr import short_repr

MIN_LEGS, MAX_LEGS = 3, 12
NO_NUMBERS = ("name", "legs", "id", "document", "model")
"""Fields of a robot that are not a number; a robot from a file has a model."""
_OPTIONAL = ("torso_length_m", "torso_width_m")
"""Fields of a robot that may be None."""


@dataclass(frozen=True)
class LegMount:
    """A leg: where its coxa joint is on the torso, and what differs from the robot's other legs.

    Its place is in polar coordinates of the body frame. A field that is None has the robot's value.
    """

    __repr__ = short_repr

    azimuth_deg: float
    """Anticlockwise from body x, seen from above."""
    radius_m: float = 0.10
    z_m: float = 0.0
    """Height above the torso's centre."""
    yaw_deg: float | None = None
    """Direction in which it points at rest, anticlockwise from body x; None: its azimuth."""
    foot_out_m: float | None = None
    """Horizontal distance of the foot at home from the coxa joint; None: as far as puts the foot
    `home_radius_m` from the torso's centre, if the leg points away from there."""
    coxa_m: float | None = None
    femur_m: float | None = None
    tibia_m: float | None = None
    coxa_kg: float | None = None
    femur_kg: float | None = None
    tibia_kg: float | None = None
    foot_kg: float | None = None
    servo_kp: float | None = None
    servo_kv: float | None = None
    servo_torque_nm: float | None = None

    @property
    def direction_deg(self) -> float:
        """Direction in which it points at rest, anticlockwise from body x."""
        return self.azimuth_deg if self.yaw_deg is None else self.yaw_deg


class ServoStrength(NamedTuple):
    """Limits of a position servo."""

    kp: float
    """Position gain [N·m/rad]."""
    kv: float
    """Velocity gain [N·m·s/rad]."""
    torque_nm: float
    """Largest torque by magnitude."""


def ring(legs: int, radius_m: float = 0.10) -> tuple[LegMount, ...]:
    """Return the mounts of a regular ring, leg 1 along body x, numbered anticlockwise.

    Raises:
        InvalidInput: if the number of legs is out of range.
    """
    _check_count(legs)
    return tuple(LegMount(360 * i / legs, radius_m) for i in range(legs))


def _check_name(name: object) -> None:
    if not isinstance(name, str):
        raise InvalidInput(f"robot.name must be a text, not {name!r}")


def _check_count(legs: int) -> None:
    if not MIN_LEGS <= legs <= MAX_LEGS:
        raise InvalidInput(f"a robot has {MIN_LEGS} to {MAX_LEGS} legs, not {legs}")


@dataclass(frozen=True)
class Robot:
    """Parameters of a robot. Lengths in m, masses in kg, times in s.

    The defaults are the `stiff` hexapod. Dimensions, masses and servos are those of all legs whose
    mount does not override them. The torso is a cylinder, or a box if it has a length and a width.

    Robots are equal if they are built alike, whatever their names. A stored robot is pickled with
    its document, so that the process that unpickles it needs no library.

    Raises:
        InvalidInput: if a value is out of range.
    """

    __repr__ = short_repr

    name: str = field(default="stiff", compare=False)
    """Name of the preset or stored robot; with the suffix `(modified)` if fields differ from it.

    Any other name is not saved with results.
    """
    legs: tuple[LegMount, ...] = ring(6)
    torso_radius_m: float = 0.10
    torso_half_height_m: float = 0.02
    torso_length_m: float | None = None
    """Along body y."""
    torso_width_m: float | None = None
    """Along body x."""
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
    id: str | None = field(default=None, compare=False, kw_only=True)
    """Id of the stored robot, also where fields differ from it; None for a preset."""
    document: RobotDocument | None = field(default=None, compare=False, repr=False, kw_only=True)
    """The document of the stored robot with this id; None for a preset."""

    def __post_init__(self) -> None:
        _check_name(self.name)
        numbers = {name: value for name, value in vars(self).items() if name not in NO_NUMBERS}
        if (self.torso_length_m is None) != (self.torso_width_m is None):
            raise InvalidInput("robot.torso_length_m and torso_width_m go together: give both")
        for name, value in numbers.items():
            if value is None and name in _OPTIONAL:
                continue
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise InvalidInput(f"robot.{name} must be a number, not {value!r}")
            if not (math.isfinite(value) and value > 0):
                raise InvalidInput(f"robot.{name} must be positive and finite, not {value}")
        legs: Any = self.legs  # not validated
        if not isinstance(legs, tuple) or not all(isinstance(leg, LegMount) for leg in legs):
            raise InvalidInput(f"robot.legs must be a tuple of LegMount, not {legs!r}")
        _check_count(len(self.legs))
        self._check_legs()
        if self.dt_s > 0.005:
            raise InvalidInput(f"robot.dt_s must be at most 0.005 s, not {self.dt_s}")
        for name in ("swing_s", "shift_s"):
            if not 2 * self.dt_s <= getattr(self, name) <= 5:
                raise InvalidInput(f"robot.{name} must be from two substeps to 5 s")

    def _check_legs(self) -> None:
        """Check that each foot is away from its coxa joint, and from the other feet.

        Raises:
            ImpossibleLegs: naming the leg.
        """
        for number, out_m in enumerate(self.feet_out_m, start=1):
            if not out_m > 0:
                raise ImpossibleLegs(
                    f"the foot of leg {number} would be under its coxa joint or behind it: choose "
                    "a larger home_radius_m, a smaller radius_m, or its own foot_out_m",
                    [number],
                )
        homes = self.homes_m
        for number, (x, y) in enumerate(homes, start=1):
            for other, (other_x, other_y) in enumerate(homes[: number - 1], start=1):
                if math.hypot(x - other_x, y - other_y) < self.foot_radius_m:
                    raise ImpossibleLegs(
                        f"the feet of legs {other} and {number} are in one place", [other, number]
                    )

    def servo_of(self, leg: int, joint: str) -> ServoStrength:  # noqa: ARG002 - a leg has equal servos
        """Return the servo of a joint, by its leg from 1 and its name."""
        names = ("servo_kp", "servo_kv", "servo_torque_nm")
        return ServoStrength(*(self.of_legs(name)[leg - 1] for name in names))

    @property
    def foot_radii_m(self) -> tuple[float, ...]:
        """Radius of each foot."""
        return (self.foot_radius_m,) * len(self.legs)

    def of_legs(self, name: str) -> tuple[float, ...]:
        """Return each leg's value of a field that a mount may override, such as `coxa_m`."""
        default = getattr(self, name)
        overrides = (getattr(leg, name) for leg in self.legs)
        return tuple(default if value is None else value for value in overrides)

    @property
    def feet_out_m(self) -> tuple[float, ...]:
        """Horizontal distance of each foot at home from its coxa joint."""
        return tuple(
            self.home_radius_m - leg.radius_m if leg.foot_out_m is None else leg.foot_out_m
            for leg in self.legs
        )

    @property
    def homes_m(self) -> list[tuple[float, float]]:
        """Place (x, y) of each foot at home in the body frame."""
        homes = []
        for leg, out_m in zip(self.legs, self.feet_out_m, strict=True):
            azimuth, yaw = math.radians(leg.azimuth_deg), math.radians(leg.direction_deg)
            homes.append(
                (
                    leg.radius_m * math.cos(azimuth) + out_m * math.cos(yaw),
                    leg.radius_m * math.sin(azimuth) + out_m * math.sin(yaw),
                )
            )
        return homes

    @property
    def span_m(self) -> float:
        """Largest horizontal distance of a foot at home from the torso's centre."""
        if all(leg.foot_out_m is None and leg.yaw_deg is None for leg in self.legs):
            return self.home_radius_m
        return max(math.hypot(x, y) for x, y in self.homes_m)

    @property
    def torso_half_sides_m(self) -> tuple[float, float]:
        """Half the torso's size along body x and y."""
        if self.torso_length_m is None or self.torso_width_m is None:
            return self.torso_radius_m, self.torso_radius_m
        return self.torso_width_m / 2, self.torso_length_m / 2

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
