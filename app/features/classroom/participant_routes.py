"""Routes of participants: they join a room by its code, answer, start what its card runs, leave."""

from typing import Annotated

from fastapi import Depends, Path, Request
from starlette.responses import Response

from app.api.answers import ComparisonView
from app.api.contract import LOCATION, TEXT, Schema, answers
from app.api.cookies import SessionCookie, cookie_rules
from app.api.deps import IdempotencyKeyHeader, Services, ServicesDep
from app.api.identity import charged_client
from app.api.policy import api_router, policy
from app.api.record_response import RecordResponse
from app.api.run_views import AnyRunView
from app.api.runs import located
from app.features.classroom.access import (
    JOIN,
    CodePath,
    ReaderDep,
    participant,
    room_cookie,
    work_of_card,
)
from app.features.classroom.card_starts import CardStarts
from app.features.classroom.names import normalized
from app.features.classroom.request_bodies import JoinBody, PredictionBody, RunBody
from app.features.classroom.response_models import JoinedView, PredictionView
from app.features.classroom.room import Room
from app.features.classroom.rooms import Rooms
from app.features.classroom.what_ifs import WhatIfs
from app.storage.errors import Forbidden
from hexapods.domain.errors import InvalidInput
from hexapods.domain.text import MAX_NAME, check_name

RunPath = Annotated[str, Path(description="id of a run of the room", max_length=64)]
MIN_JOIN_KEY = 16
"""Minimum length of the Idempotency-Key of a request to join, which is a secret."""
_SETS_COOKIE: Schema = {"Set-Cookie": {"required": True, "schema": TEXT}}

router = api_router(prefix="/rooms", tags=["rooms"])


def _seat(services: ServicesDep, code: CodePath, reader: ReaderDep) -> int:
    """Return the seed of the participant who asks, in the room of the path.

    Raises:
        Forbidden: if the client is no participant of this room.
    """
    room = services.of(Rooms).get(code)
    seed = dict(reader or ()).get(room.code)
    if seed is None:
        raise Forbidden(
            f"this is for participants of the room {room.code}; join it first with "
            f"POST /api/v1/rooms/{room.code}/participants"
        )
    return seed


SeatDep = Annotated[int, Depends(_seat)]
"""Seed of the participant who asks."""


@router.post(
    "/{code}/participants",
    status_code=201,
    summary="Join a room",
    responses={
        **answers(201, headers=_SETS_COOKIE),
        200: {"model": JoinedView, "description": "who is in the room already"},
    },
)
@policy(access=JOIN)
def join_room(
    services: ServicesDep,
    request: Request,
    code: CodePath,
    body: JoinBody | None = None,
    idempotency_key: IdempotencyKeyHeader = None,
) -> RecordResponse[JoinedView]:
    """Join by the code, with neither account nor data: the name is from a list of words.

    A cookie keeps name and seed; who has it gets both again, with 200, as does who repeats the
    request with the same Idempotency-Key, since the answer was lost on the way.
    """
    del body
    if idempotency_key is not None and len(idempotency_key) < MIN_JOIN_KEY:
        raise InvalidInput(
            f"the Idempotency-Key must have at least {MIN_JOIN_KEY} characters here: who has it "
            "is the participant"
        )
    rooms, cookie = services.of(Rooms), _cookie(services, request, code)
    joined = rooms.join(code, cookie.value, idempotency_key)
    view = JoinedView(name=joined.participant.name, seed=joined.participant.seed)
    response = RecordResponse(view, 201 if joined.is_new else 200)
    response.headers.append("Set-Cookie", cookie.set_header(joined.key))
    return response


@router.delete("/{code}/me", status_code=204, summary="Leave a room")
@policy(access=participant("leave"))
def leave_room(
    services: ServicesDep, request: Request, code: CodePath, seed: SeatDep, response: Response
) -> None:
    """Leave the room; answers and runs stay in the results."""
    services.of(Rooms).leave(code, seed)
    cookie = _cookie(services, request, code)
    response.headers.append("Set-Cookie", cookie.expire_header())


def _cookie(services: Services, request: Request, code: str) -> SessionCookie:
    rules = cookie_rules(request.scope, services.settings)
    return room_cookie(request.scope, normalized(code), rules)


@router.post("/{code}/predictions", status_code=201, summary="Answer a card")
@policy(access=participant("predict"))
def add_prediction(
    services: ServicesDep, code: CodePath, seed: SeatDep, body: PredictionBody
) -> RecordResponse[PredictionView]:
    """Store the answer of the participant who asks; it can be given once, before the reveal."""
    value = services.of(Rooms).predict(code, seed, body.card, body.value)
    return RecordResponse(PredictionView(card=body.card, value=value), 201)


@router.post(
    "/{code}/runs",
    status_code=202,
    summary="Run what the card runs",
    response_model=AnyRunView,
    responses={
        **answers(202, headers=LOCATION),
        200: {"model": ComparisonView, "description": "the answer of a what-if"},
    },
)
@policy(access=participant("run"), work=work_of_card, starts=True)
def start_room_run(
    services: ServicesDep,
    request: Request,
    code: CodePath,
    seed: SeatDep,
    body: RunBody | None = None,
) -> Response:
    """Start the training or race of the card with the seed of the participant who asks.

    Only the settings that the card opens may be given, within its bounds. A run that the
    participant has started with the same settings is returned again; one goes on at a time. A
    what-if is answered at once, with 200, and is kept as a result of the card.
    """
    card, settings = (body := body or RunBody()).card, body.settings
    starts, room = services.of(CardStarts), services.of(Rooms).check_run(code, card)
    number, shown = (room.card, room.shown) if card is None else (card, room.deck[card])
    given = starts.given(shown, settings)
    if shown.go == "what-if":
        training, client = starts.what_if(shown, given), charged_client(request.scope)

        def compute() -> ComparisonView:
            return services.of(WhatIfs).ask(training, client)

        return RecordResponse(services.of(Rooms).ask(code, seed, given, compute, card=number))
    run = services.of(Rooms).start(
        code,
        seed,
        given,
        lambda now: starts.start(
            now.shown, starts.given(now.shown, settings), seed, _name(now, seed)
        ),
        services.jobs.start,
        card=number,
    )
    return located(services, request, run, 202)


@router.put("/{code}/runs/{run_id}/watched", status_code=204, summary="Tell that a run was watched")
@policy(access=participant("watch"))
def note_watched_run(services: ServicesDep, code: CodePath, seed: SeatDep, run_id: RunPath) -> None:
    """Note that the participant who asks has watched a run of theirs to its end.

    Before the reveal the projector does not tell how far it came until then, as long as the page of
    the participant is open. What is noted is forgotten when the server ends.
    """
    services.of(Rooms).note_watched(code, seed, run_id)


def _name(room: Room, seed: int) -> str:
    title = room.shown.title or room.lesson.title
    return check_name(f"Seed {seed} · {title}"[:MAX_NAME])
