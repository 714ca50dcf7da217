"""Authorization of spectators and participants for rooms, all of it in this module.

A participant is a spectator whom a room knows by a cookie. By default a participant changes
nothing: only the room's own routes are open, as far as the card that is shown allows it, and what
other features have shared with its participants. Nobody but operators and the participant sees a
participant's run before it is shown to others.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal

from fastapi import Depends, Path
from starlette.requests import Request
from starlette.types import ASGIApp, Scope

from app.api.cookies import (
    CookieRules,
    SessionCookie,
    cookie_rules,
    cookies_of,
    name_of_server,
)
from app.api.deps import Services
from app.api.descriptions import as_sentence
from app.api.identity import Identity
from app.api.policy import ANY_PAGE, QUESTION, WATCH_RUN, WATCH_STAGE, Access
from app.api.problems import problem
from app.api.stage_paths import stage_of
from app.api.work import OTHER, Work
from app.features.classroom.names import CODE, normalized
from app.features.classroom.room import CardAction, Room
from app.features.classroom.room_rows import Seat
from app.features.classroom.rooms import Rooms
from app.features.classroom.what_ifs import WhatIfs
from app.settings import Settings
from app.storage.errors import NotFound

RoomOf = Callable[[Mapping[str, Any]], str | None]
ROOM_NAME = "hexapods_room"
"""Beginning of the names of participants' cookies."""
PAGES = "/r"
_CODE = re.compile(CODE)
_NOT_OF_ROOM = "participants see their room alone here; watching needs the token"
BY_CODE = Access(name="room by its code", spectators="always", is_read=True)
"""Shows a room to whoever has its code."""
JOIN = Access(name="join room", spectators="always")
"""Takes a seat in a room, for which its code is all that is needed."""
WATCH_ROOM = Access(name="watch room", spectators="watching", is_read=True)
"""Shows something of the room `code` of the path."""
LESSONS = Access(name="lessons", spectators="watching", is_read=True)
"""Shows lessons, which have the answers: no participant reads them."""


@dataclass(frozen=True, kw_only=True)
class ParticipantAccess(Access):
    """Access for participants of the room `code` of the path.

    Attributes:
        action: what the card that is shown must allow; to leave, and to tell what was watched,
            is always allowed.
    """

    action: CardAction | Literal["leave", "watch"]
    is_for_operators: bool = False


@cache
def participant(action: CardAction | Literal["leave", "watch"]) -> ParticipantAccess:
    """Return the access of an action of participants in their room."""
    return ParticipantAccess(name=f"participant: {action}", action=action)


class Participant:
    """The identity of a client with seats in open rooms.

    Attributes:
        seats: code of each room, and seed there.
        asks_what_if: whether the request runs a card that is a what-if.
    """

    page_role = "spectator"

    def __init__(
        self, seats: tuple[Seat, ...], rooms: Rooms, shared: Mapping[Access, RoomOf]
    ) -> None:
        """Create the identity of one request.

        Args:
            seats: see the class.
            rooms: those of the server.
            shared: see `RoomAccess.share`.
        """
        self.seats, self._rooms, self._shared = seats, rooms, shared
        self._codes = frozenset(dict(seats))
        self.asks_what_if = False

    def allowance_key(self, scope: Scope) -> str | None:
        """Return the seat in the room of the path: many participants may share an address.

        Who has seats in several rooms has the same allowance in a room whatever cookies are sent.
        """
        code = normalized(scope["path_params"].get("code", ""))
        return f"{code} {dict(self.seats)[code]}" if code in self._codes else None

    def refusal(self, scope: Scope, access: Access, as_spectator: ASGIApp | None) -> ASGIApp | None:
        """Return the refusal of a participant's request: by default of all that is a change."""
        params: Mapping[str, Any] = scope.get("path_params", {})
        if access is LESSONS:
            why: str | None = "a lesson has its answers; participants see its cards alone"
        elif access.spectators == "always":
            why = None
        elif access.is_read:
            may_read = as_spectator is None or self._is_of_room(scope, access, params)
            why = None if may_read else _NOT_OF_ROOM
        elif isinstance(access, ParticipantAccess) and self._is_in(params):
            why = self._why_not(access, self._rooms.get(params["code"]))
        elif self._is_shared(access, params):
            why = None
        else:
            why = self._what_is_allowed(access)
        return None if why is None else problem(403, as_sentence(why))

    def _why_not(self, access: ParticipantAccess, room: Room) -> str | None:
        """Return why the card that a room shows forbids an action; None if it allows it."""
        if access.action == "leave" or access.action == "watch":  # noqa: PLR1714 - for its type
            return None
        self.asks_what_if = access.action == "run" and room.shown.go == "what-if"
        return room.refusal(access.action)

    def _what_is_allowed(self, access: Access) -> str:
        code = self.seats[0][0]
        room = self._rooms.get(code)
        actions: dict[CardAction, str] = {
            "predict": "an answer to the card",
            "run": "the run of the card",
            "press": "presses of + and −",
        }
        allowed_actions = [
            words for action, words in actions.items() if room.refusal(action) is None
        ]
        allowed = " and ".join(allowed_actions) or "nothing but to watch"
        what = "This question" if access is QUESTION else "This"
        return (
            f"{what} is not open to participants of a room; the card that the room {code} shows "
            f"allows {allowed}. DELETE /api/v1/rooms/{code}/me leaves the room"
        )

    def _is_of_room(self, scope: Scope, access: Access, params: Mapping[str, Any]) -> bool:
        """Whether something that is read is of a room of the participant, or of every page."""
        if access is WATCH_RUN:
            owner = self._rooms.owner_of(params["run_id"])
            return owner is not None and owner.partition(" ")[0] in self._codes
        if access is WATCH_STAGE:
            return stage_of(scope).path.removeprefix(f"{PAGES}/") in self._codes
        if access is WATCH_ROOM:
            return self._is_in(params)
        return access is ANY_PAGE or self._is_shared(access, params)

    def _is_in(self, params: Mapping[str, Any]) -> bool:
        return normalized(params["code"]) in self._codes

    def _is_shared(self, access: Access, params: Mapping[str, Any]) -> bool:
        room_of = self._shared.get(access)
        return room_of is not None and room_of(params) in self._codes


class RoomAccess:
    """Knows participants. Thread-safe.

    Attributes:
        scheme: of a participant's cookie.
    """

    def __init__(self, rooms: Rooms, settings: Settings) -> None:
        """Decide about these rooms.

        Args:
            rooms: those of the server.
            settings: of the server.
        """
        self._rooms, self._settings = rooms, settings
        self._shared: dict[Access, RoomOf] = {}
        self.scheme: tuple[str, Mapping[str, Any]] = (
            "participant",
            {
                "type": "apiKey",
                "in": "cookie",
                "name": f"{ROOM_NAME}_{settings.port}_CODE",
                "description": "set by joining a room; its name ends with the code of the room",
            },
        )

    def identify(self, scope: Scope) -> Participant | None:
        """Return which participants of open rooms a client is, by its cookies."""
        seats = []
        for code, key in _room_keys(scope, cookie_rules(scope, self._settings)):
            row = self._rooms.seat(code, key)
            with suppress(NotFound):  # deleted meanwhile
                if row is not None and self._rooms.get(code).is_open:
                    seats.append((code, row.seed))
        return Participant(tuple(seats), self._rooms, self._shared) if seats else None

    def share(self, access: Access, room_of: RoomOf) -> None:
        """Open routes of another feature to the participants of the room that they are about.

        Args:
            access: of the other feature's routes.
            room_of: returns the code of the room by the parameters of a request's path; None if it
                is about none.
        """
        self._shared[access] = room_of

    def requirements(self, access: Access) -> list[dict[str, list[str]]]:
        """Return that a participant's cookie is needed, or does as well as an operator's."""
        is_shared = access in self._shared and not access.is_read
        is_open = isinstance(access, ParticipantAccess) or is_shared
        return [{"participant": []}] if is_open else []


def _reader(request: Request) -> tuple[Seat, ...] | None:
    identity: Identity | None = request.state.identity
    if request.state.role == "operator":
        return None
    return identity.seats if isinstance(identity, Participant) else ()


ReaderDep = Annotated[tuple[Seat, ...] | None, Depends(_reader)]
"""Which participants of rooms the client is, whose runs it sees; None for operators."""


CodePath = Annotated[str, Path(description="code of the room", max_length=20)]


def work_of_card(scope: Scope) -> Work:
    """Return the kind of work of what a card runs: a what-if, or a run that is queued."""
    identity: Identity | None = scope["state"]["identity"]
    if not (isinstance(identity, Participant) and identity.asks_what_if):
        return OTHER
    services: Services = scope["app"].state.services
    return services.of(WhatIfs).work


def room_cookie(scope: Scope, code: str, rules: CookieRules) -> SessionCookie:
    """Return the cookie of a participant of a room."""
    return SessionCookie(scope, rules, f"/{code}", ROOM_NAME)


def _room_keys(scope: Scope, rules: CookieRules) -> Iterator[tuple[str, str]]:
    """Yield the codes of the rooms whose cookies a request has, each with the participant's key."""
    beginning = f"{name_of_server(scope, rules, ROOM_NAME)}_"
    for name, key in cookies_of(scope).items():
        code = name.removeprefix(beginning)
        if code != name and _CODE.fullmatch(code) is not None:
            yield code, key
