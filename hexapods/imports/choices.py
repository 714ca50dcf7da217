"""Decisions of a person about a robot from a file, in place of guesses."""

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Le, MaxLen, MinLen

from hexapods.domain.body import MAX_LEGS, MIN_LEGS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import AnyGait
from hexapods.domain.records import Record, from_json, to_json

MAX_NAMES = 100
MAX_FILE_NAME = 200
NameInFile = Annotated[str, MinLen(1), MaxLen(MAX_FILE_NAME)]
Direction = Annotated[str, MinLen(1), MaxLen(20)]
ArgumentText = Annotated[str, MaxLen(1000)]
Angle = Annotated[float, Ge(-7.0), Le(7.0)]
Axis = Literal["x", "-x", "y", "-y", "z", "-z"]
AngleUnit = Literal["rad", "deg"]


@dataclass(frozen=True)
class Choices(Record):
    """Decisions of a person about a robot from a file; null fields are inferred from the file.

    Attributes:
        file: of several robots in a zip the path of the one that is meant.
        arguments: values of arguments of a xacro, `$(arg …)`, by name.
        scale: factor of all lengths of the file; 0.001 reads millimetres. Inertias change with its
            square, and masses that follow from densities with its cube; masses and torques that
            the file gives stay.
        up: axis of the file that points up; z unless told otherwise.
        angle_unit: unit of the limits of joints in the file.
        mass_kg: mass of the whole robot; those of its links keep their ratios.
        forward: direction in which it walks, in the frame of its torso in the file: a horizontal
            axis, such as `x`, `-x`, `y` or `-y`; or an angle anticlockwise from x, seen from
            above; from y where x or -x is up [°].
        feet: for each leg the name of its foot in the file: of a body or link, of a geom, or of a
            site; in any order.
        keyframe: name of the keyframe of the file in which it stands.
        body_height_m: height of the torso's centre above the centres of the feet, with which it
            stands.
        home_rad: angles of joints with which it stands, by their names in the file [rad]; each is
            as given, the others are as found.
        gait: which legs move together: the name of a gait, or groups of legs.
        servo_torque_nm: largest torque of all servos [N·m].
        servo_kp: position gain of all servos [N·m/rad].
        servo_kv: velocity gain of all servos [N·m·s/rad].
    """

    file: NameInFile | None = None
    arguments: Annotated[dict[NameInFile, ArgumentText], MaxLen(MAX_NAMES)] | None = None
    scale: Annotated[float, Ge(0.001), Le(1000.0)] | None = None
    up: Axis | None = None
    angle_unit: AngleUnit | None = None
    mass_kg: Annotated[float, Ge(0.001), Le(10_000.0)] | None = None
    forward: Direction | Annotated[float, Ge(-360.0), Le(360.0)] | None = None
    feet: Annotated[tuple[NameInFile, ...], MinLen(MIN_LEGS), MaxLen(MAX_LEGS)] | None = None
    keyframe: NameInFile | None = None
    body_height_m: Annotated[float, Ge(0.001), Le(20.0)] | None = None
    home_rad: Annotated[dict[NameInFile, Angle], MaxLen(MAX_NAMES)] | None = None
    gait: AnyGait | None = None
    servo_torque_nm: Annotated[float, Ge(0.001), Le(10_000.0)] | None = None
    servo_kp: Annotated[float, Ge(0.01), Le(1_000_000.0)] | None = None
    servo_kv: Annotated[float, Ge(0.0001), Le(100_000.0)] | None = None


AS_FOUND = Choices()
"""Infer everything from the file."""


def check_choices(choices: Choices) -> None:
    """Check that choices are within their limits.

    Raises:
        InvalidInput: naming the choice, and what is valid.
    """
    try:
        from_json(Choices, to_json(choices))
    except InvalidInput:
        raise
    except ValueError as error:
        raise InvalidInput(f"of the choices, {error}") from error
