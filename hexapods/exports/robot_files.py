"""Types of file that a robot is exported as; the command and the route follow from them.

To add one: a function that returns the file's content, in `ROBOT_FILES`. Functions import what they
need when they are called, since MuJoCo takes a while to load.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from hexapods.domain.robot import Robot, document_of
from hexapods.exports.export_format import FileType


class RobotFile(NamedTuple):
    """A type of file.

    Attributes:
        file: its ending, title and media type.
        write: returns its content.
        use: what the file is for, to follow its name.
    """

    file: FileType
    write: Callable[[Robot], bytes]
    use: str


def _mjcf(robot: Robot) -> bytes:
    from hexapods.exports.robot_model import robot_mjcf  # noqa: PLC0415

    return robot_mjcf(robot).encode()


def _urdf(robot: Robot) -> bytes:
    from hexapods.exports.urdf import robot_urdf  # noqa: PLC0415

    return robot_urdf(robot).encode()


def _urdf_zip(robot: Robot) -> bytes:
    from hexapods.exports.urdf import robot_urdf_zip  # noqa: PLC0415

    return robot_urdf_zip(robot)


ROBOT_FILES: Mapping[str, RobotFile] = {
    entry.file.ending: entry
    for entry in (
        RobotFile(
            FileType("json", "Document", "application/json"),
            document_of,
            "`hexapods robots import` stores it elsewhere",
        ),
        RobotFile(
            FileType("xml", "MJCF", "application/xml"),
            _mjcf,
            "its keyframe `home` has it standing",
        ),
        RobotFile(
            FileType("urdf", "URDF without meshes", "application/vnd.urdf+xml"),
            _urdf,
            "a zip has its meshes too",
        ),
        RobotFile(
            FileType("zip", "URDF with meshes", "application/zip"),
            _urdf_zip,
            "it has the URDF, with the meshes beside it",
        ),
    )
}
"""Types of file by their endings, the default first."""
