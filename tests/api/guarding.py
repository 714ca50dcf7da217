"""Helpers for tests of single guards, and of pages in an app without guards."""

from typing import Any

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.policy import PUBLIC, RoutePolicy


async def let_all_pass(
    policy: RoutePolicy, app: ASGIApp, scope: Scope, receive: Receive, send: Send
) -> None:
    """Guard nothing."""
    del policy
    await app(scope, receive, send)


def admitted(role: str, policy: RoutePolicy | None = None) -> dict[str, Any]:
    """Return the state of a request that `TokenGuard` has let pass."""
    return {"role": role, "identity": None, "policy": policy or RoutePolicy(access=PUBLIC)}
