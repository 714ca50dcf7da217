"""Rate limits of starts and of spectators' what-ifs: token buckets per client address."""

import math
import re

from starlette.datastructures import QueryParams
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import problem
from app.api.stage_paths import path_of
from app.limits.addresses import client_of
from app.limits.token_bucket import RateLimiter
from app.settings import PREFIX, Settings
from hexapods.exports.export_format import Load
from hexapods.exports.registry import EXPORTS

_STARTS_NOTHING = re.compile(
    r"/api/v1/(what-if|robots/preview|lessons|.*/(estimate|stop|pause|disturbances)"
    r"|rooms/[^/]+/(participants|predictions|reveal|freeze|end)"
    r"|tournaments/[^/]+/(entries|end))"
)
"""Every other POST counts, so that a new route is limited unless it is added here."""
_RECORDING = re.compile(r"/api/v1/races/[^/]+/recording")
_OF_RUN = re.compile(r"/api/v1/runs/[^/]+/([^/]+)")
WHAT_IF, ROBOTS = "/api/v1/what-if", "/api/v1/robots"
PREVIEW = f"{ROBOTS}/preview"
QUESTIONS = frozenset({WHAT_IF, PREVIEW})
"""Paths whose POST changes nothing, so that spectators may use it, too."""


class RateLimit(HttpMiddleware):
    """Middleware that limits starts per minute, by client address and role.

    Besides runs it counts imports, changes of stored robots, resumes, and what takes seconds to
    encode: a race's recorded stream, pages that need no server, videos and logs. What-ifs of
    spectators have a limit of their own; those of operators have none.
    """

    def __init__(self, app: ASGIApp, settings: Settings, what_ifs: RateLimiter) -> None:
        """Wrap an app; to be installed inside `TokenGuard`, which sets the role.

        Args:
            app: the wrapped app.
            settings: settings of the server.
            what_ifs: that of spectators' what-ifs: see `what_if_limiter`.
        """
        super().__init__(app)
        self._per_minute = settings.starts_per_minute
        self._buckets = RateLimiter(self._per_minute, self._per_minute / 60)
        self._what_ifs_per_minute, self._what_ifs = settings.what_ifs_per_minute, what_ifs

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or respond 429."""
        refusal = self._refusal(scope)
        await (self._app if refusal is None else refusal)(scope, receive, send)

    def _refusal(self, scope: Scope) -> Response | None:
        if is_spectators_what_if(scope):
            wait_s = self._what_ifs.take(asker_of(scope))
            detail = what_ifs_used_up(self._what_ifs_per_minute, wait_s)
        elif _starts_work(scope):
            wait_s = self._buckets.take(f"{scope['state']['role']} {client_of(scope)}")
            detail = (
                f"One address may start {self._per_minute} times a minute here; try again later, "
                f"or raise {PREFIX}STARTS_PER_MINUTE."
            )
        else:
            return None
        return too_many(detail, wait_s) if wait_s > 0 else None


def what_if_limiter(settings: Settings) -> RateLimiter:
    """Return the limiter of spectators' what-ifs: a token for each, and for each further second."""
    per_minute = settings.what_ifs_per_minute
    return RateLimiter(per_minute, per_minute / 60)


def what_ifs_used_up(per_minute: int, wait_s: float) -> str:
    """Return the sentences that tell a spectator to wait before the next what-if."""
    return (
        f"Spectators of one address may ask {per_minute} times a minute here, and one that takes "
        f"longer than a second counts as many times; ask again in {whole_seconds(wait_s)} s. "
        f"{PREFIX}WHAT_IFS_PER_MINUTE sets how often."
    )


def is_question(scope: Scope) -> bool:
    """Whether a request with a body asks something, and changes nothing."""
    return scope["method"] == "POST" and path_of(scope) in QUESTIONS


def is_spectators_what_if(scope: Scope) -> bool:
    """Whether a spectator asks for a what-if; to be called inside `TokenGuard`."""
    is_what_if = (scope["method"], path_of(scope)) == ("POST", WHAT_IF)
    # Of a participant of a room it is the run of the card.
    is_what_if = is_what_if or bool(scope["state"].get("asks_what_if"))
    return is_what_if and bool(scope["state"]["role"] == "spectator")


def asker_of(scope: Scope) -> str:
    """Return who is charged for a what-if: a participant, or an address, which many may share."""
    if scope["state"].get("asks_what_if"):
        return " ".join(f"{code} {seed}" for code, seed in scope["state"]["seats"])
    return client_of(scope)


def too_many(detail: str, wait_s: float) -> Response:
    """Return a 429 response whose Retry-After is the wait, rounded up to at least 1 s."""
    return problem(429, detail, headers={"Retry-After": str(whole_seconds(wait_s))})


def whole_seconds(wait_s: float) -> int:
    """Return a wait for a Retry-After header: rounded up, and at least 1 s."""
    return max(1, math.ceil(wait_s))


def is_reading_robot(scope: Scope) -> bool:
    """Whether a request may have a robot's file read, in a process that takes seconds."""
    path = path_of(scope)
    return (scope["method"] == "POST" and path == ROBOTS) or (
        scope["method"] == "PATCH" and path.startswith(f"{ROBOTS}/")
    )


def _starts_work(scope: Scope) -> bool:
    if is_reading_robot(scope):
        return True
    if scope["method"] == "POST" and _STARTS_NOTHING.fullmatch(path_of(scope)) is None:
        return True
    return is_encoding(scope)


def export_load(scope: Scope) -> Load | None:
    """Return what an export costs that a request asks for; None if it asks for none."""
    found = _OF_RUN.fullmatch(path_of(scope))
    export = None if found is None else EXPORTS.get(found[1])
    return None if export is None else export.load


def is_encoding(scope: Scope) -> bool:
    """Whether a request asks for a file that takes seconds to minutes to encode."""
    if export_load(scope) == "encode":
        return True
    if _RECORDING.fullmatch(path_of(scope)) is None:
        return False
    # Decoded as the endpoint decodes it, so that percent-encoding cannot bypass the limit.
    return "viser" in QueryParams(scope["query_string"]).getlist("format")
