"""Routes of rooms: a teacher opens one, directs it, reads its results and ends it."""

import logging
from contextlib import suppress
from typing import Annotated, Any, Literal

from fastapi import Depends, Header, Path, Query, Request
from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from app.api.answers import DeletedView
from app.api.contract import TEXT, answers
from app.api.deps import EventListener, Services, ServicesDep
from app.api.events import (
    EVENT_STREAM,
    EventStream,
    PictureQuery,
    client_slot,
    stream_events,
)
from app.api.formats import attachment, negotiated
from app.api.policy import OPERATOR, WATCH, api_router, policy
from app.api.record_response import RecordResponse
from app.api.runs import delete_each
from app.api.spectators import address_for_others, link_to
from app.features.classroom.access import BY_CODE, WATCH_ROOM, CodePath, ReaderDep
from app.features.classroom.card_starts import CardStarts
from app.features.classroom.class_race import class_race, class_race_of
from app.features.classroom.lesson import CardNumber, read_lesson
from app.features.classroom.lessons import Lessons
from app.features.classroom.names import in_groups
from app.features.classroom.request_bodies import (
    CardBody,
    FreezeBody,
    ParticipantBody,
    RevealBody,
    RoomBody,
    SpotlightBody,
)
from app.features.classroom.response_models import ListedRoom, NewRoom, RoomList, RoomView
from app.features.classroom.results import (
    MEDIA_TYPE,
    Reader,
    ResultsView,
    as_csv,
    finishers_of,
    results_of,
)
from app.features.classroom.room import Room
from app.features.classroom.room_stages import RoomStages, path_of_room
from app.features.classroom.room_views import room_view
from app.features.classroom.rooms import Rooms
from app.features.classroom.teaching import Teaching
from app.storage.errors import Conflict, Forbidden, NotFound
from app.storage.run import Run
from app.storage.stored_races import RACE
from app.viewer.shared_stage import SharedStage
from hexapods.domain.errors import HexapodError
from hexapods.runs.race_config import RaceConfig
from hexapods.shows.race_show import SPEED
from hexapods.shows.show import MAX_SPEED

SeedPath = Annotated[int, Path(description="seed of the participant", ge=0)]
_CLASS_RACE_S = 15.0
"""Real time within which the race of a class is shown [s]."""
_logger = logging.getLogger(__name__)

router = api_router(prefix="/rooms", tags=["rooms"])


@router.post(
    "",
    status_code=201,
    summary="Open a room",
    responses=answers(201, headers={"Location": {"required": True, "schema": TEXT}}),
)
@policy(access=OPERATOR, starts=True)
async def open_room(
    services: ServicesDep, request: Request, body: RoomBody | None = None
) -> RecordResponse[NewRoom]:
    """Open a room with a stage of its own; its code is all that pupils need to join."""
    body = body or RoomBody()

    def create() -> Room:
        lesson: Any = None
        if isinstance(body.lesson, str):
            lesson = services.of(Lessons).get(body.lesson, body.language)
        elif body.lesson is not None:
            lesson = read_lesson(body.lesson)
            services.of(CardStarts).check(lesson, services.store)
        for idle in services.of(Rooms).idle_rooms():
            services.of(Rooms).end(idle.code)
        return services.of(Rooms).create(lesson, needs_approval=body.needs_approval)

    room = await run_in_threadpool(create)
    await services.of(RoomStages).open(room)
    for ended in services.of(Rooms).all():
        if not ended.is_open:
            await services.of(RoomStages).close(ended.code)
    link = link_to(request, services.settings, path_of_room(in_groups(room.code)))
    opened = NewRoom(code=room.code, address=link.address, qr_code=link.qr_code)
    location = request.url_for("get_room", code=room.code).path
    return RecordResponse(opened, 201, {"Location": location})


@router.get("", summary="List the rooms that who asks may know")
@policy(access=WATCH)
def list_rooms(
    services: ServicesDep, request: Request, reader: ReaderDep
) -> RecordResponse[RoomList]:
    """Return all rooms to operators, and their own rooms to participants."""
    codes = None if reader is None else set(dict(reader))
    items = [
        ListedRoom(
            code=room.code,
            title=room.lesson.title,
            state=room.phase,
            participants=len(room.present),
            created_at=room.created_at,
        )
        for room in services.of(Rooms).all()
        if codes is None or room.code in codes
    ]
    is_reachable = address_for_others(request, services.settings) is not None
    return RecordResponse(RoomList(items=items, is_reachable=is_reachable))


@router.get("/{code}", summary="Get a room")
@policy(access=BY_CODE, depends_on_state=False)
def get_room(
    services: ServicesDep, request: Request, code: CodePath, reader: ReaderDep
) -> RecordResponse[RoomView]:
    """Return a room as the client may see it: as a teacher, a participant or anyone else."""
    room = services.of(Rooms).get(code)
    return RecordResponse(room_view(request, services, room, dict(reader or ()).get(room.code)))


@router.patch(
    "/{code}/participants/{seed}",
    summary="Hide the name of a participant, or approve",
)
@policy(access=OPERATOR)
def change_participant(
    services: ServicesDep, request: Request, code: CodePath, seed: SeedPath, body: ParticipantBody
) -> RecordResponse[RoomView]:
    """Hide or show the name of a participant, or approve their name, answers and runs."""
    room = services.of(Rooms).change_participant(code, seed, **dict(body))
    return RecordResponse(room_view(request, services, room, None))


@router.delete("/{code}/participants/{seed}", summary="Remove a participant")
@policy(access=OPERATOR)
def remove_participant(
    services: ServicesDep, request: Request, code: CodePath, seed: SeedPath
) -> RecordResponse[RoomView]:
    """Remove a participant: seat, name and answers; runs that wait or go on are stopped.

    Runs that have ended are in no results any more, and stay for operators. Who was removed may
    join again, as somebody else.
    """
    for run_id in services.of(Rooms).remove_participant(code, seed):
        with suppress(Conflict, NotFound):  # it has ended, or is being stopped
            services.jobs.stop(run_id)
    return RecordResponse(room_view(request, services, services.of(Rooms).get(code), None))


@router.put("/{code}/card", summary="Show a card")
@policy(access=OPERATOR)
def show_card(
    services: ServicesDep, request: Request, code: CodePath, body: CardBody
) -> RecordResponse[RoomView]:
    """Show a card to all; participants can change the settings that it opens, and no others."""
    room = services.of(Rooms).get(code)
    room.check_card(body.card)
    if room.card != body.card:
        services.of(Teaching).stop(code, is_announced=False)
    room = services.of(Rooms).show_card(code, body.card)
    return RecordResponse(room_view(request, services, room, None))


@router.post("/{code}/freeze", summary="Freeze all, or go on")
@policy(access=OPERATOR)
def freeze_room(
    services: ServicesDep, request: Request, code: CodePath, body: FreezeBody | None = None
) -> RecordResponse[RoomView]:
    """Forbid answers and starts in the room; with `frozen` false permit them again."""
    room = services.of(Rooms).freeze(code, (body or FreezeBody()).frozen)
    services.of(Teaching).freeze(room)
    return RecordResponse(room_view(request, services, room, None))


@router.post("/{code}/reveal", summary="Reveal a card")
@policy(access=OPERATOR)
def reveal_card(
    services: ServicesDep, request: Request, code: CodePath, body: RevealBody | None = None
) -> RecordResponse[RoomView]:
    """Show all answers and runs of a card to all participants; it takes no more answers.

    The best, the median and the last robot of the card that is shown race together on the stage.
    """
    rooms = services.of(Rooms)
    room = rooms.get(code)
    card = room.card if body is None or body.card is None else body.card
    room.check_card(card)
    room.check_open()
    room.revealed_with(card)
    # The race is there before anything is revealed, so that no figure is told before it.
    race = _race_of_class(services, room, card)
    room = rooms.reveal(code, card, spotlight=None if race is None else race.id)
    if card == room.card:
        services.of(Teaching).race(room)
    shared = services.of(RoomStages).of(room.code)
    if race is not None and shared is not None:
        assert isinstance(race.config, RaceConfig)  # noqa: S101 - by `ClassRace`
        speed = race.config.steps * race.config.robot.step_s / _CLASS_RACE_S
        speed = min(max(speed, SPEED), MAX_SPEED)
        shared.stage.set(run_id=race.id, playing=True, speed=speed)
    return RecordResponse(room_view(request, services, room, None))


def _race_of_class(services: Services, room: Room, card: int) -> Run | None:
    """Store the race of the best, the median and the last robot of the card that is shown.

    Returns:
        the race; None if the card has one, or is not shown, or no robot can race.
    """
    if card != room.card or class_race_of(room, card) is not None:
        return None
    race = class_race(services.store, services.recordings, finishers_of(room, services.store, card))
    if race is None:
        return None
    run = race.run(services.jobs.new_id(), f"The class · {room.shown.title or room.lesson.title}")

    def store_run() -> None:
        services.jobs.keep(run, {RACE: race.file()})

    try:
        is_stored = services.of(Rooms).race_together(
            room.code, card, race, run=run, store_run=store_run
        )
    except HexapodError as error:  # the disk is full: all else is revealed
        _logger.warning("no race of the class in the room %s: %s", room.code, error)
        return None
    return run if is_stored else None


@router.post("/{code}/end", summary="End a room")
@policy(access=OPERATOR)
async def end_room(
    services: ServicesDep, request: Request, code: CodePath
) -> RecordResponse[RoomView]:
    """Close the room and its stage; its results stay."""
    await run_in_threadpool(services.of(Teaching).stop, code)
    room = await run_in_threadpool(services.of(Rooms).end, code)
    await services.of(RoomStages).close(room.code)
    view = await run_in_threadpool(room_view, request, services, room, None)
    return RecordResponse(view)


@router.delete("/{code}", summary="Delete a room that has ended")
@policy(access=OPERATOR)
def delete_room(
    services: ServicesDep,
    code: CodePath,
    *,
    runs: Annotated[bool, Query(description="delete its runs, too")] = False,
) -> RecordResponse[DeletedView]:
    """Delete a room with its participants, answers and results.

    Its runs stay without `runs`, as ordinary runs that all may see. The answer names the runs that
    were deleted, and why others were kept.
    """
    room = services.of(Rooms).ended(code)
    run_ids = services.of(Rooms).runs_in(room.code) if runs else []
    # For good: they are what a class has done.
    deleted = delete_each(run_ids, services.jobs.delete)
    services.of(Rooms).delete(code)
    return RecordResponse(deleted)


@router.put("/{code}/spotlight", summary="Show a participant's run on the stage")
@policy(access=OPERATOR)
def put_spotlight(
    services: ServicesDep, request: Request, code: CodePath, body: SpotlightBody
) -> RecordResponse[RoomView]:
    """Show a run of the room on its stage, to all who watch; all participants may see it then."""
    room = services.of(Rooms).spotlight(code, body.run_id)
    shared = services.of(RoomStages).of(room.code)
    if shared is not None and body.run_id is not None:
        shared.stage.set(run_id=body.run_id, playing=True)
    return RecordResponse(room_view(request, services, room, None))


@router.get(
    "/{code}/results",
    summary="Get the results of a room (JSON, CSV)",
    responses=answers(200, {MEDIA_TYPE: TEXT}),
)
@policy(access=WATCH_ROOM)
def get_room_results(
    services: ServicesDep,
    request: Request,
    code: CodePath,
    reader: ReaderDep,
    *,
    card: Annotated[CardNumber | None, Query(description="of one card; of all if absent")] = None,
    projector: Annotated[
        bool, Query(description="as the class sees it: without those who are not approved")
    ] = False,
    format: Annotated[Literal["json", "csv"] | None, Query()] = None,  # noqa: A002
) -> RecordResponse[ResultsView] | Response:
    """Return by card the predictions, the outcomes of the runs, and the scores of predictions.

    A participant gets their own until the reveal; others get counts alone. Cards that are still to
    come have results for a teacher alone. CSV has no names.
    """
    room = services.of(Rooms).get(code)
    if card is not None:
        room.check_card(card)
    cards = range(len(room.deck)) if card is None else [card]
    if reader is not None:
        cards = [number for number in cards if room.has_shown(number)]
        if card is not None and not cards:
            raise Forbidden(f"card {card} was not shown yet; the class is at card {room.card}")
    seat = dict(reader or ()).get(room.code)
    reader_ = Reader(
        seat,
        is_teacher=reader is None,
        is_projector=projector,
        is_on_phone=lambda seed: services.of(Rooms).is_here((room.code, seed)),
    )
    results = results_of(room, services.store, cards, reader_)
    if negotiated(request, format, ("json", "csv")) == "csv":
        return attachment(
            as_csv(results).encode(), f"{MEDIA_TYPE}; charset=utf-8", f"{room.code}.csv"
        )
    return RecordResponse(results)


def _room_stage(services: ServicesDep, code: CodePath) -> SharedStage:
    room = services.of(Rooms).get(code)
    shared = services.of(RoomStages).of(room.code)
    if shared is None:
        room.check_open()
        raise NotFound(f"the room {room.code} has no stage")
    return shared


@router.get(
    "/{code}/events",
    summary="Stream the events of a room and of its stage",
    **EVENT_STREAM,
)
@policy(access=WATCH_ROOM)
async def get_room_events(
    services: ServicesDep,
    shared: Annotated[SharedStage, Depends(_room_stage)],
    listener: Annotated[EventListener, Depends(client_slot)],
    *,
    picture: PictureQuery = False,
    last_event_id: Annotated[str | None, Header()] = None,
) -> Response:
    """Stream a `snapshot` event, then changes, as `/r/CODE/api/v1/events` does."""
    return EventStream(
        stream_events(services, shared, None, listener, last_event_id, has_picture=picture)
    )
