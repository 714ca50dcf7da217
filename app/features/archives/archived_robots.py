"""Documents of stored robots in the archives of runs that use them."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from app.storage.database.store import RunStore
from app.storage.run import Run, robots_of
from app.storage.run_kind import WALKS
from app.storage.stored_robot import StoredRobot
from hexapods.domain import robot_documents
from hexapods.domain.errors import DamagedFile, HexapodError
from hexapods.domain.robot import parse_document
from hexapods.domain.text import check_name
from hexapods.runs.results import RaceResult

_MEMBER = re.compile(rf"robot-([0-9a-f]{{{robot_documents.ID_DIGITS}}})\.json", re.ASCII)


def is_robot(name: str) -> bool:
    """Whether a member of an archive has the name of a robot's document."""
    return _MEMBER.fullmatch(name) is not None


def robot_members(store: RunStore, run: Run) -> dict[str, bytes]:
    """Return the documents of the stored robots that a run uses, by the names of their members.

    Raises:
        NotFound, DamagedFile: if one is not there, or damaged.
    """
    return {f"robot-{robot_id}.json": store.robots.document(robot_id) for robot_id in _names(run)}


def take_documents(members: dict[str, bytes], label: str) -> dict[str, bytes]:
    """Remove the documents of robots from the members of an archive, and return them by id.

    Raises:
        DamagedFile: if one is damaged, or of another robot than its name says.
    """
    documents = {}
    for name in [name for name in members if is_robot(name)]:
        document = members.pop(name)
        try:
            parse_document(document)
        except HexapodError as error:
            raise DamagedFile(f"{name} of {label} cannot be taken in: {error}") from error
        robot_id = robot_documents.id_of(document)
        if name != f"robot-{robot_id}.json":
            raise DamagedFile(f"{label} is damaged: {name} is the document of another robot")
        documents[robot_id] = document
    return documents


def robots_to_store(
    run: Run, documents: Mapping[str, bytes], label: str
) -> list[tuple[StoredRobot, bytes]]:
    """Return the stored robots that an imported run uses, each with its document.

    Raises:
        DamagedFile: if a document is of a robot that the run does not use.
    """
    names = _names(run)
    if unused := [robot_id for robot_id in documents if robot_id not in names]:
        raise DamagedFile(f"{label} has robot {unused[0]}, which its run does not use")
    gait = run.config.gait if run.kind in WALKS else None
    return [
        (StoredRobot(id=robot_id, name=check_name(names[robot_id]), gait=gait), document)
        for robot_id, document in documents.items()
    ]


def _names(run: Run) -> dict[str, str]:
    """Return the names of the stored robots that a run uses, by id."""
    return {robot["id"]: robot["name"] for robot in _used(run) if "id" in robot}


def _used(run: Run) -> Iterator[Mapping[str, Any]]:
    for robot in robots_of(run.config):
        if robot.id is not None:
            yield {"id": robot.id, "name": robot.name.removesuffix(" (modified)")}
    if isinstance(run.result, RaceResult):
        for lane in run.result.lanes:
            if lane.trained_robot is not None:
                yield {"name": f"robot {str(lane.trained_robot.get('id'))[:6]}"} | {
                    **lane.trained_robot
                }
