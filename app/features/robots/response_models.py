"""Answers about stored robots."""

from dataclasses import dataclass, field
from typing import Any

from app.answer import Answer
from app.storage.database.robots import RobotOrigin
from app.storage.stored_robot import RobotFields, StoredRobot
from hexapods.domain.creatures import own_gait
from hexapods.domain.gait import AnyGait, resolve
from hexapods.domain.kinematics import legs_of
from hexapods.domain.records import from_json
from hexapods.domain.robot import legs_written_out, written_out
from hexapods.domain.suggestions import usual_grid_side_m
from hexapods.imports.imported import FileFormat, ImportedLeg
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import Preview, preview


class StoredLeg(Answer):
    """A leg of a stored robot.

    Attributes:
        leg: number of the leg, from 1.
        azimuth_deg: direction of its place on the torso, anticlockwise from body x.
        joints: names of its joints, from the torso to the foot.
    """

    leg: int
    azimuth_deg: float
    joints: list[str]


@dataclass(frozen=True, kw_only=True)
class StoredRobotView(RobotFields):
    """A stored robot.

    Attributes:
        id: id of its content: the same robot has the same id on every server.
        gait: gait that suits the robot.
        groups: legs of each group of this gait.
    """

    gait: AnyGait = field()
    groups: list[list[int]]
    legs: list[StoredLeg]


class StoredRobotsView(Answer):
    """Stored robots, in the order in which they were stored."""

    items: list[StoredRobotView]


class FoundView(Answer):
    """Findings in the file of a robot, which a person may correct.

    Attributes:
        file: path in the zip of the file that was read; null if it was not in a zip.
        legs: leg by leg: the names of the joints and of the foot in the file.
        feet: names in the file of all parts that could be the foot of a leg.
        keyframes: names of the file's keyframes.
        forward_deg: direction in which it walks, anticlockwise from x of its torso in the file.
        reaches_grid: whether its feet reach a foot grid that suits its size.
    """

    file_format: FileFormat
    file: str | None
    legs: list[ImportedLeg]
    feet: list[str]
    keyframes: list[str]
    forward_deg: float
    reaches_grid: bool


@dataclass(frozen=True, kw_only=True)
class WholeRobotView(StoredRobotView):
    """A stored robot with all its numbers, and a preview of its walk.

    The preview is with its gait, on a foot grid that suits its size.

    Attributes:
        found: findings in its file; null if it was made here.
        robot: the robot by value, as a request may have it.
    """

    robot: dict[str, Any]
    preview: Preview
    found: FoundView | None


def robot_view(stored: StoredRobot) -> StoredRobotView:
    """Return a stored robot with its gait and its legs.

    Raises:
        InvalidInput: if its document is not there, or damaged.
    """
    robot = stored.robot
    gait, legs = own_gait(robot), legs_of(robot)
    return StoredRobotView(
        **vars(stored) | {"gait": gait},
        groups=[list(group) for group in resolve(gait, robot.azimuths_deg).groups],
        legs=[
            StoredLeg(
                leg=number,
                azimuth_deg=azimuth_deg,
                joints=[joint.name for joint in legs.of_leg(number)],
            )
            for number, azimuth_deg in enumerate(robot.azimuths_deg, start=1)
        ],
    )


def whole_view(stored: StoredRobot, origin: RobotOrigin | None) -> WholeRobotView:
    """Return a stored robot with its numbers, preview and findings; errors as of `robot_view`."""
    robot = stored.robot
    gait = own_gait(robot)
    walk = WalkingProblem(gait=gait, robot=robot, grid_side_m=usual_grid_side_m(robot, gait))
    numbers = {name: value for name, value in written_out(robot).items() if value is not None}
    return WholeRobotView(
        **vars(robot_view(stored)),
        robot={**numbers, "legs": legs_written_out(robot)},
        preview=preview(walk),
        found=None if origin is None else from_json(FoundView, origin.found),
    )
