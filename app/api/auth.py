"""Token and session authentication, which gives each request its role on the stage."""

import asyncio
from urllib.parse import parse_qsl, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.cookies import SessionCookie, is_secure
from app.api.problems import problem
from app.api.rate_limit import is_question, too_many
from app.api.room_access import READ_METHODS, RoomAccess
from app.api.stage_paths import path_of, stage_of
from app.api.visitor_access import VisitorAccess, visitor_cookie
from app.limits.addresses import client_of
from app.limits.connections import Connection
from app.limits.token_bucket import RateLimiter
from app.settings import Settings
from app.stage.roles import Role, Roles
from app.storage.database.room_rows import Seat
from hexapods.domain.errors import HexapodError

PUBLIC_PATHS = ("/healthz", "/readyz")
_PUBLIC_FOLDERS = ("/static/",)
WRONG_TOKENS, WRONG_TOKENS_PER_S = 20, 0.2
_AUTH_HINT = (
    "send the server's token as Authorization: Bearer …, or open its page once with ?token=… "
    "in the address"
)


class TokenGuard:
    """Authentication middleware: authorises every request and websocket by its role.

    `Roles` of the stage decide on it. Without a token every client is operator; the server then
    binds to loopback only. An operator's browser has a session, whose id is in a cookie. Wrong
    tokens and wrong session ids of an address draw on the same token bucket. The right ones are let
    in even when it is empty, or others at an operator's address could lock them out: they are too
    long to be guessed (`MIN_TOKEN_LENGTH`), and the limit bounds the load. Paths without a route
    are guarded too.
    """

    def __init__(
        self,
        app: ASGIApp,
        settings: Settings,
        rooms: RoomAccess,
        visitors: VisitorAccess | None = None,
    ) -> None:
        """Wrap an app, inside `StagePaths`; of the settings it uses `public_url`.

        Args:
            app: the wrapped app.
            settings: of the server.
            rooms: decides what participants of rooms may do.
            visitors: decides what visitors may do; None on a server that is no demo.
        """
        self._app, self._rooms, self._visitors = app, rooms, visitors
        self._wrong_guesses = RateLimiter(WRONG_TOKENS, WRONG_TOKENS_PER_S)
        self._settings = settings

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Store the role in the scope's state and call the app, or refuse with 401 or 429."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers, roles = Headers(scope=scope), stage_of(scope).roles
        if _has_token_parameter(scope):
            response = await self._open_session(scope, roles)
            await response(scope, receive, send)
            return
        cookie, bearer = self._cookie(scope), _bearer(headers)
        role, seats = self._identify(scope, roles.of(bearer, cookie.value))
        if role == "spectator" and roles.needs_token:
            wrong = [credential for credential in (bearer, cookie.value) if credential]
            wait_s = max((self._wrong_guesses.take(client_of(scope)) for _ in wrong), default=0.0)
            if cookie.value:
                send = _expiring_cookie(cookie, send)
            if wait_s > 0:
                await _too_many_guesses(scope, wait_s)(scope, receive, send)
                return
        refusal = self._refusal(scope, roles, seats) if role == "spectator" else None
        if refusal is None:
            scope["state"]["role"] = role
            if role == "operator" and roles.needs_token:
                _mark_authenticated(scope)
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await _refuse_websocket(scope, receive, send)
        else:
            await refusal(scope, receive, send)

    def _identify(self, scope: Scope, role: Role) -> tuple[Role, tuple[Seat, ...]]:
        """Return the role of a client and its seats in rooms; store these and a visitor's cookie.

        Where nobody needs a token, a participant is who has a room's cookie.
        """
        seats: tuple[Seat, ...] = ()
        is_secure = self._is_secure(scope)
        if role == "spectator" or not stage_of(scope).roles.needs_token:
            seats = self._rooms.seats(scope, is_secure=is_secure)
        role = "spectator" if seats else role
        is_visitor = self._visitors is not None and role == "spectator" and not seats
        scope["state"]["seats"] = seats
        scope["state"]["visitor"] = (
            visitor_cookie(scope, is_secure=is_secure) if is_visitor else None
        )
        return role, seats

    def _refusal(self, scope: Scope, roles: Roles, seats: tuple[Seat, ...]) -> ASGIApp | None:
        """Return the refusal of a request of no operator; None if it is allowed."""
        refusal = self._rooms.refuse(scope, seats, is_public=roles.is_public)
        if refusal is not None or seats:
            return refusal
        if self._rooms.is_open_to_all(scope) or _is_open_to_spectators(scope, roles):
            return None
        if self._visitors is not None:
            return self._visitors.refuse(scope, scope["state"]["visitor"].value)
        return _unauthorized(f"This needs the operator: {_AUTH_HINT}.")

    def _is_secure(self, scope: Scope) -> bool:
        return is_secure(scope, self._settings)

    def _cookie(self, scope: Scope) -> SessionCookie:
        return SessionCookie(scope, self._is_secure(scope), stage_of(scope).session_path)

    async def _open_session(self, scope: Scope, roles: Roles) -> Response:
        """Open a session for the token of `/?token=…`, and redirect to the address without it."""
        items = _query(scope)
        rest = urlencode([(name, value) for name, value in items if name != "token"])
        given = next(value for name, value in items if name == "token")
        # Relative, so that it is valid behind a proxy that serves the app under a prefix.
        response = RedirectResponse(f"?{rest}" if rest else "./", 303)
        response.headers["Cache-Control"] = "no-store"
        if not roles.needs_token:
            return response
        if not roles.is_token(given):
            wait_s = self._wrong_guesses.take(client_of(scope))
            if wait_s > 0:
                return _too_many(wait_s)
            return _unauthorized("This is not the server's token; look at what its start printed.")
        try:
            session_id = await asyncio.to_thread(roles.open_session)
        except HexapodError as error:
            return problem(503, f"No session can be kept: {error}.", headers={"Retry-After": "10"})
        response.headers.append("Set-Cookie", self._cookie(scope).set_header(session_id))
        return response


def _is_open_to_spectators(scope: Scope, roles: Roles) -> bool:
    changes = scope["type"] == "http" and scope["method"] not in READ_METHODS
    if changes and not is_question(scope):
        return False
    path = path_of(scope)
    # The page's files are public; the data they show is not.
    is_open = path == "/" or path in PUBLIC_PATHS or path.startswith(_PUBLIC_FOLDERS)
    return roles.is_public or is_open


def _mark_authenticated(scope: Scope) -> None:
    """Mark the connection as authenticated, which exempts it from eviction."""
    connection: Connection | None = scope["state"].get("connection")
    if connection is not None:
        connection.authenticated()


def _has_token_parameter(scope: Scope) -> bool:
    if scope["type"] != "http" or path_of(scope) != "/" or scope["method"] not in ("GET", "HEAD"):
        return False
    return any(name == "token" for name, _ in _query(scope))


def _query(scope: Scope) -> list[tuple[str, str]]:
    return parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)


def _expiring_cookie(cookie: SessionCookie, send: Send) -> Send:
    """Wrap `send` to expire the cookie, as its requests would all count as wrong guesses."""

    async def send_expiring(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).append("Set-Cookie", cookie.expire_header())
        await send(message)

    return send_expiring


def _bearer(headers: Headers) -> str:
    scheme, _, token = headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


def _too_many_guesses(scope: Scope, wait_s: float) -> ASGIApp:
    return _refuse_websocket if scope["type"] == "websocket" else _too_many(wait_s)


def _too_many(wait_s: float) -> Response:
    return too_many("Too many wrong tokens came from this address; try again later.", wait_s)


async def _refuse_websocket(scope: Scope, receive: Receive, send: Send) -> None:
    del scope, receive
    await send({"type": "websocket.close", "code": 1008, "reason": "token needed"})


def _unauthorized(detail: str) -> Response:
    return problem(401, detail, headers={"WWW-Authenticate": 'Bearer realm="Racing Hexapods"'})
