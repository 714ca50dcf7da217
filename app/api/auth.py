"""Roles: a spectator may watch, an operator may start, change, stop and delete."""

import hashlib
import hmac
from http.cookies import CookieError, SimpleCookie
from typing import Literal
from urllib.parse import parse_qsl, urlencode

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.addresses import caller
from app.api.connections import Connection
from app.api.problems import problem
from app.api.rates import too_many
from app.services.buckets import Buckets
from app.settings import Settings

Role = Literal["operator", "spectator"]

COOKIE = "hexapods_operator"
_COOKIE_AGE_S = 30 * 24 * 3600
_READS = frozenset({"GET", "HEAD", "OPTIONS"})
_OPEN = ("/healthz", "/readyz")
_OPEN_FOLDERS = ("/static/",)
WRONG_TOKENS, WRONG_TOKENS_PER_S = 20, 0.2
_HOW = (
    "send the server's token as Authorization: Bearer …, or open its page once with ?token=… "
    "in the address"
)


class TokenGuard:
    """Lets operators do everything, and others what they may; for every route, known or not.

    Without a token in the settings everyone is operator: then the server listens on loopback only.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Guard an app with the token in the settings."""
        self._app = app
        self._token = settings.token
        self._all_may_watch = settings.token is None or settings.spectators == "public"
        self._guesses = Buckets(WRONG_TOKENS, WRONG_TOKENS_PER_S)
        self._is_https = (settings.public_url or "").startswith("https:")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is allowed, with its role in the scope's state."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        is_link = _offers_token(scope)
        wait_s = self._guesses.wait_s(caller(scope)) if is_link or _bearer(headers) else 0.0
        if wait_s > 0:
            # Also for the right one: whoever guesses must not learn that it was.
            await _too_many_guesses(scope, wait_s)(scope, receive, send)
            return
        if is_link:
            await self._let_in(Request(scope))(scope, receive, send)
            return
        role = self._role(headers, scope)
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
        if self._token is None:
            return "operator"
        token = _bearer(headers)
        if token and _same(token, self._token):
            return "operator"
        if token:
            self._guesses.take(caller(scope))
        if _same(_cookie(headers), _cookie_value(self._token)):
            return "operator"
        return "spectator"

    def _may_anyone(self, scope: Scope) -> bool:
        if scope["type"] == "http" and scope["method"] not in _READS:
            return False
        path: str = scope["path"]
        # The page itself is no secret; what it shows is.
        is_open = path == "/" or path in _OPEN or path.startswith(_OPEN_FOLDERS)
        return self._all_may_watch or is_open

    def _let_in(self, request: Request) -> Response:
        """Keep the token of `/?token=…` in a cookie, and clean the address of it."""
        items = parse_qsl(request.url.query, keep_blank_values=True)
        rest = urlencode([(name, value) for name, value in items if name != "token"])
        given = next(value for name, value in items if name == "token")
        # Relative, so that it holds behind a proxy that serves the app under a prefix.
        response = RedirectResponse(f"?{rest}" if rest else "./", 303)
        response.headers["Cache-Control"] = "no-store"
        if self._token is None:
            return response
        if not _same(given, self._token):
            self._guesses.take(caller(request.scope))
            return _unauthorized("This is not the server's token; look at what its start printed.")
        response.set_cookie(
            COOKIE,
            _cookie_value(self._token),
            max_age=_COOKIE_AGE_S,
            httponly=True,
            samesite="strict",
            secure=self._is_https or request.url.scheme == "https",
        )
        return response


def _note_operator(scope: Scope) -> None:
    """Keep the connection from being closed to make room for a stranger's."""
    connection: Connection | None = scope["state"].get("connection")
    if connection is not None:
        connection.authenticated()


def _offers_token(scope: Scope) -> bool:
    if scope["type"] != "http" or scope["path"] != "/" or scope["method"] not in ("GET", "HEAD"):
        return False
    query = scope["query_string"].decode("latin-1")
    return any(name == "token" for name, _ in parse_qsl(query, keep_blank_values=True))


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


def _cookie(headers: Headers) -> str:
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return ""
    return morsel.value if morsel else ""


def _cookie_value(token: str) -> str:
    """Proves the token without holding it, and outlives a restart of the server."""
    return hmac.new(token.encode(), b"operator's cookie", hashlib.sha256).hexdigest()


def _same(one: str, other: str) -> bool:
    """Compare in a time that does not tell how much is right."""
    return hmac.compare_digest(one.encode("utf-8", "surrogateescape"), other.encode())
