"""Authentication by token, session or identity, and authorization by the access of a route."""

import asyncio
from urllib.parse import parse_qsl, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.active_features import Features
from app.api.cookies import SessionCookie, cookie_rules
from app.api.identity import Identity, run_ids_of
from app.api.policy import WATCH_REPLAY, WATCH_RUN, WATCH_STAGE, policy_of
from app.api.problems import problem
from app.api.rate_limit import too_many
from app.api.stage_paths import stage_of
from app.limits.addresses import client_of
from app.limits.connections import Connection
from app.limits.token_bucket import RateLimiter
from app.settings import Settings
from app.stage.roles import Roles
from hexapods.domain.errors import HexapodError

WRONG_TOKENS, WRONG_TOKENS_PER_S = 20, 0.2
_AUTH_HINT = (
    "send the server's token as Authorization: Bearer …, or open its page once with ?token=… "
    "in the address"
)


class TokenGuard:
    """Authentication and authorization: lets a request pass by its role and identity.

    `Roles` of the stage know operators. Without a token every client is operator; the server then
    binds to loopback only. An operator's browser has a session, whose id is in a cookie. Wrong
    tokens and wrong session ids of an address draw on the same token bucket. The right ones are let
    in even when it is empty, or others at an operator's address could lock them out: they are too
    long to be guessed (`check_token`), and the limit bounds the load. What a client who is no
    operator may do is decided by the access of the route, and by the features that know the client.
    """

    def __init__(self, app: ASGIApp, settings: Settings, features: Features) -> None:
        """Wrap an app, inside `StagePaths`; of the settings it uses those of cookies.

        Args:
            app: the wrapped app.
            settings: of the server.
            features: know clients who are no operators, of which the first that knows one
                decides, and which runs are hidden.
        """
        self._app, self._features = app, features
        self._wrong_guesses = RateLimiter(WRONG_TOKENS, WRONG_TOKENS_PER_S)
        self._settings = settings

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Store role and identity in the scope's state and call the app, or refuse the request."""
        headers, roles = Headers(scope=scope), stage_of(scope).roles
        if policy_of(scope).opens_session and _has_token_parameter(scope):
            response = await self._open_session(scope, roles)
            await response(scope, receive, send)
            return
        cookie, bearer = self._cookie(scope), _bearer(headers)
        role = roles.of(bearer, cookie.value)
        identity = None
        if role == "spectator" or not roles.needs_token:
            identity = next(
                filter(None, (provider.identify(scope) for provider in self._features.providers)),
                None,
            )
        role = role if identity is None else "spectator"
        if role == "spectator" and roles.needs_token:
            wrong = [credential for credential in (bearer, cookie.value) if credential]
            wait_s = max((self._wrong_guesses.take(client_of(scope)) for _ in wrong), default=0.0)
            if cookie.value:
                send = _expiring_cookie(cookie, send)
            if wait_s > 0:
                await _too_many(wait_s)(scope, receive, send)
                return
        refusal = self._refusal(scope, roles, identity) if role == "spectator" else None
        if refusal is None:
            scope["state"].update(role=role, identity=identity)
            if role == "operator" and roles.needs_token:
                _mark_authenticated(scope)
            await self._app(scope, receive, send)
        else:
            await refusal(scope, receive, send)

    def _refusal(self, scope: Scope, roles: Roles, identity: Identity | None) -> ASGIApp | None:
        """Return the refusal of a request of no operator; None if it is allowed."""
        access, as_spectator, on_stage = policy_of(scope).access, None, None
        if access is WATCH_REPLAY:
            run_id = scope["path_params"]["run_id"]
            on_stage = run_id if run_id == stage_of(scope).stage.run_id else None
            access = WATCH_RUN if on_stage is None else WATCH_STAGE
        for run_id in run_ids_of(scope):
            if run_id == on_stage:
                continue
            if (why := self._features.why_hidden(run_id, identity)) is not None:
                return problem(403, why)
        if not access.admits_spectators(is_public=roles.is_public):
            as_spectator = _unauthorized(f"This needs the operator: {_AUTH_HINT}.")
        if identity is None:
            return as_spectator
        return identity.refusal(scope, access, as_spectator)

    def _cookie(self, scope: Scope) -> SessionCookie:
        rules = cookie_rules(scope, self._settings)
        return SessionCookie(scope, rules, stage_of(scope).session_path)

    async def _open_session(self, scope: Scope, roles: Roles) -> Response:
        """Open a session for the token of `?token=…`, and redirect to the address without it."""
        items = _query(scope)
        rest = urlencode([(name, value) for name, value in items if name != "token"])
        token = next(value for name, value in items if name == "token")
        # Relative, so that it is valid behind a proxy that serves the app under a prefix.
        page = scope["path"].rpartition("/")[2] or "./"
        response = RedirectResponse(f"?{rest}" if rest else page, 303)
        response.headers["Cache-Control"] = "no-store"
        if not roles.needs_token:
            return response
        if not roles.is_token(token):
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


def _mark_authenticated(scope: Scope) -> None:
    """Mark the connection as authenticated, which exempts it from eviction."""
    connection: Connection | None = scope["state"].get("connection")
    if connection is not None:
        connection.authenticated()


def _has_token_parameter(scope: Scope) -> bool:
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


def _too_many(wait_s: float) -> Response:
    return too_many("Too many wrong tokens came from this address; try again later.", wait_s)


def _unauthorized(detail: str) -> Response:
    return problem(401, detail, headers={"WWW-Authenticate": 'Bearer realm="Racing Hexapods"'})
