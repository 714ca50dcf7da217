"""Rooms as the API responds with them."""

from dataclasses import replace
from typing import Literal

from fastapi import Request

from app.api.deps import Services
from app.api.spectators import link_to
from app.features.classroom.lesson import Card, html_of
from app.features.classroom.lesson_routes import lesson_view
from app.features.classroom.lessons import FoundLesson
from app.features.classroom.names import in_groups
from app.features.classroom.response_models import (
    Me,
    OwnAnswer,
    OwnRun,
    Person,
    RoomTournament,
    RoomView,
)
from app.features.classroom.room import Room
from app.features.classroom.room_stages import path_of_room
from app.features.classroom.rooms import Rooms
from app.storage.database.store import RunStore
from app.storage.errors import NotFound

RoomRole = Literal["teacher", "participant", "spectator"]


def room_view(request: Request, services: Services, room: Room, seed: int | None) -> RoomView:
    """Return a room as who asks may see it.

    Args:
        request: of who asks.
        services: of the server.
        room: the room.
        seed: of the participant who asks; None for others.
    """
    room = room.snapshot()
    is_teacher = request.state.role == "operator"
    if seed not in room.participants:
        seed = None  # removed meanwhile
    role: RoomRole = "spectator" if seed is None else "participant"
    shown: Card = room.shown
    if not is_teacher and room.card not in room.revealed:
        shown = replace(shown, reveal=None)
    # The teacher's cards are those of the room, with the questions around the lesson.
    taught = replace(room.lesson, cards=room.deck, before=None, after=None)
    lesson = FoundLesson(room.lesson_id or "", taught, is_built_in=False)
    link = link_to(request, services.settings, path_of_room(in_groups(room.code)))
    return RoomView(
        **vars(room.state),
        role="teacher" if is_teacher else role,
        shown=shown,
        html=html_of(shown),
        me=None if seed is None else _me(room, seed),
        people=_people(room, services.store) if is_teacher else [],
        lesson=lesson_view(lesson) if is_teacher else None,
        tournaments=[
            RoomTournament(id=tournament.id, title=tournament.title, state=tournament.state)
            for tournament in services.of(Rooms).tournaments_of(room.code)
        ],
        address=link.address,
        qr_code=link.qr_code,
    )


def _me(room: Room, seed: int) -> Me:
    return Me(
        name=room.participants[seed].name,
        seed=seed,
        predictions=[
            OwnAnswer(card=card, value=value)
            for (participant, card), value in sorted(
                room.predictions.items(), key=lambda item: item[0]
            )
            if participant == seed
        ],
        runs=[
            OwnRun(run_id=run.run_id, card=run.card)
            for run in room.runs.values()
            if run.is_main and run.seed == seed and run.answer is None
        ],
    )


def _people(room: Room, store: RunStore) -> list[Person]:
    people = []
    for seed, participant in sorted(room.participants.items()):
        newest = next(iter(reversed(room.runs_of(seed, room.card))), None)
        run, is_answered = None, newest is not None and newest.answer is not None
        if newest is not None and not is_answered:
            try:
                run = store.find(newest.run_id)
            except NotFound:
                run = None  # deleted, or never stored
        people.append(
            Person(
                seed=seed,
                name=participant.name,
                is_present=participant.left_at is None,
                is_name_hidden=participant.is_name_hidden,
                is_approved=participant.is_approved,
                joined_at=participant.joined_at,
                has_predicted=(seed, room.card) in room.predictions,
                run_id=None if run is None else run.id,
                run_state="finished" if is_answered else None if run is None else run.state,
            )
        )
    return people
