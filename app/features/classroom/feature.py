"""The classroom as a feature: its services, routes, pages, tables and stages."""

from collections.abc import AsyncIterator, Iterable, Iterator, Mapping, Sequence
from contextlib import asynccontextmanager
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar

from fastapi import APIRouter
from sqlalchemy import ColumnElement
from starlette.routing import BaseRoute

from app.answer import Answer
from app.api.deps import EventListener, Services
from app.api.identity import Identity
from app.api.pages import page_content
from app.feature import DeleteRuns, Feature
from app.features.classroom import (
    lesson,
    lesson_routes,
    pages,
    participant_routes,
    room_routes,
    teach_routes,
)
from app.features.classroom.access import Participant, RoomAccess
from app.features.classroom.card_starts import CardStarts
from app.features.classroom.lesson_rows import LessonRows
from app.features.classroom.lessons import Lessons
from app.features.classroom.room import RoomEvent
from app.features.classroom.room_rows import Seat, is_seen_by
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.features.classroom.tables import METADATA
from app.features.classroom.teaching import Teaching, TeachingEvent
from app.features.classroom.what_ifs import WhatIfs
from app.jobs.queue import Owner
from app.storage.database.store import RunStore

_BACKUP = "put a backup of the database back; without one the server goes on, and leaves them out"


class Classroom(Feature):
    """Lessons, and rooms in which a class goes through one.

    Attributes:
        rooms, lessons: of the server.
        stages: the stages of the rooms that are open.
        access: knows participants.
    """

    name = "classroom"
    uses = ("what_if",)
    tables = METADATA
    migrations = Path(__file__).with_name("migrations")
    damage_advice: ClassVar[Mapping[str, str]] = {
        "lessons": "store these lessons again, or delete them",
        "rooms": _BACKUP,
        "participants": f"{_BACKUP}; these participants can join again",
        "predictions": f"{_BACKUP}; these participants can answer again",
        "room_runs": f"{_BACKUP}, and shows these runs to operators alone",
    }
    state_events = ("room",)
    event_bodies: ClassVar[Mapping[str, type[Answer]]] = {
        "room": RoomEvent,
        "teaching": TeachingEvent,
    }

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        self.rooms = core.provide(Rooms(core.store))
        self.lessons = core.provide(Lessons(LessonRows(core.store)))
        self.stages = core.provide(RoomStages(core.stages, core.new_stage))
        core.provide(CardStarts(core.agents))
        core.provide(WhatIfs(core.features.get("what_if")))
        core.provide(Teaching(core))
        self.rooms.on_changed = self.stages.publish
        self.access = RoomAccess(self.rooms, core.settings)
        self.rooms.is_here = lambda seat: any(self._listeners_of(seat))
        self.rooms.on_seat_taken = self._close_streams

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (
            lesson_routes.router,
            room_routes.router,
            participant_routes.router,
            teach_routes.router,
        )

    def pages(self) -> Sequence[BaseRoute]:
        return pages.routes(page_content("features/classroom/room.html", self.core.page_files))

    @classmethod
    def complete_schema(cls, schemas: dict[str, Any]) -> None:
        lesson.add_given_schemas(schemas)

    @classmethod
    def read_rows(cls, store: RunStore) -> None:
        Rooms(store)
        Lessons(LessonRows(store)).all()

    @asynccontextmanager
    async def open(self) -> AsyncIterator[None]:
        try:
            for room in self.rooms.open_rooms():
                await self.stages.open(room)
            yield
        finally:
            await self.stages.close_all()

    def owner_of(self, run_id: str) -> Owner | None:
        participant = self.rooms.owner_of(run_id)
        return None if participant is None else Owner(participant)

    def provider(self) -> RoomAccess:
        return self.access

    def visible_runs(self, identity: Identity | None) -> ColumnElement[bool]:
        return is_seen_by(identity.seats if isinstance(identity, Participant) else ())

    def why_hidden(self, run_id: str, identity: Identity | None) -> str | None:
        seats = identity.seats if isinstance(identity, Participant) else ()
        if not self.rooms.is_hidden(run_id, seats):
            return None
        return "This run is a participant's; it is shown after the reveal."

    @classmethod
    def visible_when_left_out(cls) -> ColumnElement[bool]:
        return is_seen_by(())

    def unfinished(self) -> Iterable[str]:
        return self.rooms.unfinished()

    def on_resumed(self) -> None:
        self.core.of(Teaching).follow_again()

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> list[str]:
        return self.rooms.delete_before(time, delete_runs)

    async def forget(self, names: Iterable[str]) -> None:
        for code in names:
            await self.stages.close(code)

    def _listeners_of(self, seat: Seat) -> Iterator[EventListener]:
        """Yield the clients that follow events as a participant of a room; from any thread."""
        for listener in self.core.listeners.holders():
            if isinstance(listener.identity, Participant) and seat in listener.identity.seats:
                yield listener

    def _close_streams(self, seat: Seat) -> None:
        """End the event streams of a participant, who has lost the seat; from any thread."""
        for listener in self._listeners_of(seat):
            listener.close()


FEATURE = Classroom
