"""What was read from a file: a robot, what was guessed and repaired, and how it looks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import AnyGait
from hexapods.domain.model_robot import ModelRobot, model_robot
from hexapods.domain.records import Record
from hexapods.domain.robot_model import ModelMesh, RobotModel, Vector
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
        forward_deg: direction in which it walks, as in `Choices.forward`.
        mass_kg: its mass.
        body_height_m: height of the torso's centre above the centres of the feet.
        body_heights_m: lowest and highest value for `Choices.body_height_m`; null if there is no
            choice.
        reaches_grid: whether each foot at home reaches the corners of a box around it, which is
            about as large as a foot grid that suits the robot.
        notes: what was guessed and repaired.
        numbers: values of fields in `ModelRobot.changeable` that the file gives: one that was
            exported here.
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
    body_heights_m: tuple[float, float] | None
    reaches_grid: bool
    notes: tuple[Note, ...]
    numbers: Mapping[str, float] = field(default_factory=dict)

    def robot(self, name: str) -> ModelRobot:
        """Return the robot under a name.

        Raises:
            InvalidInput: if a number is out of range.
        """
        return model_robot(self.model, name, **self.numbers)

    @property
    def guesses(self) -> tuple[str, ...]:
        """What was inferred and may be otherwise, a sentence each."""
        return tuple(note.text for note in self.notes if note.kind == "guess")

    @property
    def repairs(self) -> tuple[str, ...]:
        """What was changed, a sentence each."""
        return tuple(note.text for note in self.notes if note.kind == "repair")


@dataclass(frozen=True)
class SketchPart(Record):
    """A body of the file.

    Positions are in the frame of the sketch: x right, y forward, z up, the ground at z = 0.

    Attributes:
        name: its name in the file.
        leg: number of its leg, from 1; 0 for the torso and what is of no leg.
        foot: what `Choices.feet` calls it; null if it cannot be a foot.
        at_m: middle of what is drawn of it, or the origin of its frame.
        low_m: its lowest point.
        mesh: what is drawn, in the frame of the sketch; null for a body without a shape.
    """

    name: str
    leg: int
    foot: str | None
    at_m: Vector
    low_m: Vector
    mesh: ModelMesh | None


@dataclass(frozen=True)
class SketchFoot(Record):
    """A foot of a leg, or where no legs were found, what could be one.

    Attributes:
        name: its name in the file, fit for `Choices.feet`.
        leg: number of its leg, from 1; 0 where no legs were found.
        at_m: its centre in the frame of the sketch.
        radius_m: its radius.
    """

    name: str
    leg: int
    at_m: Vector
    radius_m: float


@dataclass(frozen=True)
class Sketch(Record):
    """Bodies and feet of a robot that stands, or of a file in which no robot was found.

    Attributes:
        parts: its bodies, parents first.
        feet: its feet, in the order of its legs.
    """

    parts: tuple[SketchPart, ...]
    feet: tuple[SketchFoot, ...]


@dataclass(frozen=True)
class RobotReading(Record):
    """What was read from a file: a robot, or why there is none, and how it looks.

    Attributes:
        robot: the robot; null if its legs, its stance or a choice is not valid.
        problem: why there is no robot; null if there is one.
        notes: what was guessed and repaired, as far as it was read.
        sketch: bodies and feet.
        document: path in the zip of what was read; null if it was given alone.
        documents: paths in the zip of all documents that could be the robot, fit for
            `Choices.file`.
        arguments: values of the arguments of a xacro, fit for `Choices.arguments`.
    """

    robot: ImportedRobot | None
    problem: str | None
    notes: tuple[Note, ...]
    sketch: Sketch
    document: str | None = None
    documents: tuple[str, ...] = ()
    arguments: dict[str, str] = field(default_factory=dict)

    def valid_robot(self) -> ImportedRobot:
        """Return the robot.

        Raises:
            InvalidInput: if there is none, saying why.
        """
        if self.robot is None:
            raise InvalidInput(self.problem or "it is no robot")
        return self.robot
