"""A robot that was read from a file, and all that was guessed and repaired on the way."""

from dataclasses import dataclass
from typing import Literal

from hexapods.domain.gait import AnyGait
from hexapods.domain.records import Record
from hexapods.domain.robot_model import RobotModel
from hexapods.imports.notes import Note

FileFormat = Literal["mjcf", "urdf"]


@dataclass(frozen=True)
class ImportedLeg(Record):
    """A leg as it is called in the file.

    Attributes:
        joints: names of its joints, from the torso to the foot.
        foot: name of its foot: of a geom, a site, or a body or link; fit for `Choices.feet`.
    """

    joints: tuple[str, ...]
    foot: str


@dataclass(frozen=True)
class ImportedRobot(Record):
    """A robot from a file.

    Attributes:
        model: the robot.
        name: name that the file gives it, or that of the file.
        file_format: format of the file.
        file: path in the zip of what was read; null if it was given alone.
        legs: in the order of the model's legs.
        feet: names in the file of all that could be the foot of a leg, fit for `Choices.feet`.
        keyframes: names of the file's keyframes.
        gait: which legs move together.
        forward_deg: direction in which it walks, anticlockwise from x of its torso's frame in the
            file.
        mass_kg: its mass.
        body_height_m: height of the torso's centre above the centres of the feet.
        reaches_grid: whether each foot at home reaches the corners of a box around it, which is
            about as large as a foot grid that suits the robot.
        notes: what was guessed and repaired.
    """

    model: RobotModel
    name: str
    file_format: FileFormat
    file: str | None
    legs: tuple[ImportedLeg, ...]
    feet: tuple[str, ...]
    keyframes: tuple[str, ...]
    gait: AnyGait
    forward_deg: float
    mass_kg: float
    body_height_m: float
    reaches_grid: bool
    notes: tuple[Note, ...]

    @property
    def guesses(self) -> tuple[str, ...]:
        """What was inferred and may be otherwise, a sentence each."""
        return tuple(note.text for note in self.notes if note.kind == "guess")

    @property
    def repairs(self) -> tuple[str, ...]:
        """What was changed, a sentence each."""
        return tuple(note.text for note in self.notes if note.kind == "repair")
