"""Reads a robot from a file: the steps in a row, as they run in the child process."""

import posixpath
import re
from contextlib import suppress
from dataclasses import replace

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.text import MAX_NAME, visible
from hexapods.imports.building import FileOrigin, build
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import Compiled, compile_document
from hexapods.imports.documents.robot_document import ChosenDocument, choose_document
from hexapods.imports.documents.upload import Upload, last_part
from hexapods.imports.documents.xml import Element, write_xml
from hexapods.imports.exported_settings import ExportedSettings, read_exported_settings
from hexapods.imports.imported import ImportedRobot, RobotReading
from hexapods.imports.meshes.mesh_files import MeshFiles
from hexapods.imports.mjcf import clean_mjcf
from hexapods.imports.notes import Notes, listed
from hexapods.imports.sketch import sketch_robot
from hexapods.imports.urdf import clean_urdf

_HOME_FOLDER = re.compile(r"(?:[a-zA-Z]:)?[/\\]+(?:home|users)[/\\]+[^/\\]*[/\\]*", re.IGNORECASE)
_NO_NAMES = ("mujoco model", "robot", "scene")


def read_in_this_process(data: bytes, file_name: str, choices: Choices) -> RobotReading:
    """Read a robot without limits of time and memory: only for a process that has them.

    Raises:
        InvalidInput: naming what is wrong with the file, if it cannot even be drawn.
    """
    notes = Notes()
    upload = Upload(data, file_name)
    if upload.outside:
        notes.repair(
            "file",
            f"left out what has a path that leads out of the zip: {listed(upload.outside)}",
        )
    document = choose_document(upload, choices, notes)
    try:
        reading = _read(document, upload, choices, notes)
    except InvalidInput as error:
        raise type(error)(document.with_missing(str(error))) from error
    problem = None if reading.problem is None else document.with_missing(reading.problem)
    return replace(
        reading,
        problem=problem,
        document=document.path if upload.is_zip else None,
        documents=document.documents,
        arguments=document.arguments,
    )


def _read(document: ChosenDocument, upload: Upload, choices: Choices, notes: Notes) -> RobotReading:
    path, root = document.path, document.root
    meshes = MeshFiles(upload, path, notes)
    settings = read_exported_settings(root)
    if root.tag == "mujoco":
        clean_mjcf(root, meshes, notes)
    else:
        clean_urdf(root, meshes, notes)
    compiled = _compiled(root, meshes, notes, choices.scale)
    meshes.tell(compiled.undrawn)
    named = root.attributes.get("model" if root.tag == "mujoco" else "name", "")
    file_format = "mjcf" if root.tag == "mujoco" else "urdf"
    origin = FileOrigin(_name(named, path), file_format, path if upload.is_zip else None)  # type: ignore[arg-type]
    robot, problem = None, None
    if settings is not None and choices.scale is None and choices.up is None:
        # They may not fit a file that was changed since.
        with suppress(InvalidInput):
            robot = _exported(compiled, origin, choices, notes.copy(), settings)
    try:
        robot = robot or build(compiled, origin, choices, notes)
    except InvalidInput as error:
        problem = meshes.with_missing(str(error))
    notes_of_robot = notes.collected() if robot is None else robot.notes
    return RobotReading(robot, problem, notes_of_robot, sketch_robot(compiled, robot))


def _exported(
    compiled: Compiled,
    origin: FileOrigin,
    choices: Choices,
    notes: Notes,
    settings: ExportedSettings,
) -> ImportedRobot:
    """Return the robot of a file that was exported here.

    Raises:
        InvalidInput: if its settings, or the choices of a person, do not fit it.
    """
    notes.guess("file", "it was exported here: its gait, stance, servos and times are in the file")
    robot = build(compiled, origin, settings.fill(choices), notes, settings.pose(choices))
    return settings.apply(robot, choices)


def _compiled(root: Element, meshes: MeshFiles, notes: Notes, scale: float | None) -> Compiled:
    """Compile a cleaned document, with simpler meshes if the memory is not enough."""
    document = write_xml(root)
    try:
        try:
            return compile_document(document, meshes, notes, scale)
        except MemoryError:
            if not meshes.simplify():
                raise
        return compile_document(document, meshes, notes, scale)
    except DamagedFile as error:
        raise DamagedFile(meshes.with_missing(str(error))) from error


def _name(named: str, path: str) -> str:
    """Return the name that a file gives its robot, or its own without ending.

    Of a path it is the last part; the name of a person's home folder is none.
    """
    stem = posixpath.splitext(posixpath.basename(path))[0]
    title = "" if _HOME_FOLDER.fullmatch(named.strip()) else last_part(named)
    for text in (title, stem):
        shown = " ".join(visible(text).split())[:MAX_NAME].strip()
        if shown and shown.lower() not in _NO_NAMES:
            return shown
    return "robot"
