"""The allowance of spectators: how many what-ifs they may ask, by their number and time."""

from starlette.responses import Response
from starlette.types import Scope

from app.api.deps import Services
from app.api.identity import charged_client
from app.api.rate_limit import too_many, whole_seconds
from app.api.work import Slots, Work
from app.features.what_if.settings import WhatIfSettings
from app.limits.token_bucket import RateLimiter
from app.setting_fields import variable_of
from app.storage.errors import Busy


class WhatIfAllowance:
    """A token for each what-if, and for each further second that it takes, by client."""

    def __init__(self, settings: WhatIfSettings) -> None:
        """Start with all that spectators may ask in a minute."""
        self._per_minute = settings.what_ifs_per_minute
        self._limiter = RateLimiter(self._per_minute, self._per_minute / 60)

    def take(self, client: str) -> Response | None:
        """Charge a client for a what-if, and return the refusal if it has none left."""
        wait_s = self._limiter.take(client)
        return too_many(self._used_up(wait_s), wait_s) if wait_s > 0 else None

    def check(self, client: str) -> None:
        """Check that a client has been charged for no more than it has.

        Raises:
            Busy: if those before have taken more.
        """
        if (wait_s := self._limiter.debt_s(client)) > 0:
            raise Busy(self._used_up(wait_s), whole_seconds(wait_s))

    def charge(self, client: str, seconds: float) -> None:
        """Charge a client for the time that a what-if took beyond its first second."""
        self._limiter.charge(client, max(0.0, seconds - 1.0))

    def _used_up(self, wait_s: float) -> str:
        return (
            f"Spectators of one address may ask {self._per_minute} times a minute here, and one "
            "that takes longer than a second counts as many times; ask again in "
            f"{whole_seconds(wait_s)} s. {variable_of('what_ifs_per_minute')} sets how often."
        )


def _refusal(scope: Scope) -> Response | None:
    services: Services = scope["app"].state.services
    return services.of(WhatIfAllowance).take(charged_client(scope))


WHAT_IF = Work(name="what-if", spectators=Slots(1, 1), operators=None, refusal=_refusal)
"""A what-if takes all cores: that of an operator waits for one of spectators."""
