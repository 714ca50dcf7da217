"""Routes of cards on which a class teaches a robot by presses of + and −."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from app.answer import Answer, Count
from app.api.contract import answers
from app.api.deps import ServicesDep
from app.api.descriptions import VALID
from app.api.fields import Body, number
from app.api.policy import OPERATOR, api_router, policy
from app.api.record_response import RecordResponse
from app.features.classroom.access import WATCH_ROOM, CodePath, ReaderDep, participant
from app.features.classroom.participant_routes import SeatDep
from app.features.classroom.teaching import Teaching, TeachingView

MAX_RUN_S = 1e6

VALID.update(
    {
        "run_id": "the id of a run",
        "at_s": "the time of the run in the picture when it was pressed, in seconds",
    }
)

router = api_router(prefix="/rooms", tags=["rooms"])


def _sign(value: Any) -> int:
    """Return a press; of `Literal[1, -1]` alone true and 1.0 would be 1, too."""
    if type(value) is not int or value not in (1, -1):
        context = {"name": "value", "valid": "the integer 1 or -1"}
        raise PydanticCustomError("setting", "must be {valid}", context)
    return value


class PressBody(Body):
    """A press of + (1) or − (-1): for which robot, and at which moment of its picture."""

    run_id: Annotated[str, Field(max_length=64)]
    at_s: Annotated[float, number(ge=0, le=MAX_RUN_S)]
    value: Annotated[Literal[1, -1], BeforeValidator(_sign)]


class PressView(Answer):
    """A press that counts, and the step that it is about, from 0."""

    step: Count
    value: Literal[1, -1]


@router.get("/{code}/teaching", summary="Get how a class teaches a robot")
@policy(access=WATCH_ROOM)
def get_teaching(
    services: ServicesDep, code: CodePath, reader: ReaderDep
) -> RecordResponse[TeachingView]:
    """Return the robots and the presses of the card that is shown."""
    return RecordResponse(services.of(Teaching).view(code, is_teacher=reader is None))


@router.post(
    "/{code}/teaching",
    status_code=202,
    summary="Let the class teach",
    responses=answers(202),
)
@policy(access=OPERATOR, starts=True)
def start_teaching(services: ServicesDep, code: CodePath) -> RecordResponse[TeachingView]:
    """Start the robot that the class teaches on the card that is shown, and the one beside it.

    The robot walks on the stage of the room, as slowly as the card says.
    """
    teaching = services.of(Teaching)
    room = teaching.start(code)
    return RecordResponse(teaching.view(room.code, is_teacher=True), 202)


@router.delete("/{code}/teaching", summary="End the teaching of a class")
@policy(access=OPERATOR)
def stop_teaching(services: ServicesDep, code: CodePath) -> RecordResponse[TeachingView]:
    """Stop the robot that the class teaches; what it has learned stays."""
    teaching = services.of(Teaching)
    room = teaching.stop(code)
    return RecordResponse(teaching.view(room.code, is_teacher=True))


@router.post("/{code}/presses", status_code=201, summary="Press + or −", responses=answers(201))
@policy(access=participant("press"))
def add_press(
    services: ServicesDep, code: CodePath, seed: SeatDep, body: PressBody
) -> RecordResponse[PressView]:
    """Tell a robot that what it does in the picture is good (1) or bad (-1).

    Each participant counts once for a step of the robot, with the last press; the step is taught
    with the mean over those who pressed. A press for a step that is over is refused, as is one for
    another robot, and more than a few a second.
    """
    step = services.of(Teaching).press(code, seed, body.run_id, body.at_s, body.value)
    return RecordResponse(PressView(step=step, value=body.value), 201)
