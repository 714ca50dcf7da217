"""Choose the document of an upload that describes the robot, and make it whole.

Included files and macros are put in their place, so that what follows reads one plain document.
"""

import posixpath
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.choices import MAX_FILE_NAME, Choices
from hexapods.imports.documents.expressions import Budget
from hexapods.imports.documents.includes import Includes
from hexapods.imports.documents.other_formats import other_document, other_format, other_zip
from hexapods.imports.documents.upload import DOCUMENTS, MAX_DOCUMENT_BYTES, Upload
from hexapods.imports.documents.xacro import XacroExpansion, is_xacro
from hexapods.imports.documents.xml import Element, read_xml
from hexapods.imports.notes import Notes, listed, quoted

_MAX_DOCUMENTS = 300
_MAX_DOCUMENTS_BYTES = 16 << 20
_MAX_ALL_ELEMENTS = 150_000
"""Elements of all documents of a zip among which the robot is looked for."""
_MAX_EXPANDED = 40
"""Documents with macros or includes that are tried."""
_ROOTS = ("mujoco", "robot")
_LEAST_JOINTS = 6
"""Hinges of the smallest robot."""


@dataclass(frozen=True)
class ChosenDocument:
    """The document that describes a robot.

    Attributes:
        path: of it in the upload.
        root: with all that it includes.
        documents: paths of all documents in a zip that could be the robot.
        arguments: values of the arguments of a xacro.
        missing: names of files that it needs and that are not in the upload.
    """

    path: str
    root: Element
    documents: tuple[str, ...]
    arguments: dict[str, str] = field(default_factory=dict)
    missing: tuple[str, ...] = ()

    def with_missing(self, problem: str) -> str:
        """Return a sentence about the document with the names of what is missing."""
        if not self.missing:
            return problem
        return f"{problem}; missing from the zip: {listed(self.missing)}"


@dataclass(frozen=True)
class _Robot:
    path: str
    root: Element
    files: frozenset[str]
    arguments: dict[str, str]
    missing: tuple[str, ...]
    joints: int
    is_expanded: bool

    @property
    def rank(self) -> tuple[bool | int | str, ...]:
        """Smallest of the robot that is meant: most joints, MJCF, servos, a pose, least of it."""
        tags = {element.tag for element in self.root}
        return (
            -self.joints,
            self.root.tag != "mujoco",
            self.is_expanded and self.root.tag != "mujoco",
            "actuator" not in tags,
            "keyframe" not in tags,
            bool(self.files),
            len(self.path),
            self.path,
        )


def choose_document(upload: Upload, choices: Choices, notes: Notes) -> ChosenDocument:
    """Return the document that describes the robot: the one with the most joints.

    Raises:
        DamagedFile: if there is none, or it cannot be read.
        InvalidInput: if a choice is not valid.
    """
    documents = _Documents(upload, choices.arguments or {}, notes)
    robots: Sequence[_Robot] = ()
    if not upload.is_zip:
        if sentence := other_format(upload.start, upload.name):
            raise DamagedFile(sentence)
        if choices.file not in (None, upload.name):
            raise InvalidInput(
                f"{quoted(upload.name)} is one document, and no zip that has "
                f"{quoted(choices.file)!r}"
            )
        robot = documents.robot(upload.name)
        robots = [robot]
    elif choices.file is not None:
        paths = upload.documents
        if choices.file not in paths:
            raise InvalidInput(f"the zip has no {quoted(choices.file)!r}; it has: {listed(paths)}")
        robot = documents.robot(choices.file)
        with suppress(DamagedFile):  # of the others
            robots = documents.robots(paths)
    else:
        robots = documents.robots(upload.documents)
        robot = robots[0]
    unknown = [name for name in choices.arguments or {} if name not in robot.arguments]
    if unknown:
        raise InvalidInput(
            f"{quoted(robot.path)} has no argument {quoted(unknown[0])!r}; it has: "
            f"{listed(robot.arguments) or 'none'}"
        )
    documents.tell(robot, robots, is_chosen=choices.file is not None)
    could_be = [other.path for other in robots if other.joints >= _LEAST_JOINTS]
    candidates = tuple(dict.fromkeys([robot.path, *could_be])) if upload.is_zip else ()
    return ChosenDocument(robot.path, robot.root, candidates, robot.arguments, robot.missing)


class _Documents:
    def __init__(self, upload: Upload, arguments: Mapping[str, str], notes: Notes) -> None:
        self._upload, self._arguments, self._notes = upload, arguments, notes
        self._roots: dict[str, Element] = {}
        self._repairs: dict[str, list[str]] = {}
        self._budget = Budget()
        self._includes = Includes(upload, self.parse, self._budget)

    def parse(self, path: str) -> Element:
        """Return the root of a document, which is parsed once.

        Raises:
            DamagedFile: if it cannot be parsed.
        """
        if path not in self._roots:
            repairs = self._repairs.setdefault(path, [])
            data = self._upload.read(path, MAX_DOCUMENT_BYTES)
            if sentence := other_format(data, path):
                raise DamagedFile(sentence)
            self._roots[path] = read_xml(data, path, repairs=repairs)
        return self._roots[path]

    def robot(self, path: str) -> _Robot:
        """Return the robot of a document, whole.

        Raises:
            DamagedFile: if it is none, or cannot be read.
        """
        root = self.parse(path)
        arguments, missing, files = dict[str, str](), tuple[str, ...](), frozenset[str]()
        children = {child.tag for child in root}
        if sentence := other_document(root.tag, children, path):
            raise DamagedFile(sentence)
        if root.tag not in _ROOTS:
            raise DamagedFile(
                f"{quoted(path)} begins with <{quoted(root.tag)}>; an MJCF file begins with "
                "<mujoco>, a URDF with <robot>"
            )
        is_expanded = is_xacro(root)
        if is_expanded:
            expanded = XacroExpansion(
                path, self._upload, self.parse, self._arguments, self._budget
            ).expanded()
            root, arguments = expanded.root, expanded.arguments
            missing, files = expanded.missing, expanded.files
        if root.tag == "mujoco":
            root, included = self._includes.followed(path, root)
            files |= included
        return _Robot(path, root, files, arguments, missing, _joints(root), is_expanded)

    def robots(self, paths: Sequence[str]) -> list[_Robot]:
        """Return the robots of a zip, the one that is most likely meant first.

        Raises:
            DamagedFile: if there is none, with the reason for the document nearest to the top.
        """
        plain, whole, damaged = self._sorted_out(paths)
        robots, problems = list[_Robot](), list[str]()
        for path in [*plain, *self._tops_first(whole)[:_MAX_EXPANDED]]:
            if path in self._part_of(robots):
                continue
            try:
                robots.append(self.robot(path))
            except DamagedFile as error:
                problems.append(str(error))
        best = sorted(robots, key=lambda robot: robot.rank)
        joints = best[0].joints if best else 0
        if joints < _LEAST_JOINTS and problems:
            raise DamagedFile(problems[0])
        if joints == 0 and damaged:
            raise DamagedFile(damaged[0])
        if not best:
            raise self._without_robot()
        return best

    def _sorted_out(self, paths: Sequence[str]) -> tuple[list[str], list[str], list[str]]:
        """Return plain documents, those with macros or includes, and why others are none."""
        plain, whole, damaged = list[str](), list[str](), list[str]()
        total, elements = 0, 0
        for path in sorted(paths, key=lambda path: (path.count("/"), len(path)))[:_MAX_DOCUMENTS]:
            total += self._upload.size(path)
            if total > _MAX_DOCUMENTS_BYTES or elements > _MAX_ALL_ELEMENTS:
                break
            try:
                root = self.parse(path)
            except DamagedFile as error:
                damaged.append(str(error))
                continue
            elements += sum(1 for _ in root.all())
            if root.tag in _ROOTS:
                is_plain = not is_xacro(root) and next(root.all("include"), None) is None
                (plain if is_plain else whole).append(path)
        return plain, whole, damaged

    def _part_of(self, robots: Sequence[_Robot]) -> set[str]:
        """Return the documents that are only a part of a robot with macros."""
        return {
            file
            for robot in robots
            if robot.is_expanded and robot.joints >= _LEAST_JOINTS
            for file in robot.files
        }

    def _tops_first(self, paths: Sequence[str]) -> list[str]:
        """Return documents, those first whose name no other one mentions as a file."""
        mentioned = {
            posixpath.basename(value)
            for path in paths
            for element in self.parse(path).all("include", "xacro:include")
            for value in element.attributes.values()
        }
        return sorted(paths, key=lambda path: posixpath.basename(path) in mentioned)

    def _without_robot(self) -> DamagedFile:
        sentence = other_zip(self._upload.name, self._upload.paths)
        return DamagedFile(
            sentence
            or f"the zip has no MJCF or URDF document ({', '.join(DOCUMENTS)}); it has: "
            f"{listed(self._upload.paths) or 'nothing'}"
        )

    def tell(self, robot: _Robot, robots: Sequence[_Robot], *, is_chosen: bool) -> None:
        """Add notes about the choice, and about what was repaired and is missing."""
        paths = [other.path for other in robots if other.joints or not robot.joints]
        others = [path for path in paths if path != robot.path]
        if others and not is_chosen:
            names = _short([robot.path, *others])
            self._notes.guess(
                "file",
                f"of the documents in the zip the robot is {quoted(names[0])}, not: "
                f"{listed(names[1:])}",
                offer=Choices(file=others[0]) if len(others[0]) <= MAX_FILE_NAME else None,
            )
        for path in [robot.path, *sorted(robot.files)]:
            for sentence in self._repairs.get(path, []):
                self._notes.repair("file", sentence)
        if robot.missing:
            self._notes.repair(
                "file",
                f"left out what is not in the zip, and what needs it: {listed(robot.missing)}",
            )


def _short(paths: Sequence[str]) -> list[str]:
    """Return the last parts of paths if they differ, else the paths."""
    names = [posixpath.basename(path) for path in paths]
    return names if len({*names}) == len(names) else [*paths]


def _joints(root: Element) -> int:
    """Return the number of joints that move, as far as the document tells without being read."""
    if root.tag == "robot":
        kinds = ("revolute", "continuous")
        return sum(1 for joint in root.all("joint") if joint.attributes.get("type") in kinds)
    bodies = [child for child in root if child.tag == "worldbody"]
    return sum(1 for body in bodies for _ in body.all("joint"))
