"""Rows of rooms of classes: `rooms`, `participants`, `predictions` and `room_runs`.

All are read when the server starts; from then on they are only written. A damaged row is left out,
and logged: see `stored_rows`.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from datetime import datetime
from typing import Any, NamedTuple

from sqlalchemy import Connection, Table, and_, delete, exists, not_, or_, select, update
from sqlalchemy.sql.elements import ColumnElement

from app.api.answers import ComparisonView
from app.features.classroom.tables import PARTICIPANTS, PREDICTIONS, ROOM_RUNS, ROOMS
from app.storage.database.engine import Database
from app.storage.database.schema import RUNS
from app.storage.database.stored_rows import put_rows, read_rows
from hexapods.domain.records import to_json

Seat = tuple[str, int]
"""A participant: code of the room, and seed."""
CLASS_SEED = -1
"""In place of a participant's seed, of runs of the whole class."""


def _as_it_is(row: Any) -> Any:
    return row


class RoomRow(NamedTuple):
    """A room.

    Attributes:
        code: by which one joins it.
        lesson_id: of the lesson that was chosen; None for none.
        lesson: its document.
        card: number of the card that is shown, from 0.
        revealed: numbers of the cards that are revealed.
        is_frozen: whether nothing can be answered or started.
        needs_approval: whether others see of a participant only what was approved.
        spotlight: id of the run on the room's stage; None for none.
        created_at, ended_at: in UTC; it is open while `ended_at` is None.
    """

    code: str
    lesson_id: str | None
    lesson: Mapping[str, Any]
    card: int
    revealed: list[int]
    is_frozen: bool
    needs_approval: bool
    spotlight: str | None
    created_at: datetime
    ended_at: datetime | None


class ParticipantRow(NamedTuple):
    """A participant of a room.

    Attributes:
        room: its code.
        seed: of the participant's runs, which no other participant has.
        name: from a list of words, distinct in the room.
        key_sha256: SHA-256 of the key in the cookie, hexadecimal.
        is_name_hidden: whether others see no name.
        is_approved: whether others may see answers and runs after the reveal.
        joined_at, left_at: in UTC.
    """

    room: str
    seed: int
    name: str
    key_sha256: str
    is_name_hidden: bool
    is_approved: bool
    joined_at: datetime
    left_at: datetime | None


class PredictionRow(NamedTuple):
    """An answer to the question of a card."""

    room: str
    seed: int
    card: int
    value: Any
    made_at: datetime


class RoomRun(NamedTuple):
    """A run of a participant, or a what-if, which is no run but has an answer.

    Attributes:
        run_id: id of the run, which may have been deleted; of a what-if that of this row alone.
        room, seed: whose it is.
        card: on which it was started.
        given: settings that the participant gave, by name.
        is_main: whether it is what was started, not a training that it needs.
        is_shown: whether others may see it.
        created_at: in UTC.
        answer: of a what-if, as `WhatIf.ask` returns it; None of a run.
    """

    run_id: str
    room: str
    seed: int
    card: int
    given: Mapping[str, Any]
    is_main: bool
    is_shown: bool
    created_at: datetime
    answer: ComparisonView | None = None


class RoomRows:
    """Reads and writes the rooms in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def rooms(self, decode: Callable[[RoomRow], Any] = _as_it_is) -> list[Any]:
        """Return all sound rooms, oldest first; what `decode` raises is damage."""
        return self._read(ROOMS, RoomRow, decode, ROOMS.c.created_at)

    def participants(self, decode: Callable[[ParticipantRow], Any] = _as_it_is) -> list[Any]:
        """Return all sound participants."""
        return self._read(PARTICIPANTS, ParticipantRow, decode, PARTICIPANTS.c.seed)

    def seeds(self) -> list[Seat]:
        """Return the seats of all participants, also of those whose rows are damaged."""
        seats = self._column_values(PARTICIPANTS.c.room, PARTICIPANTS.c.seed)
        return [(room, seed) for room, seed in seats if isinstance(seed, int)]

    def predictions(self, decode: Callable[[PredictionRow], Any] = _as_it_is) -> list[Any]:
        """Return all sound predictions."""
        return self._read(PREDICTIONS, PredictionRow, decode, PREDICTIONS.c.made_at)

    def runs(self, decode: Callable[[RoomRun], Any] = _as_it_is) -> list[Any]:
        """Return all sound runs of rooms that are stored, oldest first.

        A run is linked to its participant before it is stored: a kill may leave a link to none.
        """
        # Ids of what-ifs do not sort by time; those of runs do, also of one moment.
        order = ROOM_RUNS.c.created_at, ROOM_RUNS.c.run_id
        query = select(RUNS.c.id).where(
            RUNS.c.id.in_(select(ROOM_RUNS.c.run_id)), RUNS.c.deleted_at.is_(None)
        )
        stored = self._database.read(lambda connection: set(connection.scalars(query)))
        linked = self._read(ROOM_RUNS, RoomRun, decode, *order)
        return [run for run in linked if run.answer is not None or run.run_id in stored]

    def run_ids(self) -> set[str]:
        """Return the ids of all runs of rooms, also of those whose rows are damaged."""
        return {run_id for (run_id,) in self._column_values(ROOM_RUNS.c.run_id)}

    def _read(
        self,
        table: Table,
        kind: Callable[..., Any],
        decode: Callable[[Any], Any],
        *order: ColumnElement[Any],
    ) -> list[Any]:
        return read_rows(self._database, table, lambda **row: decode(kind(**row)), *order).sound

    def _column_values(self, *columns: ColumnElement[Any]) -> Sequence[Any]:
        query = select(*columns)
        return self._database.read(lambda connection: connection.execute(query).all())

    def add_room(self, row: RoomRow) -> None:
        """Insert a room."""
        self._insert(ROOMS, [row])

    def add_participant(self, row: ParticipantRow) -> None:
        """Insert a participant."""
        self._insert(PARTICIPANTS, [row])

    def add_prediction(self, row: PredictionRow) -> None:
        """Insert a prediction."""
        self._insert(PREDICTIONS, [row])

    def add_runs(self, rows: Sequence[RoomRun]) -> None:
        """Insert runs, all or none."""
        self._insert(ROOM_RUNS, rows)

    def change_room(
        self, code: str, changes: Mapping[str, Any], shown: Collection[str] = ()
    ) -> None:
        """Change columns of a room, and show some of its runs, in one transaction."""

        def work(connection: Connection) -> None:
            if changes:
                connection.execute(update(ROOMS).where(ROOMS.c.code == code).values(**changes))
            _show(connection, shown)

        self._database.write(work)

    def change_participant(
        self, room: str, seed: int, changes: Mapping[str, Any], shown: Collection[str] = ()
    ) -> None:
        """Change columns of a participant, and show some runs, in one transaction."""
        is_this = and_(PARTICIPANTS.c.room == room, PARTICIPANTS.c.seed == seed)

        def work(connection: Connection) -> None:
            if changes:
                connection.execute(update(PARTICIPANTS).where(is_this).values(**changes))
            _show(connection, shown)

        self._database.write(work)

    def delete_participant(self, room: str, seed: int) -> None:
        """Delete a participant and all answers; the links of runs stay, which keep them hidden."""

        def work(connection: Connection) -> None:
            for table in (PREDICTIONS, PARTICIPANTS):
                is_this = and_(table.c.room == room, table.c.seed == seed)
                connection.execute(delete(table).where(is_this))

        self._database.write(work)

    def delete_room(self, code: str) -> None:
        """Delete a room, with its participants, predictions and links to runs."""
        statement = delete(ROOMS).where(ROOMS.c.code == code)
        self._database.write(lambda connection: connection.execute(statement))

    def remove_runs(self, run_ids: Collection[str]) -> None:
        """Delete the links of runs that were never stored."""
        statement = delete(ROOM_RUNS).where(ROOM_RUNS.c.run_id.in_(run_ids))
        self._database.write(lambda connection: connection.execute(statement))

    def _insert(self, table: Table, rows: Sequence[Any]) -> None:
        values = [
            {
                name: to_json(value) if isinstance(value, ComparisonView) else value
                for name, value in row._asdict().items()
            }
            for row in rows
        ]
        self._database.write(lambda connection: put_rows(connection, table, values))


def is_seen_by(reader: Sequence[Seat]) -> ColumnElement[bool]:
    """Return the condition that a run is none of a room, is shown to others, or is the reader's.

    Args:
        reader: the participants that the reader is.
    """
    own_runs: list[ColumnElement[bool]] = [
        and_(ROOM_RUNS.c.room == room, ROOM_RUNS.c.seed == seed) for room, seed in reader
    ]
    # A value that is neither true nor false hides.
    hidden = and_(ROOM_RUNS.c.run_id == RUNS.c.id, ROOM_RUNS.c.is_shown.is_not(True))
    return not_(exists().where(and_(hidden, not_(or_(*own_runs))) if own_runs else hidden))


def _show(connection: Connection, run_ids: Collection[str]) -> None:
    if run_ids:
        chosen = ROOM_RUNS.c.run_id.in_(list(run_ids))
        connection.execute(update(ROOM_RUNS).where(chosen).values(is_shown=True))
