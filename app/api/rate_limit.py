"""How often one address may start what costs the machine something."""

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
_FILM = re.compile(r"/api/v1/races/[^/]+/recording")


class RateLimit:
    """Lets each address, in each role, start so many runs a minute, and no more.

    Beside runs these count: imports, resuming, and a race's film, which takes seconds to make.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Limit an app as the settings say; inside of what finds out the role."""
        self._app = app
        self._per_minute = settings.starts_per_minute
        self._buckets = RateLimiter(self._per_minute, self._per_minute / 60)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or answer 429."""
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
    """Say that it is enough for now, and when it will not be."""
    return problem(429, detail, headers={"Retry-After": str(max(1, math.ceil(wait_s)))})


def _starts_work(scope: Scope) -> bool:
    if scope["type"] != "http":
        return False
    if scope["method"] == "POST":
        return _STARTS.fullmatch(scope["path"]) is not None
    if _FILM.fullmatch(scope["path"]) is None:
        return False
    # As the endpoint reads it, however it is encoded.
    return "viser" in QueryParams(scope["query_string"]).getlist("format")
