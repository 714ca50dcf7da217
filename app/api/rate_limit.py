"""Rate limit of starts: a token bucket per client address and role."""

import math
import re

from starlette.datastructures import QueryParams
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.problems import problem
from app.limits.addresses import client_of
from app.limits.token_bucket import RateLimiter
from app.settings import PREFIX, Settings

_STARTS = re.compile(r"/api/v1/(?!stage$|events$)\w+(/import|/[^/]+/resume)?")
_RECORDING = re.compile(r"/api/v1/races/[^/]+/recording")
_ENCODED = re.compile(r"/api/v1/runs/[^/]+/(mcap|page|video)")


class RateLimit:
    """Middleware that limits starts per minute, by client address and role.

    Besides runs it counts imports, resumes, and what takes seconds to encode: a race's recorded
    stream, pages that need no server, videos and logs.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Wrap an app; to be installed inside `TokenGuard`, which sets the role."""
        self._app = app
        self._per_minute = settings.starts_per_minute
        self._buckets = RateLimiter(self._per_minute, self._per_minute / 60)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or respond 429."""
        if not _starts_work(scope):
            await self._app(scope, receive, send)
            return
        wait_s = self._buckets.take(f"{scope['state']['role']} {client_of(scope)}")
        if wait_s == 0:
            await self._app(scope, receive, send)
            return
        detail = (
            f"One address may start {self._per_minute} times a minute here; try again later, or "
            f"raise {PREFIX}STARTS_PER_MINUTE."
        )
        await too_many(detail, wait_s)(scope, receive, send)


def too_many(detail: str, wait_s: float) -> Response:
    """Return a 429 response whose Retry-After is the wait, rounded up to at least 1 s."""
    return problem(429, detail, headers={"Retry-After": str(max(1, math.ceil(wait_s)))})


def _starts_work(scope: Scope) -> bool:
    if scope["type"] != "http":
        return False
    if scope["method"] == "POST" and _STARTS.fullmatch(scope["path"]) is not None:
        return True
    if _ENCODED.fullmatch(scope["path"]) is not None:
        return True
    if _RECORDING.fullmatch(scope["path"]) is None:
        return False
    # Decoded as the endpoint decodes it, so that percent-encoding cannot bypass the limit.
    return "viser" in QueryParams(scope["query_string"]).getlist("format")
