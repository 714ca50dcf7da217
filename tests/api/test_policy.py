"""Policies of routes: one is needed to define a route, and guards run before a body is read."""

import asyncio
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.responses import PlainTextResponse
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.policy import (
    OPERATOR,
    PUBLIC,
    WATCH,
    Access,
    GuardedPage,
    MissingPolicy,
    RoutePolicy,
    api_router,
    guard_everything,
    policies,
    policy,
)
from tests.api.guarding import let_all_pass


def small_app() -> FastAPI:
    """An app with a command below a prefix, and a page."""
    router, nested = api_router(), api_router()

    @nested.post("/things/{thing}")
    @policy(access=OPERATOR, starts=True)
    def change(thing: str, body: dict[str, int]) -> dict[str, int]:
        return body

    router.include_router(nested, prefix="/api")
    app = FastAPI(routes=[*router.routes], openapi_url=None)

    @policy(access=PUBLIC)
    async def page(request: object) -> PlainTextResponse:
        return PlainTextResponse("page")

    app.router.routes.append(GuardedPage("/page", page))
    return app


def guarded_request(app: FastAPI, method: str, path: str) -> tuple[list[RoutePolicy], int, int]:
    """Return the policies that guards got for a request, its status, and how often it was read."""
    seen: list[RoutePolicy] = []
    reads, statuses = 0, [0]

    async def refuse_operators(
        policy: RoutePolicy, route: ASGIApp, scope: Scope, receive: Receive, send: Send
    ) -> None:
        seen.append(policy)
        refused = policy.access is OPERATOR
        answer = PlainTextResponse("no", 401) if refused else route
        await answer(scope, receive, send)

    async def receive() -> Message:
        nonlocal reads
        reads += 1
        return {"type": "http.request", "body": b"{}", "more_body": False}

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            statuses[0] = message["status"]

    guard_everything(app, refuse_operators)
    scope: dict[str, Any] = {"type": "http", "method": method, "path": path, "state": {}}
    scope |= {"query_string": b"", "headers": [], "scheme": "http", "server": ("a", 80)}
    asyncio.run(app(scope, receive, send))
    return seen, statuses[0], reads


def test_guards_get_the_policy_of_the_route_before_its_body_is_read() -> None:
    seen, status, reads = guarded_request(small_app(), "POST", "/api/things/1")
    assert [(policy.access, policy.starts) for policy in seen] == [(OPERATOR, True)]
    assert (status, reads) == (401, 0)
    seen, status, _ = guarded_request(small_app(), "GET", "/page")
    assert [policy.access for policy in seen] == [PUBLIC]
    assert status == 200


@pytest.mark.parametrize(
    ("method", "path", "access", "status"),
    [
        ("GET", "/nothing", WATCH, 404),
        ("POST", "/nothing", OPERATOR, 401),
        ("GET", "/api/things/1", WATCH, 405),
        ("PUT", "/page", OPERATOR, 401),
        ("GET", "/page/", WATCH, 307),
    ],
)
def test_what_no_route_answers_is_guarded(
    method: str, path: str, access: Access, status: int
) -> None:
    seen, got, _ = guarded_request(small_app(), method, path)
    assert [policy.access for policy in seen] == [access]
    assert got == status


def test_no_route_is_added_without_a_policy() -> None:
    def endpoint() -> None:
        """An endpoint without a policy."""

    with pytest.raises(MissingPolicy, match="the route /x has no policy; say who may use it"):
        api_router().get("/x")(endpoint)
    with pytest.raises(MissingPolicy, match="/x"):
        GuardedPage("/x", endpoint)
    app = small_app()
    app.router.routes.append(Route("/plain", endpoint))
    with pytest.raises(MissingPolicy, match="/plain"):
        guard_everything(app, let_all_pass)


def test_a_page_below_a_router_is_refused_since_it_would_not_be_guarded() -> None:
    router = api_router()
    router.routes.append(GuardedPage("/page", lambda request: None, RoutePolicy(access=PUBLIC)))
    app = FastAPI(openapi_url=None)
    app.include_router(router)
    with pytest.raises(MissingPolicy, match="/page"):
        guard_everything(app, let_all_pass)


def test_policies_are_listed_by_method_and_path() -> None:
    listed = policies(small_app())
    assert listed["post", "/api/things/{thing}"].starts
    assert listed["get", "/page"].access is PUBLIC
