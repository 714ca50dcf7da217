"""Answers about a robot's file that is looked at before it is stored."""

from base64 import b64encode
from typing import Any

from app.answer import Answer
from hexapods.domain.gait import AnyGait, resolve
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.robot_model import Vector
from hexapods.domain.sums import ordered_sum
from hexapods.drawing.replay_encoding import encode_sketch
from hexapods.drawing.sketch import sketch_body
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.imported import ImportedRobot, RobotReading, Sketch, SketchFoot
from hexapods.imports.notes import Note


class ReadLeg(Answer):
    """A leg of a robot that was read.

    Attributes:
        leg: its number, from 1.
        azimuth_deg: direction of its place on the torso, anticlockwise from body x.
        joints: names of its joints in the file, from the torso to the foot.
        foot: name of its foot in the file.
    """

    leg: int
    azimuth_deg: float
    joints: list[str]
    foot: str


class ReadRobot(Answer):
    """A robot as it was read, before it is stored.

    Attributes:
        gait: which legs move together.
        groups: legs of each group of this gait.
        forward_deg: direction in which it walks, anticlockwise from x of its torso in the file.
        body_height_m: height of the torso's centre above the centres of the feet.
        body_heights_m: lowest and highest one that its legs allow; null if it cannot be changed.
        keyframes: names of the file's keyframes.
        reaches_grid: whether its feet reach a foot grid that suits its size.
    """

    name: str
    gait: AnyGait
    groups: list[list[int]]
    legs: list[ReadLeg]
    forward_deg: float
    mass_kg: float
    body_height_m: float
    body_heights_m: tuple[float, float] | None
    keyframes: list[str]
    reaches_grid: bool


class ReadPart(Answer):
    """A body of the file. Positions are of the sketch: x right, y forward, z up, ground at 0.

    Attributes:
        leg: number of its leg, from 1; 0 for the torso and what is of no leg.
        foot: what `feet` of the choices calls it; null if it cannot be a foot.
        at_m: middle of what is drawn of it.
        low_m: its lowest point.
    """

    name: str
    leg: int
    foot: str | None
    at_m: Vector
    low_m: Vector


class RobotReadingView(Answer):
    """What was read from a robot's file, for a person who confirms or corrects it.

    Attributes:
        id: of the file, which the server keeps for a while; empty for a body.
        file: name of the file.
        document: path in a zip of what was read; null if it was given alone.
        documents: paths in a zip of all documents that could be the robot, fit for `choices.file`.
        arguments: values of the arguments of a xacro, fit for `choices.arguments`.
        choices: choices by which it was read.
        robot: the robot; null if it cannot be stored as it is.
        problem: why it cannot be stored; null if it can.
        notes: what was guessed and repaired.
        parts: bodies of the file.
        feet: feet of its legs; of a file without a robot what could be feet.
        scene: it on a turntable, in base64, as `GET /start-line` encodes a scene. Its bodies are
            the nodes `/world/sketch/part/0`, `…/1`, in the order of `parts`; likewise `…/foot/0`.
    """

    id: str
    file: str
    document: str | None
    documents: list[str]
    arguments: dict[str, str]
    choices: Choices
    robot: ReadRobot | None
    problem: str | None
    notes: list[Note]
    parts: list[ReadPart]
    feet: list[SketchFoot]
    scene: str


def reading_view(
    reading: RobotReading, choices: Choices, file_id: str, file_name: str
) -> RobotReadingView:
    """Return what was read from a file, with its picture."""
    robot = None if reading.robot is None else _read_robot(reading.robot)
    return RobotReadingView(
        id=file_id,
        file=file_name,
        document=reading.document,
        documents=list(reading.documents),
        arguments=reading.arguments,
        choices=choices,
        robot=robot,
        problem=reading.problem,
        notes=list(reading.notes),
        **_picture(reading.sketch, [] if robot is None else robot.groups),
    )


def body_view(body: Robot, spec: AnyGait) -> RobotReadingView:
    """Return a body as a file is shown that has just been read.

    Raises:
        InvalidInput: if the gait does not divide its legs.
    """
    gait = resolve(spec, body.azimuths_deg)
    groups = [list(group) for group in gait.groups]
    legs = legs_of(body)
    return RobotReadingView(
        id="",
        file="",
        document=None,
        documents=[],
        arguments={},
        choices=AS_FOUND,
        robot=ReadRobot(
            name=body.name,
            gait=spec,
            groups=groups,
            legs=[
                ReadLeg(
                    leg=leg,
                    azimuth_deg=azimuth_deg,
                    joints=[joint.name for joint in legs.of_leg(leg)],
                    foot="",
                )
                for leg, azimuth_deg in enumerate(body.azimuths_deg, start=1)
            ],
            forward_deg=gait.forward_deg,
            mass_kg=body.torso_kg + ordered_sum(legs.masses_kg),
            body_height_m=body.body_height_m,
            body_heights_m=None,
            keyframes=[],
            reaches_grid=True,
        ),
        problem=None,
        notes=[],
        **_picture(sketch_body(body, gait), groups),
    )


def _read_robot(imported: ImportedRobot) -> ReadRobot:
    robot = imported.robot(imported.name)
    gait = resolve(imported.gait, robot.azimuths_deg)
    return ReadRobot(
        name=imported.name,
        gait=imported.gait,
        groups=[list(group) for group in gait.groups],
        legs=[
            ReadLeg(leg=number, azimuth_deg=azimuth_deg, joints=list(leg.joints), foot=leg.foot)
            for number, (azimuth_deg, leg) in enumerate(
                zip(robot.azimuths_deg, imported.legs, strict=True), start=1
            )
        ],
        forward_deg=imported.forward_deg,
        mass_kg=imported.mass_kg,
        body_height_m=imported.body_height_m,
        body_heights_m=imported.body_heights_m,
        keyframes=list(imported.keyframes),
        reaches_grid=imported.reaches_grid,
    )


def _picture(sketch: Sketch, groups: list[list[int]]) -> dict[str, Any]:
    return {
        "parts": [
            ReadPart(name=part.name, leg=part.leg, foot=part.foot, at_m=part.at_m, low_m=part.low_m)
            for part in sketch.parts
        ],
        "feet": list(sketch.feet),
        "scene": b64encode(encode_sketch(sketch, groups)).decode("ascii"),
    }
