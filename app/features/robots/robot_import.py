"""Import of a robot: a body, the document of a robot, or a robot's file."""

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from app.features.robots.readings import KeptFile, RobotReadings, is_model_file
from app.features.robots.response_models import FoundView
from app.storage.database.robots import RobotOrigin
from app.storage.database.store import RunStore
from app.storage.errors import Busy
from app.storage.stored_robot import StoredRobot, distinct_name
from hexapods.domain import robot_documents
from hexapods.domain.creatures import own_gait
from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.domain.gait import GaitSpec, gait_spec, read_gait, resolve
from hexapods.domain.json_lists import check_lists
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.records import from_json, to_json, to_json_bytes
from hexapods.domain.robot import Robot, document_of, parse_document, robot
from hexapods.domain.support import STANDS_M, Support
from hexapods.domain.text import MAX_NAME, check_name, visible
from hexapods.imports.child import NotRead, read_robot_file
from hexapods.imports.choices import AS_FOUND, Choices
from hexapods.imports.documents.upload import last_part
from hexapods.imports.imported import ImportedRobot
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import preview

_BODY_MEMBERS, _READING_MEMBERS = ("robot", "gait", "name"), ("reading", "choices", "name")
"""Members of the JSON objects by which a body is stored, and a robot that was read."""
_UNNAMED = "Robot"
_RETRY_S = 5
_TOLD = (
    'send {"robot": …}, with a robot as in any request; the document of a robot as '
    "`GET /robots/{id}/file` and `hexapods robots export` give it; or MJCF, URDF or xacro, alone "
    "or in a zip with its meshes"
)
_NAMED = ("tripod", "tetrapod", "trot")
"""Gaits that are tried for a robot of which none is known, with their few groups."""
_FALLBACK = "one-by-one"


def import_robot(
    store: RunStore,
    data: bytes,
    name: str | None = None,
    file: str | None = None,
    readings: RobotReadings | None = None,
) -> tuple[StoredRobot, bool]:
    """Store a robot, unless it is stored already.

    Args:
        store: receives it.
        data: `{"robot": …, "gait": …, "name": …}`, of which gait and name may be missing; the
            document of a robot; `{"reading": id, "choices": …, "name": …}`; or MJCF, URDF
            or xacro, alone or in a zip.
        name: its name; by default what the data say, or `Robot`, made distinct.
        file: name of the file.
        readings: files that were looked at, where there are any.

    Returns:
        the robot as stored, and whether it is new.

    Raises:
        InvalidInput: if it is no robot, or one that cannot stand or reach its feet's homes.
        DamagedFile: if its document was changed, or the file is damaged.
        Busy: if no process can read the file at present.
        Conflict: if another robot has its name.
        StorageFull: if there are too many, or too little disk space.
    """
    if not data:
        raise InvalidInput(f"the body is empty: {_TOLD}")
    store.check_disk_space(len(data))
    if is_model_file(data):
        return import_reading(store, _read(data, file), KeptFile(file or "", data), name)
    content = _json(data)
    if "reading" in content and readings is not None:
        return _store_reading(store, readings, content, name)
    if "format" in content:
        body, document = parse_document(data), data
        content = {}
    else:
        body = robot(_member(content, "robot"))
        document = document_of(body)
        parse_document(document)  # which refuses numbers out of their limits
    gait = _gait_of(content, body)
    check_stands(body, gait)
    about = StoredRobot(
        id=robot_documents.id_of(document),
        name=_named(store, name if name is not None else content.get("name")),
        gait=gait,
    )
    return store.robots.add(document, about)


def read_body(data: bytes) -> tuple[Robot, str | GaitSpec]:
    """Return the body of `{"robot": …, "gait": …}`, and its gait, by default one that suits it.

    Raises:
        InvalidInput: if it is none.
    """
    if not data:
        raise InvalidInput(f"the body is empty: {_TOLD}")
    content = _json(data)
    body = robot(_member(content, "robot"))
    return body, _gait_of(content, body)


def _gait_of(content: Mapping[str, Any], body: Robot) -> str | GaitSpec:
    gait = content.get("gait")
    return suiting_gait(body) if gait is None else read_gait(gait)


def _store_reading(
    store: RunStore, readings: RobotReadings, content: Mapping[str, Any], name: str | None
) -> tuple[StoredRobot, bool]:
    reading_id = content["reading"]
    if not isinstance(reading_id, str):
        raise InvalidInput("`reading` is the id of a reading, a text")
    choices = AS_FOUND
    if content.get("choices") is not None:
        try:
            choices = from_json(Choices, content["choices"])
        except ValueError as error:
            raise InvalidInput(f"`choices` are an object, as a reading has it: {error}") from None
    kept = readings.file(reading_id)
    imported = readings.read(reading_id, choices).valid_robot()
    given_name = name if name is not None else content.get("name")
    return import_reading(store, imported, kept, given_name, choices)


def stored_file(store: RunStore, robot_id: str) -> tuple[StoredRobot, bytes]:
    """Return a stored robot with the file that it was read from.

    Raises:
        NotFound: if there is no such robot.
        InvalidInput: if it is from no file.
    """
    stored, origin = store.robots.get(robot_id), store.robots.origin(robot_id)
    if origin is None:
        raise InvalidInput(f"{stored.name} is from no file here: there is nothing to read again")
    return stored, origin.upload


def import_reading(
    store: RunStore,
    imported: ImportedRobot,
    kept: KeptFile,
    name: str | None = None,
    choices: Choices = AS_FOUND,
) -> tuple[StoredRobot, bool]:
    """Store a robot that was read from a file; name, result and errors as of `import_robot`.

    Args:
        store: receives it.
        imported: the robot.
        kept: the file.
        name: its name; by default the file's.
        choices: choices by which it was read.
    """
    store.check_disk_space(len(kept.data))
    about, document = _of_file(imported, choices, kept.name or None)
    chosen_name = (
        name if name is not None else _distinct(store, check_name(imported.name[:MAX_NAME]))
    )
    about = replace(about, name=_named(store, chosen_name or None))
    return store.robots.add(document, about, RobotOrigin(kept.data, _description(imported)))


def correct_robot(store: RunStore, robot_id: str, choices: Choices) -> StoredRobot:
    """Read the file of a stored robot again, as a person decided; return the robot that it is now.

    It has another id unless nothing has changed. The one before is deleted, or hidden if runs use
    it.

    Raises:
        NotFound: if there is no such robot.
        InvalidInput: if it is from no file, or a choice is not valid.
        Busy: if no process can read the file at present.
        StorageFull: if there is too little disk space.
    """
    stored, upload = stored_file(store, robot_id)
    store.check_disk_space(len(upload))
    imported = _read(upload, stored.file, choices)
    about, document = _of_file(imported, choices, stored.file)
    return store.robots.replace(
        robot_id, document, about, RobotOrigin(upload, _description(imported))
    )


def _read(data: bytes, file: str | None, choices: Choices = AS_FOUND) -> ImportedRobot:
    try:
        return read_robot_file(data, file, choices)
    except NotRead as error:
        raise Busy(str(error), _RETRY_S) from error


def _of_file(
    imported: ImportedRobot, choices: Choices, file: str | None
) -> tuple[StoredRobot, bytes]:
    """Return a robot from a file, under a name that is to be replaced, with its document."""
    document = document_of(imported.robot(_UNNAMED))
    about = StoredRobot(
        id=robot_documents.id_of(document),
        name=_UNNAMED,
        gait=imported.gait,
        guesses=imported.guesses,
        repairs=imported.repairs,
        choices=None if choices == AS_FOUND else to_json(choices),
        file=visible(last_part(file or f"{imported.name}.{imported.file_format}"))[:MAX_NAME],
    )
    return about, document


def _description(imported: ImportedRobot) -> bytes:
    description = FoundView(
        file_format=imported.file_format,
        file=imported.file,
        legs=list(imported.legs),
        feet=list(imported.feet),
        keyframes=list(imported.keyframes),
        forward_deg=imported.forward_deg,
        reaches_grid=imported.reaches_grid,
    )
    return to_json_bytes(description)


def _distinct(store: RunStore, name: str) -> str:
    taken = [robot.name for robot in store.robots.stored(hidden=True)]
    return distinct_name(name or _UNNAMED, taken)


def suiting_gait(robot: Robot) -> str | GaitSpec:
    """Return its preset's gait, a named one with which it stands, or the fewest groups that do."""
    if (gait_of_preset := own_gait(robot)) != _FALLBACK:
        return gait_of_preset
    for name in _NAMED:
        with suppress(InvalidInput):  # it does not divide these legs
            gait = resolve(name, robot.azimuths_deg)
            if Support(robot, gait).least_margin_m(gait.groups) >= STANDS_M:
                return name
    spec = gait_spec(_FALLBACK)
    groups = Support(robot, resolve(spec, robot.azimuths_deg)).steadiest_groups()
    return GaitSpec(spec.right_leg, spec.left_leg, groups=groups)


def check_stands(robot: Robot, gait: str | GaitSpec) -> None:
    """Check that a robot stands, and that its legs reach some foot grid.

    Raises:
        InvalidInput: if they do not, naming a leg, or the gait does not divide its legs.
    """
    if isinstance(robot, ModelRobot):
        resolve(gait, robot.azimuths_deg)
        return  # how it stands is corrected after it is stored
    previewed = preview(WalkingProblem(gait=gait, robot=robot))
    if previewed.largest_side_m is None:
        raise InvalidInput(f"it cannot walk on any foot grid: {previewed.out_of_reach}")
    if not previewed.stands:
        raise InvalidInput(
            "it does not stand even on all of its feet, since its centre of mass is not above "
            "them; move a leg's foot"
        )


def _named(store: RunStore, wanted: Any) -> str:
    if wanted is None:
        return _distinct(store, _UNNAMED)
    if not isinstance(wanted, str) or not (name := check_name(wanted)):
        raise InvalidInput("a robot has a name with a visible character")
    return name


def _json(data: bytes) -> dict[str, Any]:
    if len(data) > robot_documents.MAX_BYTES:
        raise InvalidInput(f"a robot has at most {robot_documents.MAX_BYTES:,} bytes; {_TOLD}")
    try:
        check_lists(data)
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"it is no JSON that can be read: {_TOLD}") from error
    if not isinstance(content, Mapping):
        raise InvalidInput(f"it is no JSON object: {_TOLD}")
    members = _READING_MEMBERS if "reading" in content else _BODY_MEMBERS
    unknown = [member for member in content if member not in members]
    if "format" not in content and unknown:
        if len(unknown) == len(content):
            raise InvalidInput(
                f"it is JSON of another program, with {unknown[0][:100]!r}: {_TOLD}; or enter its "
                "lengths in the editor of bodies"
            )
        raise InvalidInput(f"unknown member {unknown[0][:100]!r}: {_TOLD}")
    return dict(content)


def _member(content: Mapping[str, Any], name: str) -> Any:
    if name not in content:
        raise DamagedFile(f"it has no {name}")
    return content[name]
