"""Routes of stored robots."""

from typing import Annotated, Any, Literal

from fastapi import Path, Query, Request
from pydantic import ConfigDict, Field
from starlette.convertors import StringConvertor, register_url_convertor
from starlette.responses import Response

from app.api.answers import DeletedView
from app.api.contract import ATTACHMENT, BINARY, LOCATION, answers
from app.api.deps import BodyDep, Services, ServicesDep
from app.api.fields import Body, Name
from app.api.formats import attachment, negotiated
from app.api.policy import OPERATOR, WATCH, api_router, policy
from app.api.record_response import RecordResponse
from app.api.schemas import PatchBody, one_given
from app.api.work import ANALYSIS, ENCODING, Slots, Work
from app.features.robots.reading_view import RobotReadingView, body_view, reading_view
from app.features.robots.readings import RobotReadings, is_model_file
from app.features.robots.response_models import (
    StoredRobotsView,
    StoredRobotView,
    WholeRobotView,
    robot_view,
    whole_view,
)
from app.features.robots.robot_import import (
    check_stands,
    correct_robot,
    import_robot,
    read_body,
    stored_file,
)
from hexapods.domain import robot_documents
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import AnyGait
from hexapods.domain.records import from_json
from hexapods.domain.robot import AnyRobot
from hexapods.exports.robot_files import ROBOT_FILES
from hexapods.imports.choices import AS_FOUND, Choices

FILE_TYPES = ("application/xml", "application/zip", "application/octet-stream")
router = api_router(prefix="/robots", tags=["robots"])


class _RobotId(StringConvertor):
    """Matches ids in paths, and nothing that another route has in their place."""

    regex = f"[0-9a-f]{{{robot_documents.ID_DIGITS}}}"


register_url_convertor("robot", _RobotId())
RobotPath = Annotated[str, Path(description="id of a stored robot")]


class RobotBody(Body):
    """A robot that is to be stored; its gait is one that suits it by default."""

    robot: AnyRobot
    gait: AnyGait | None = None
    name: Name | None = None


class ReadRobotBody(Body):
    """A robot that was read from a file, by the id of the reading."""

    reading: Annotated[str, Field(max_length=64)]
    choices: Choices = AS_FOUND
    name: Name | None = None


class RobotChangeBody(PatchBody):
    """Changes of the name, visibility, gait or import choices of a stored robot."""

    model_config = ConfigDict(json_schema_extra=one_given(("name", "hidden", "gait", "choices")))

    name: Name | None = None
    hidden: Annotated[bool, Field(strict=True)] | None = None
    gait: AnyGait | None = None
    choices: Choices | None = None

    def changes(self) -> dict[str, Any]:
        """Return the fields that the request has, by name."""
        values = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in values.items() if value is not None}


def _described(body: type[Body]) -> dict[str, Any]:
    """Return the schema of a body, which refers to records that the document describes."""
    # FastAPI names so what requests have of a record that answers have in another form.
    schema = body.model_json_schema(ref_template="#/components/schemas/{model}-Input")
    schema.pop("$defs", None)
    return schema


READING = Work(name="reading", spectators=Slots(1, 1), operators=Slots(2, 2))
"""Robots' files that are read before they are stored, again after each correction."""


class ReadingBody(Body):
    """A body that is to be looked at as a robot's file is."""

    robot: AnyRobot
    gait: AnyGait | None = None


class ChoicesBody(Body):
    """Decisions of a person about a file."""

    choices: Choices = AS_FOUND


@router.post(
    "/readings",
    summary="Look at a robot before it is stored",
    openapi_extra={
        "requestBody": {
            "content": {
                "application/json": {"schema": _described(ReadingBody)},
                **{kind: {"schema": BINARY} for kind in FILE_TYPES},
            },
            "required": True,
        }
    },
)
@policy(access=OPERATOR, work=READING, takes_file=True)
def read_robot_file(
    services: ServicesDep,
    body: BodyDep,
    file: Annotated[Name | None, Query(description="name of the file")] = None,
) -> RecordResponse[RobotReadingView]:
    """Read a robot's file, or a body, and return what is in it, with a picture; store nothing.

    The file is kept for a while under the `id` of the answer: it is read again as a person decides
    by `POST /robots/readings/{reading_id}`, and stored by `POST /robots` with `{"reading": id}`.
    """
    if is_model_file(body):
        return _reading_of(services, services.of(RobotReadings).keep(body, file or None), AS_FOUND)
    robot, gait = read_body(body)
    return RecordResponse(body_view(robot, gait))


@router.post("/readings/{reading_id}", summary="Read a robot's file as a person decides")
@policy(access=OPERATOR, work=READING)
def read_robot_again(
    services: ServicesDep,
    reading_id: Annotated[str, Path(max_length=64, description="id of a reading")],
    body: ChoicesBody,
) -> RecordResponse[RobotReadingView]:
    """Read a file again that was read lately. After a while it is forgotten, and sent again."""
    return _reading_of(services, reading_id, body.choices)


@router.post("/{robot_id:robot}/reading", summary="Look at the file of a stored robot")
@policy(access=OPERATOR, work=READING)
def read_stored_robot(
    services: ServicesDep, robot_id: RobotPath
) -> RecordResponse[RobotReadingView]:
    """Read the file of a stored robot by its choices, as `POST /robots/readings` does."""
    stored, upload = stored_file(services.store, robot_id)
    choices = AS_FOUND if stored.choices is None else from_json(Choices, stored.choices)
    return _reading_of(services, services.of(RobotReadings).keep(upload, stored.file), choices)


def _reading_of(
    services: Services, reading_id: str, choices: Choices
) -> RecordResponse[RobotReadingView]:
    readings = services.of(RobotReadings)
    name = readings.file(reading_id).name
    view = reading_view(readings.read(reading_id, choices), choices, reading_id, name)
    return RecordResponse(view)


@router.post(
    "",
    status_code=201,
    summary="Store a robot",
    responses=answers(201, headers=LOCATION) | {200: {"model": StoredRobotView}},
    openapi_extra={
        "requestBody": {
            "content": {
                "application/json": {
                    "schema": {
                        "anyOf": [
                            _described(RobotBody),
                            _described(ReadRobotBody),
                        ]
                    }
                },
                **{kind: {"schema": BINARY} for kind in FILE_TYPES},
            },
            "required": True,
        }
    },
)
@policy(access=OPERATOR, work=ENCODING, takes_file=True)
def store_robot(
    services: ServicesDep,
    request: Request,
    body: BodyDep,
    name: Annotated[Name | None, Query()] = None,
    file: Annotated[Name | None, Query(description="name of the file")] = None,
) -> RecordResponse[StoredRobotView]:
    """Store a body, `{"robot": …}`, a robot that was read, `{"reading": …}`, a document, or a file.

    A file is MJCF or URDF, alone or in a zip with its meshes. The answer tells what was guessed
    and repaired; `PATCH /robots/{id}` corrects it. The id is that of its content: the same robot is
    stored once, with the name that it was given first, and answered with 200.
    """
    stored, is_new = import_robot(
        services.store, body, name, file or None, readings=services.of(RobotReadings)
    )
    services.publish_robots()
    location = request.url_for("get_robot", robot_id=stored.id).path
    status = 201 if is_new else 200
    return RecordResponse(robot_view(stored), status, {"Location": location})


@router.get("", summary="List stored robots")
@policy(access=WATCH)
def list_robots(
    services: ServicesDep,
    hidden: Annotated[bool, Query(description="true, to list hidden ones too")] = False,
) -> RecordResponse[StoredRobotsView]:
    """List the robots that people have stored; `GET /options` lists those that are built in too."""
    robots = services.store.robots.readable(hidden=hidden)
    return RecordResponse(StoredRobotsView(items=[robot_view(robot) for robot in robots]))


@router.get("/{robot_id:robot}", summary="Get a stored robot")
@policy(access=WATCH, work=ANALYSIS, depends_on_state=False)
def get_robot(services: ServicesDep, robot_id: RobotPath) -> RecordResponse[WholeRobotView]:
    """Return a stored robot with all its numbers, and a preview of its walk."""
    robots = services.store.robots
    return RecordResponse(whole_view(robots.get(robot_id), robots.origin(robot_id)))


@router.patch(
    "/{robot_id:robot}",
    summary="Rename or hide a stored robot, give it another gait, or correct it",
)
@policy(access=OPERATOR, work=ENCODING)
def change_robot(
    services: ServicesDep, robot_id: RobotPath, body: RobotChangeBody
) -> RecordResponse[StoredRobotView]:
    """Change the name, visibility or gait of a robot, or the choices by which its file is read.

    With `choices` the file is read again: the answer has the new robot's id. The one before is
    deleted, or hidden where runs use it. Without, the robot keeps its id.
    """
    changes, robots = body.changes(), services.store.robots
    choices = changes.pop("choices", None)
    if changes.get("name") == "":
        raise InvalidInput("a robot has a name with a visible character")
    if "gait" in changes:
        check_stands(robots.get(robot_id).robot, changes["gait"])
    if choices is not None:
        robot_id = correct_robot(services.store, robot_id, choices).id
    changed = robots.change(robot_id, **changes) if changes else robots.get(robot_id)
    services.publish_robots()
    return RecordResponse(robot_view(changed))


@router.delete("/{robot_id:robot}", summary="Delete a stored robot", name="delete_robot")
@policy(access=OPERATOR)
def delete_robot(services: ServicesDep, robot_id: RobotPath) -> RecordResponse[DeletedView]:
    """Delete a robot that no run uses; one that runs use can be hidden.

    It can be restored for an hour, unless the disk is full; its name is free at once.
    """
    until = services.store.robots.delete(robot_id)
    services.publish_robots()
    return RecordResponse(DeletedView(deleted=[robot_id], kept=[], restorable_until=until))


@router.post("/{robot_id:robot}/restore", summary="Restore a stored robot that was deleted")
@policy(access=OPERATOR)
def restore_robot(services: ServicesDep, robot_id: RobotPath) -> RecordResponse[StoredRobotView]:
    """Bring back a robot that was deleted within the last hour; one that is there stays.

    409 is the answer while another robot has its name.
    """
    restored = services.store.robots.restore(robot_id)
    services.publish_robots()
    return RecordResponse(robot_view(restored))


@router.get(
    "/{robot_id:robot}/file",
    summary="Download a stored robot",
    response_class=Response,
    responses=answers(
        200,
        {
            kind.file.media_type: {"type": "object"} if kind.file.ending == "json" else BINARY
            for kind in ROBOT_FILES.values()
        },
        headers=ATTACHMENT,
    ),
)
@policy(access=WATCH, work=ANALYSIS)
def get_robot_file(
    services: ServicesDep,
    request: Request,
    robot_id: RobotPath,
    file_format: Annotated[
        Literal["json", "xml", "urdf", "zip"] | None,
        Query(alias="format", description="json: its document; xml: MJCF; zip: URDF with meshes"),
    ] = None,
) -> Response:
    """Return a robot's document, or the robot as MJCF or URDF.

    `POST /robots` or `hexapods robots import` can store each of them: as the same robot.
    """
    types = {kind.file.media_type: ending for ending, kind in ROBOT_FILES.items()}
    ending = negotiated(request, file_format, [*ROBOT_FILES], types)
    kind = ROBOT_FILES[ending]
    robots = services.store.robots
    if ending == "json":
        content = robots.document(robot_id)
    else:
        content = kind.write(robots.get(robot_id).robot)
    return attachment(content, kind.file.media_type, f"robot-{robot_id}.{ending}")
