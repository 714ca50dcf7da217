"""The rooms of a server by their codes: opened, looked up, ended and deleted.

All is written to the database before it counts, so that a server that is killed goes on with it.
"""

import logging
import secrets
import threading
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from app.feature import DeleteRuns
from app.features.classroom.lesson import Lesson, plain
from app.features.classroom.lessons import FoundLesson
from app.features.classroom.names import Choose, new_code, normalized
from app.features.classroom.room import Room
from app.features.classroom.room_loading import load_rooms, room_of
from app.features.classroom.room_rows import RoomRow, RoomRows, Seat
from app.features.classroom.room_runs import RoomRuns
from app.features.classroom.seats import Seats
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, NotFound
from hexapods.domain.errors import HexapodError

MAX_OPEN = 16
"""Rooms that are open at once; each has a stage of its own."""
IDLE = timedelta(days=1)
"""Time without any action after which a room may be ended to open another."""
_RETRY_S = 60
_logger = logging.getLogger(__name__)
_EMPTY: Mapping[str, Any] = {
    "title": "A room",
    "cards": [{"text": "Watch what the teacher shows."}],
}


class RoomRegistry:
    """All rooms of a server. Thread-safe."""

    def __init__(
        self,
        store: RunStore,
        *,
        choose: Choose = secrets.choice,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
        on_changed: Callable[[Room], object] = lambda room: None,  # noqa: ARG005
    ) -> None:
        """Load the rooms.

        Args:
            store: store of the runs, in whose database the rooms are.
            choose: draws codes and names.
            now: the clock, with time zone.
            on_changed: called with each room that has changed.

        Raises:
            StorageFailed: if the rooms cannot be read.
        """
        self._store, self._rows = store, RoomRows(store.database)
        self._choose, self._now = choose, now
        self._started_at = now()
        self.on_changed = on_changed
        self.is_here: Callable[[Seat], bool] = lambda seat: False  # noqa: ARG005
        """Whether a participant's page is open."""
        self.has_entered: Callable[[Seat], bool] = lambda seat: False  # noqa: ARG005
        """Whether a participant has entered a tournament."""
        self.tournaments_of: Callable[[str], Sequence[Any]] = lambda code: []  # noqa: ARG005
        """Returns the tournaments of a room by its code, as `RoomTournament`."""
        self.on_seat_taken: Callable[[Seat], object] = lambda seat: None  # noqa: ARG005
        """Called for each participant who has lost their seat, or has left."""
        self._lock = threading.RLock()
        self._seats, self._runs = Seats(), RoomRuns(store)
        self._rooms = load_rooms(self._rows, self._seats)
        self._runs.load(self._rooms)

    def open_rooms(self) -> list[Room]:
        """Return the rooms that are open, oldest first."""
        return [room for room in self.all() if room.is_open]

    def all(self) -> list[Room]:
        """Return all rooms, oldest first."""
        with self._lock:
            return list(self._rooms.values())

    def codes(self) -> list[str]:
        """Return the codes of all rooms, oldest first."""
        return [room.code for room in self.all()]

    def get(self, code: str) -> Room:
        """Return a room, which may have ended, by its code as it was typed.

        Raises:
            NotFound: if there is none.
        """
        room = self._rooms.get(normalized(code))
        if room is None:
            raise NotFound(
                f"there is no room {code[:20]!r}; look again at the code on the projector"
            )
        return room

    def create(self, found: FoundLesson | Lesson | None, *, needs_approval: bool = False) -> Room:
        """Open a room.

        Args:
            found: lesson of the room, stored or not; None for none.
            needs_approval: whether others see of a participant only what was approved.

        Raises:
            Busy: if too many are open.
        """
        lesson = found.lesson if isinstance(found, FoundLesson) else found
        lesson_id = found.id if isinstance(found, FoundLesson) else None
        with self._lock:
            if len(self.open_rooms()) >= MAX_OPEN:
                raise Busy(f"{MAX_OPEN} rooms are open, which is the most; end one", _RETRY_S)
            row = RoomRow(
                code=new_code(self._choose, self._rooms),
                lesson_id=lesson_id,
                lesson=_EMPTY if lesson is None else plain(lesson),
                card=0,
                revealed=[],
                is_frozen=False,
                needs_approval=needs_approval,
                spotlight=None,
                created_at=self._now(),
                ended_at=None,
            )
            self._rows.add_room(row)
            room = self._rooms[row.code] = room_of(row)
        return room

    def idle_rooms(self) -> list[Room]:
        """Return the open rooms in which nothing has happened for longer than `IDLE`."""
        with self._lock:
            since = self._now() - IDLE
            # When a card was shown is not stored: after a restart a room may have been used before.
            return [r for r in self.open_rooms() if max(r.used_at, self._started_at) < since]

    def last_used_before(self, time: datetime) -> list[str]:
        """Return the codes of the rooms in which nothing has happened since a time."""
        return [room.code for room in self.all() if room.used_at <= time]

    def runs_in(self, code: str) -> list[str]:
        """Return the ids of a room's runs, the newest first: races before their trainings."""
        return self._runs.ids_of(self.get(code))[::-1]

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> list[str]:
        """Delete the rooms in which nothing has happened since a time, with their runs.

        A room whose runs cannot all be deleted stays until the next call.

        Returns:
            codes of the deleted rooms.
        """
        gone = []
        for code in self.last_used_before(time):
            ids = self.runs_in(code)
            if len(delete_runs(ids)) < len(ids):
                continue
            try:
                self.forget(code)
            except HexapodError as error:
                _logger.warning("the room %s is deleted later: %s", code, error)
            else:
                gone.append(code)
        return gone

    def forget(self, code: str) -> None:
        """End a room, and delete it with participants and answers; its runs stay.

        Raises:
            NotFound: if there is no such room.
        """
        with self._lock:
            room = self.end(code)
            self._rows.delete_room(room.code)
            del self._rooms[room.code]
            self._seats.forget(room)
            self._runs.forget(room)

    def end(self, code: str) -> Room:
        """End a room: from then on nobody joins, answers or starts; its results stay.

        Raises:
            NotFound: if there is no such room.
        """
        with self._lock:
            room = self.get(code)
            if room.is_open:
                now = self._now()
                self._rows.change_room(room.code, {"ended_at": now})
                room.ended_at = now
        self._changed(room)
        return room

    def ended(self, code: str) -> Room:
        """Return a room that has ended.

        Raises:
            NotFound: if there is no such room.
            Conflict: if it is open.
        """
        room = self.get(code)
        if room.is_open:
            raise Conflict(f"the room {room.code} is open; end it first", "open")
        return room

    def delete(self, code: str) -> None:
        """Delete a room that has ended, with its participants, answers and what-ifs.

        Its runs stay without an owner: all may see them. Errors as `ended`.
        """
        with self._lock:
            self.ended(code)
            self.forget(code)

    def taught(self, lesson: Lesson) -> int | None:
        """Return the number of the card up to which all may read a lesson that open rooms teach.

        None if none teaches it; lessons are compared by their content. Operators alone may read
        the revealed parts meanwhile.
        """
        return min((room.card for room in self.open_rooms() if room.lesson == lesson), default=None)

    def _changed(self, room: Room) -> None:
        """Update the time at which a room was used last, and call `on_changed`."""
        room.used_at = self._now()
        self.on_changed(room)
