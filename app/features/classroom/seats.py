"""The seats of rooms: participants by the secret key in their cookie."""

import hashlib
import secrets
from collections.abc import Callable
from datetime import datetime
from typing import NamedTuple

from app.features.classroom.names import Choose, new_name
from app.features.classroom.room import Room
from app.features.classroom.room_rows import ParticipantRow, Seat
from app.storage.errors import Busy
from hexapods.domain.text import check_name

MAX_PARTICIPANTS = 64
"""Maximum number of participants in a room, without those who have left."""
MAX_SEED = 1_000_000
"""Upper limit of seeds: all participants have smaller ones."""
MAX_KEPT = 1000
"""Maximum number with those who have left after they had answered or started something."""
_RETRY_S = 60


class Joined(NamedTuple):
    """A participant who has joined.

    Attributes:
        participant: row of the participant, with name and seed.
        key: secret key of the participant, for the cookie.
        is_new: whether the participant was not in the room before.
    """

    participant: ParticipantRow
    key: str
    is_new: bool


class Seats:
    """Participants of all rooms by the hash of their key. `Rooms` holds its lock for changes."""

    def __init__(self) -> None:
        """Create an empty table of seats."""
        self._seats: dict[str, Seat] = {}

    def add(self, room: Room, row: ParticipantRow) -> None:
        """Give a participant a seat in the room."""
        room.participants[row.seed] = row
        reserve_seed(room, row.seed)
        self._seats[row.key_sha256] = (row.room, row.seed)

    def forget(self, room: Room) -> None:
        """Forget the seats of a room that is deleted."""
        for participant in room.participants.values():
            self._seats.pop(participant.key_sha256, None)

    def remove(self, room: Room, seed: int) -> None:
        """Remove the seat and the answers of a participant; runs stay."""
        del self._seats[room.participants.pop(seed).key_sha256]
        room.predictions = {k: v for k, v in room.predictions.items() if k[0] != seed}

    def has(self, key: str) -> bool:
        """Whether a participant has, or had, this key."""
        return _sha256(key) in self._seats

    def of(self, room: Room, key: str) -> ParticipantRow | None:
        """Return the participant of a room by a key; None without one, or if they have left."""
        seat = self._seats.get(_sha256(key)) if key else None
        if seat is None or seat[0] != room.code:
            return None
        participant = room.participants[seat[1]]
        return participant if participant.left_at is None else None


def free_seat(room: Room, is_in_use: Callable[[int], bool]) -> int | None:
    """Return the seed of the participant whose seat goes to a newcomer; None if no seat does.

    It is the first one who has done nothing and whose page is not open: one person can take any
    number of seats, but not keep them. The newest participant comes last.

    Args:
        room: the room.
        is_in_use: whether a participant, by the seed, has done anything or has the page open.
    """
    if len(room.present) < MAX_PARTICIPANTS:
        return None
    seeds = [participant.seed for participant in room.present]
    return next((seed for seed in seeds if not is_in_use(seed)), None)


def new_participant(room: Room, choose: Choose, now: datetime, key: str) -> Joined:
    """Return a participant with a name and a seed that none of the room has.

    Args:
        room: the room; it is not changed.
        choose: draws the name.
        now: when the participant joins.
        key: key of the participant.

    Raises:
        Busy: if the room is full.
    """
    if len(room.present) >= MAX_PARTICIPANTS:
        raise Busy(f"{MAX_PARTICIPANTS} are in the room {room.code}, which is the most", _RETRY_S)
    if len(room.participants) >= MAX_KEPT:
        raise Busy(f"the room {room.code} has had {MAX_KEPT} participants, the most", _RETRY_S)
    row = ParticipantRow(
        room=room.code,
        seed=room.next_seed,
        name=new_name(choose, {participant.name for participant in room.participants.values()}),
        key_sha256=_sha256(key),
        is_name_hidden=False,
        is_approved=not room.needs_approval,
        joined_at=now,
        left_at=None,
    )
    return Joined(row, key, is_new=True)


def reserve_seed(room: Room, seed: int) -> None:
    """Reserve the seed of a stored row, so that no newcomer gets it; the row may be damaged."""
    if 0 <= seed < MAX_SEED:
        room.next_seed = max(room.next_seed, seed + 1)


def sound_participant(row: ParticipantRow) -> ParticipantRow:
    """Check a stored participant, and return it.

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
    """Derive the key of a participant from the idempotency key of the request to join a room."""
    return _sha256(f"{code} {request_key}")


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
