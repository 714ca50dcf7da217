"""Rate limits of starts, by token buckets per client address, and of kinds of work."""

import math

from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.policy import policy_of, work_of
from app.api.problems import problem
from app.limits.addresses import client_of
from app.limits.token_bucket import RateLimiter
from app.setting_fields import PREFIX
from app.settings import Settings


class RateLimit(HttpMiddleware):
    """Guard that limits starts per minute, by client address and role.

    It counts what a policy declares as a start, and what takes seconds to encode. A kind of work
    may have an allowance of its own in place of that.
    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Wrap an app; to be installed inside `TokenGuard`, which sets the role.

        Args:
            app: the wrapped app.
            settings: settings of the server.
        """
        super().__init__(app)
        self._per_minute = settings.starts_per_minute
        self._buckets = RateLimiter(self._per_minute, self._per_minute / 60)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or respond 429."""
        refusal = self._refusal(scope)
        await (self._app if refusal is None else refusal)(scope, receive, send)

    def _refusal(self, scope: Scope) -> Response | None:
        work = work_of(scope)
        if work.refusal is not None:
            return work.refusal(scope)
        if not (policy_of(scope).starts or work.counts_as_start):
            return None
        wait_s = self._buckets.take(f"{scope['state']['role']} {client_of(scope)}")
        detail = (
            f"One address may start {self._per_minute} times a minute here; try again later, "
            f"or raise {PREFIX}STARTS_PER_MINUTE."
        )
        return too_many(detail, wait_s) if wait_s > 0 else None


def too_many(detail: str, wait_s: float) -> Response:
    """Return a 429 response whose Retry-After is the wait, rounded up to at least 1 s."""
    return problem(429, detail, headers={"Retry-After": str(whole_seconds(wait_s))})


def whole_seconds(wait_s: float) -> int:
    """Return a wait for a Retry-After header: rounded up, and at least 1 s."""
    return max(1, math.ceil(wait_s))
