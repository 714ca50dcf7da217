"""Rooms as the database has them, with their participants and answers."""

from collections.abc import Mapping
from typing import Any

from app.features.classroom.lesson import read_lesson
from app.features.classroom.names import normalized
from app.features.classroom.questions import check_answer
from app.features.classroom.room import Room
from app.features.classroom.room_rows import PredictionRow, RoomRow, RoomRows
from app.features.classroom.seats import Seats, reserve_seed, sound_participant


def load_rooms(rows: RoomRows, seats: Seats) -> dict[str, Room]:
    """Load all rooms by code, without their runs; rows that are damaged are left out.

    Args:
        rows: rows of the database.
        seats: seats of the participants, which are added.
    """
    rooms = {room.code: room for room in rows.rooms(room_of)}
    for participant in rows.participants(sound_participant):
        if participant.room in rooms:
            room = rooms[participant.room]
            seats.add(room, participant)
            room.used_at = max(
                room.used_at, participant.joined_at, participant.left_at or room.used_at
            )
    for code, seed in rows.seeds():
        if code in rooms:
            reserve_seed(rooms[code], seed)
    for prediction in rows.predictions(lambda row: _sound_prediction(row, rooms)):
        if prediction.room in rooms:
            room = rooms[prediction.room]
            room.predictions[prediction.seed, prediction.card] = prediction.value
            room.used_at = max(room.used_at, prediction.made_at)
    return rooms


def room_of(row: RoomRow) -> Room:
    """Return the room of a row.

    Raises:
        ValueError, InvalidInput: if the row is damaged.
    """
    if row.code != normalized(row.code) or not (row.code.isascii() and row.code.isalnum()):
        raise ValueError("code: it is no code")
    revealed: Any = row.revealed
    if not isinstance(revealed, list) or not all(type(number) is int for number in revealed):
        raise ValueError("revealed: it is no list of numbers")
    lesson = read_lesson(row.lesson)
    card = min(max(row.card, 0), len(lesson.deck) - 1)
    fields = {**row._asdict(), "lesson": lesson, "card": card, "revealed": frozenset(row.revealed)}
    return Room(**fields, used_at=row.ended_at or row.created_at)


def _sound_prediction(row: PredictionRow, rooms: Mapping[str, Room]) -> PredictionRow:
    """Check a stored answer, and return it decoded.

    Raises:
        ValueError, InvalidInput, NotFound: if the row is damaged.
    """
    room = rooms.get(row.room)
    if room is None:
        return row  # its room is left out
    room.check_card(row.card)
    ask = room.deck[row.card].ask
    if ask is None:
        raise ValueError(f"card {row.card} asks nothing")
    return row._replace(value=check_answer(ask, row.value))
