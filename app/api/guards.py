"""The guards of all routes in their order: access, rates, memory of bodies, slots for work."""

from collections.abc import Mapping
from typing import Any

from starlette.middleware.exceptions import ExceptionMiddleware
from starlette.types import ASGIApp, Receive, Scope, Send

from app.active_features import Features
from app.api.auth import TokenGuard
from app.api.concurrency_limit import ConcurrencyLimit, WorkSlots
from app.api.memory_limit import BodyMemoryLimit
from app.api.policy import RoutePolicy
from app.api.rate_limit import RateLimit
from app.settings import Settings


class RouteGuards:
    """Runs the guards of a request that has matched a route, before a byte of its body is read."""

    def __init__(
        self,
        settings: Settings,
        slots: WorkSlots,
        features: Features,
        handlers: Mapping[Any, Any] | None = None,
    ) -> None:
        """Create the chain of guards around the call of a route.

        Args:
            settings: settings of the server.
            slots: slots for all kinds of work.
            features: identify clients who are no operators, and hide runs.
            handlers: exception handlers of the app, by exception: what a route raises, such as a
                404, is answered inside the guards.
        """
        # Unexpected errors are for the app's own handler, which raises them again.
        expected = {
            kind: handler for kind, handler in (handlers or {}).items() if kind is not Exception
        }
        answered = ExceptionMiddleware(_call_route, expected)
        limited = BodyMemoryLimit(ConcurrencyLimit(answered, slots))
        counted = RateLimit(limited, settings)
        self._first = TokenGuard(counted, settings, features)

    async def __call__(
        self, policy: RoutePolicy, route: ASGIApp, scope: Scope, receive: Receive, send: Send
    ) -> None:
        """Call a route if all guards let the request pass, or refuse it."""
        scope["state"].update(policy=policy, guarded_route=route)
        await self._first(scope, receive, send)


async def _call_route(scope: Scope, receive: Receive, send: Send) -> None:
    route: ASGIApp = scope["state"]["guarded_route"]
    await route(scope, receive, send)
