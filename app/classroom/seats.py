"""The seats of rooms: which participant a key is, as a cookie holds it."""

import hashlib
import secrets
from datetime import datetime
from typing import NamedTuple

from app.classroom.names import Choose, new_name
from app.classroom.room import Room
from app.storage.database.room_rows import ParticipantRow, Seat
from app.storage.errors import Busy
from hexapods.domain.text import check_name

MAX_PARTICIPANTS = 64
"""In a room, without those who have left."""
MAX_SEED = 1_000_000
"""Above the seed of any participant."""
_RETRY_S = 60


class Joined(NamedTuple):
    """A participant who has joined.

    Attributes:
        participant: with name and seed.
        key: what the cookie holds.
        is_new: whether the participant was not in the room before.
    """

    participant: ParticipantRow
    key: str
    is_new: bool


class Seats:
    """Participants of all rooms by the hash of their key. `Rooms` holds its lock for changes."""

    def __init__(self) -> None:
        """Create it without a participant."""
        self._seats: dict[str, Seat] = {}

    def add(self, room: Room, row: ParticipantRow) -> None:
        """Give a participant a seat in the room."""
        room.participants[row.seed] = row
        self._seats[row.key_sha256] = (row.room, row.seed)

    def forget(self, room: Room) -> None:
        """Forget the seats of a room that is deleted."""
        for one in room.participants.values():
            self._seats.pop(one.key_sha256, None)

    def has(self, key: str) -> bool:
        """Whether a participant has, or had, this key."""
        return _sha256(key) in self._seats

    def of(self, room: Room, key: str) -> ParticipantRow | None:
        """Return the participant of a room who has a key; None if none has, or has left."""
        seat = self._seats.get(_sha256(key)) if key else None
        if seat is None or seat[0] != room.code:
            return None
        participant = room.participants[seat[1]]
        return participant if participant.left_at is None else None


def new_participant(room: Room, choose: Choose, now: datetime, key: str) -> Joined:
    """Return a participant with a name and a seed that none of the room has.

    Args:
        room: the room; it is not changed.
        choose: draws the name.
        now: when the participant joins.
        key: of the participant.

    Raises:
        Busy: if the room is full.
    """
    if len(room.present) >= MAX_PARTICIPANTS:
        raise Busy(f"{MAX_PARTICIPANTS} are in the room {room.code}, which is the most", _RETRY_S)
    row = ParticipantRow(
        room=room.code,
        seed=_free_seed(room),
        name=new_name(choose, {one.name for one in room.participants.values()}),
        key_sha256=_sha256(key),
        is_name_hidden=False,
        is_approved=not room.needs_approval,
        joined_at=now,
        left_at=None,
    )
    return Joined(row, key, is_new=True)


def _free_seed(room: Room) -> int:
    taken = {*room.participants, *room.taken_seeds}
    return max((one for one in taken if 0 <= one < MAX_SEED), default=-1) + 1


def sound_participant(row: ParticipantRow) -> ParticipantRow:
    """Return a stored participant.

    Raises:
        ValueError: if the row is damaged.
    """
    if not 0 <= row.seed < MAX_SEED:
        raise ValueError("seed: it is none of a participant")
    check_name(row.name)
    return row


def new_key() -> str:
    """Return a key that cannot be guessed."""
    return secrets.token_urlsafe(32)


def key_of(code: str, request_key: str) -> str:
    """Return the key that a request to join a room gets, by its idempotency key, a secret."""
    return _sha256(f"{code} {request_key}")


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
