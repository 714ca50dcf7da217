"""Rate limits of starts and of spectators' what-ifs: token buckets per client address."""

import math

from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.identity import Identity
from app.api.middleware import HttpMiddleware
from app.api.policy import policy_of, work_of
from app.api.problems import problem
from app.limits.addresses import client_of
from app.limits.token_bucket import RateLimiter
from app.setting_fields import PREFIX
from app.settings import Settings


class RateLimit(HttpMiddleware):
    """Guard that limits starts per minute, by client address and role.

    It counts what a policy declares as a start, and what takes seconds to encode. What-ifs of
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
        work = work_of(scope)
        if work == "what-if":
            wait_s = self._what_ifs.take(asker_of(scope))
            detail = what_ifs_used_up(self._what_ifs_per_minute, wait_s)
        elif policy_of(scope).starts or work == "encoding":
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


def asker_of(scope: Scope) -> str:
    """Return who is charged for a what-if: an identity, or an address, which many may share."""
    identity: Identity | None = scope["state"]["identity"]
    if identity is not None and identity.limited_as is not None and work_of(scope) == "what-if":
        return identity.limited_as
    return client_of(scope)


def too_many(detail: str, wait_s: float) -> Response:
    """Return a 429 response whose Retry-After is the wait, rounded up to at least 1 s."""
    return problem(429, detail, headers={"Retry-After": str(whole_seconds(wait_s))})


def whole_seconds(wait_s: float) -> int:
    """Return a wait for a Retry-After header: rounded up, and at least 1 s."""
    return max(1, math.ceil(wait_s))
