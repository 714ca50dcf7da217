"""Authorization of spectators and participants for rooms, all of it in this module.

A participant is a spectator whom a room knows by a cookie. By default a participant changes
nothing: only the room's own routes are open, as far as the card that is shown allows it, and the
entries of its tournaments. Nobody but operators and the participant sees a participant's run before
it is shown to others.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from urllib.parse import parse_qsl

from starlette.responses import Response
from starlette.types import Scope

from app.api.cookies import ROOM_NAME, SessionCookie, cookies_of, name_of_server
from app.api.problems import as_sentence, problem
from app.api.rate_limit import is_question
from app.api.stage_paths import path_of
from app.classroom.names import CODE, normalized
from app.classroom.room import Deed
from app.classroom.rooms import Rooms
from app.storage.database.room_rows import Seat
from app.storage.errors import NotFound

ROOMS = "/api/v1/rooms"
PAGES = "/r"
READ_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_OF_ROOM = re.compile(r"/api/v1/rooms/(?P<code>[^/]+)(?P<rest>/.*)?")
_PAGE_OF_ROOM = re.compile(r"/r/(?P<code>[^/]+)(?P<rest>/.*)?")
_OF_RUN = re.compile(r"/api/v1/(?:runs|trainings|races|experiments)/(?P<run>[^/]+)(?:/.*)?")
_CODE = re.compile(CODE)
_OF_TOURNAMENT = re.compile(r"(?:/api/v1/tournaments|/t)/(?P<id>[^/]+)(?P<rest>/.*)?")
_ENTER = "/entries"
_DEEDS: Mapping[str, Deed] = {"/predictions": "predict", "/runs": "run"}
"""By the end of the path that is sent to, what the card must allow."""
_LEAVE = "/me"
_JOIN = "/participants"
OPEN_TO_ALL = frozenset(
    {
        ("get", f"{ROOMS}/{{code}}"),
        ("post", f"{ROOMS}/{{code}}{_JOIN}"),
        ("get", f"{PAGES}/{{code}}"),
        ("get", f"{PAGES}/{{code}}/"),
    }
)
"""Operations and pages for which a code is all that is needed."""
OF_PARTICIPANTS = frozenset(
    {("delete", f"{ROOMS}/{{code}}{_LEAVE}"), *(("post", f"{ROOMS}/{{code}}{x}") for x in _DEEDS)}
)
"""Operations that need the cookie of a participant."""
OF_BOTH = frozenset({("post", f"/api/v1/tournaments/{{tournament_id}}{_ENTER}")})
"""Operations for operators and for participants."""
_TAUGHT = re.compile(r"/api/v1/lessons(/.*)?")
"""Paths that a participant may not read: lessons have the answers."""
_READ_IN_ROOM = re.compile(
    r"/|/favicon\.ico|/static/.*|/viewer/?.*|/healthz|/readyz|/api/v1/(stage|events|options|tournaments)"
)
"""Besides the room itself and its runs, what participants read where others need the token."""


class RoomAccess:
    """Decides what a request of no operator may do. Thread-safe."""

    def __init__(self, rooms: Rooms, room_of_tournament: Callable[[str], str | None]) -> None:
        """Decide about these rooms.

        Args:
            rooms: those of the server.
            room_of_tournament: returns the code of a tournament's room by the tournament's id;
                None if it has none, or there is no such tournament.
        """
        self._rooms, self._room_of_tournament = rooms, room_of_tournament

    def seats(self, scope: Scope, *, is_secure: bool) -> tuple[Seat, ...]:
        """Return which participants of open rooms a client is, by its cookies."""
        found = []
        for code, key in _room_keys(scope, is_secure):
            participant = self._rooms.seat(code, key)
            with suppress(NotFound):  # deleted meanwhile
                if participant is not None and self._rooms.get(code).is_open:
                    found.append((code, participant.seed))
        return tuple(found)

    def refuse(self, scope: Scope, seats: tuple[Seat, ...], *, is_public: bool) -> Response | None:
        """Return the refusal of a request by its path; None if the rules of rooms allow it.

        Args:
            scope: of the request, or of a websocket.
            seats: which participants the client is.
            is_public: whether spectators may watch.
        """
        if any(self._rooms.is_hidden(one, seats) for one in _runs_in(scope)):
            return problem(403, "This run is a participant's; it is shown after the reveal.")
        return self._refuse_participant(scope, seats, is_public=is_public) if seats else None

    def is_open_to_all(self, scope: Scope) -> bool:
        """Whether a code is all that a request needs: to see a room, and to join it."""
        if scope["type"] != "http":
            return False
        path, method = path_of(scope), "get" if scope["method"] == "HEAD" else scope["method"]
        found = _OF_ROOM.fullmatch(path) or _PAGE_OF_ROOM.fullmatch(path)
        if found is None:
            return False
        template = f"{path[: found.start('code')]}{{code}}{found['rest'] or ''}"
        return (method.lower(), template) in OPEN_TO_ALL

    def _refuse_participant(
        self, scope: Scope, seats: tuple[Seat, ...], *, is_public: bool
    ) -> Response | None:
        """Return the refusal of a participant's request: by default of all that is a change."""
        room = _OF_ROOM.fullmatch(path_of(scope))
        code = None if room is None else normalized(room["code"])
        rest = (room["rest"] or "") if room is not None and code in dict(seats) else None
        if scope["type"] == "websocket" or scope["method"] in READ_METHODS:
            if _TAUGHT.fullmatch(path_of(scope)):
                return problem(403, "A lesson has its answers; participants see its cards alone.")
            is_own = rest is not None or self._is_read_in_room(scope, seats)
            if is_public or is_own or self.is_open_to_all(scope):
                return None
            return problem(403, "Participants see their room alone here; watching needs the token.")
        deed = _DEEDS.get(rest or "") if scope["method"] == "POST" else None
        leaves = (scope["method"], rest) == ("DELETE", _LEAVE)
        refusal = None
        if deed is not None and code is not None:
            in_room = self._rooms.get(code)
            scope["state"]["asks_what_if"] = deed == "run" and in_room.shown.go == "what-if"
            refusal = in_room.refusal(deed)
        elif not (leaves or self._enters(scope, seats) or self.is_open_to_all(scope)):
            refusal = self._what_is_allowed(scope, seats[0][0])
        return None if refusal is None else problem(403, as_sentence(refusal))

    def _enters(self, scope: Scope, seats: tuple[Seat, ...]) -> bool:
        """Whether a request enters a tournament of a participant's room."""
        found = _OF_TOURNAMENT.fullmatch(path_of(scope))
        is_entry = found is not None and (scope["method"], found["rest"]) == ("POST", _ENTER)
        return is_entry and self._is_of_own_tournament(scope, seats)

    def _is_of_own_tournament(self, scope: Scope, seats: tuple[Seat, ...]) -> bool:
        found = _OF_TOURNAMENT.fullmatch(path_of(scope))
        return found is not None and self._room_of_tournament(found["id"]) in dict(seats)

    def _what_is_allowed(self, scope: Scope, code: str) -> str:
        room = self._rooms.get(code)
        deeds: dict[Deed, str] = {
            "predict": "an answer to the card",
            "run": "the run of the card",
        }
        open_deeds = [words for deed, words in deeds.items() if room.refusal(deed) is None]
        allowed = " and ".join(open_deeds) or "nothing but to watch"
        what = "This question" if is_question(scope) else "This"
        return (
            f"{what} is not open to participants of a room; the card that the room {code} shows "
            f"allows {allowed}. DELETE {ROOMS}/{code}{_LEAVE} leaves the room"
        )

    def _is_read_in_room(self, scope: Scope, seats: tuple[Seat, ...]) -> bool:
        path, codes = path_of(scope), set(dict(seats))
        run = _OF_RUN.fullmatch(path)
        if run is not None:
            owner = self._rooms.owner_of(run["run"])
            return owner is not None and owner.partition(" ")[0] in codes
        if self._is_of_own_tournament(scope, seats):
            return True
        is_rooms_stage = scope.get("root_path", "").removeprefix(f"{PAGES}/") in codes
        shared = path in ("/api/v1/stage", "/api/v1/events") or path.startswith("/viewer")
        return _READ_IN_ROOM.fullmatch(path) is not None and (is_rooms_stage or not shared)


def room_cookie(scope: Scope, code: str, *, is_secure: bool) -> SessionCookie:
    """Return the cookie of a participant of a room."""
    return SessionCookie(scope, is_secure, f"/{code}", ROOM_NAME)


def _room_keys(scope: Scope, is_secure: bool) -> Iterator[tuple[str, str]]:
    """Yield the codes of the rooms whose cookies a request has, each with the participant's key."""
    beginning = f"{name_of_server(scope, is_secure, ROOM_NAME)}_"
    for name, key in cookies_of(scope).items():
        code = name.removeprefix(beginning)
        if code != name and _CODE.fullmatch(code) is not None:
            yield code, key


def _runs_in(scope: Scope) -> Iterator[str]:
    """Yield all that may be the id of a run in a request's address."""
    found = _OF_RUN.fullmatch(path_of(scope))
    if found is not None:
        yield found["run"]
    for _, value in parse_qsl(scope["query_string"].decode("latin-1")):
        yield from (one.strip() for one in value.split(","))
