"""Roles: a spectator may watch, an operator may start, change, stop and delete."""

import asyncio
import hmac
from typing import Literal
from urllib.parse import parse_qsl, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.cookies import SessionCookie
from app.api.problems import problem
from app.api.rate_limit import too_many
from app.domain.errors import HexapodError
from app.limits.addresses import client_of
from app.limits.connections import Connection
from app.limits.token_bucket import RateLimiter
from app.settings import Settings
from app.storage.sessions import Sessions

Role = Literal["operator", "spectator"]

_READS = frozenset({"GET", "HEAD", "OPTIONS"})
OPEN = ("/healthz", "/readyz")
_OPEN_FOLDERS = ("/static/",)
WRONG_TOKENS, WRONG_TOKENS_PER_S = 20, 0.2
_HOW = (
    "send the server's token as Authorization: Bearer …, or open its page once with ?token=… "
    "in the address"
)


class TokenGuard:
    """Lets operators do everything, and others what they may; for every route, known or not.

    Without a token in the settings everyone is operator: then the server listens on loopback only.
    An operator's browser has a session, whose id is in a cookie. Wrong tokens and wrong session
    ids of an address are counted together.
    """

    def __init__(self, app: ASGIApp, settings: Settings, sessions: Sessions | None) -> None:
        """Guard an app.

        Args:
            app: to be guarded.
            settings: have the token, and say who may watch.
            sessions: that the token opened; None where there is no token.
        """
        self._app = app
        self._token, self._sessions = settings.token, sessions
        self._all_may_watch = settings.token is None or settings.spectators == "public"
        self._guesses = RateLimiter(WRONG_TOKENS, WRONG_TOKENS_PER_S)
        self._is_https = (settings.public_url or "").startswith("https:")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is allowed, with its role in the scope's state."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        is_link = _offers_token(scope)
        wait_s = self._guesses.wait_s(client_of(scope)) if is_link or _bearer(headers) else 0.0
        if wait_s > 0:
            # Also for the right one: whoever guesses must not learn that it was.
            await _too_many_guesses(scope, wait_s)(scope, receive, send)
            return
        if is_link:
            response = await self._let_in(scope, headers)
            await response(scope, receive, send)
            return
        role = self._role(headers, scope)
        if role == "spectator":
            cookie = self._cookie(scope, headers)
            if cookie.value:
                wait_s = self._guesses.take(client_of(scope))
                send = _forgetting(cookie, send)
            if wait_s > 0:
                await _too_many_guesses(scope, wait_s)(scope, receive, send)
                return
        if role == "operator" or self._may_anyone(scope):
            scope.setdefault("state", {})["role"] = role
            if role == "operator" and self._token is not None:
                _note_operator(scope)
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await _refuse_websocket(scope, receive, send)
        else:
            await _unauthorized(f"This needs the operator: {_HOW}.")(scope, receive, send)

    def _role(self, headers: Headers, scope: Scope) -> Role:
        if self._token is None or self._sessions is None:
            return "operator"
        token = _bearer(headers)
        if token and _same(token, self._token):
            return "operator"
        if token:
            self._guesses.take(client_of(scope))
        session_id = self._cookie(scope, headers).value
        return "operator" if session_id and self._sessions.is_open(session_id) else "spectator"

    def _cookie(self, scope: Scope, headers: Headers) -> SessionCookie:
        return SessionCookie(headers, self._is_https or scope["scheme"] in ("https", "wss"))

    def _may_anyone(self, scope: Scope) -> bool:
        if scope["type"] == "http" and scope["method"] not in _READS:
            return False
        path: str = scope["path"]
        # The page itself is no secret; what it shows is.
        is_open = path == "/" or path in OPEN or path.startswith(_OPEN_FOLDERS)
        return self._all_may_watch or is_open

    async def _let_in(self, scope: Scope, headers: Headers) -> Response:
        """Open a session for the token of `/?token=…`, and clean the address of it."""
        items = _query(scope)
        rest = urlencode([(name, value) for name, value in items if name != "token"])
        given = next(value for name, value in items if name == "token")
        # Relative, so that it holds behind a proxy that serves the app under a prefix.
        response = RedirectResponse(f"?{rest}" if rest else "./", 303)
        response.headers["Cache-Control"] = "no-store"
        if self._token is None or self._sessions is None:
            return response
        if not _same(given, self._token):
            self._guesses.take(client_of(scope))
            return _unauthorized("This is not the server's token; look at what its start printed.")
        try:
            session_id = await asyncio.to_thread(self._sessions.open)
        except HexapodError as error:
            return problem(503, f"No session can be kept: {error}.", headers={"Retry-After": "10"})
        response.headers.append("Set-Cookie", self._cookie(scope, headers).holding(session_id))
        return response


def _note_operator(scope: Scope) -> None:
    """Keep the connection from being closed to make room for a stranger's."""
    connection: Connection | None = scope["state"].get("connection")
    if connection is not None:
        connection.authenticated()


def _offers_token(scope: Scope) -> bool:
    if scope["type"] != "http" or scope["path"] != "/" or scope["method"] not in ("GET", "HEAD"):
        return False
    return any(name == "token" for name, _ in _query(scope))


def _query(scope: Scope) -> list[tuple[str, str]]:
    return parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)


def _forgetting(cookie: SessionCookie, send: Send) -> Send:
    """Tell a browser to drop its cookie, lest all its requests count as wrong guesses."""

    async def also_forget(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).append("Set-Cookie", cookie.gone())
        await send(message)

    return also_forget


def _bearer(headers: Headers) -> str:
    scheme, _, token = headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


def _too_many_guesses(scope: Scope, wait_s: float) -> ASGIApp:
    if scope["type"] == "websocket":
        return _refuse_websocket
    return too_many("Too many wrong tokens came from this address; try again later.", wait_s)


async def _refuse_websocket(scope: Scope, receive: Receive, send: Send) -> None:
    del scope, receive
    await send({"type": "websocket.close", "code": 1008, "reason": "token needed"})


def _unauthorized(detail: str) -> Response:
    return problem(401, detail, headers={"WWW-Authenticate": 'Bearer realm="Racing Hexapods"'})


def _same(one: str, other: str) -> bool:
    """Compare in a time that does not tell how much is right."""
    return hmac.compare_digest(one.encode("utf-8", "surrogateescape"), other.encode())
