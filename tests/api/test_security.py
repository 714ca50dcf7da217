"""Authentication, Host and Origin checks of every route, found by iteration over the app."""

import asyncio
import re
from collections.abc import Callable
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.testclient import TestClient
from starlette.types import Message, Scope

from app.api.auth import WRONG_TOKENS
from app.api.cookies import NAME
from app.api.memory_limit import MAX_BODY_BYTES
from app.api.policy import Access, policies, policy_without_route
from tests.api.calls import Api, refused

TOKEN = "a-token-for-tests"
COOKIE = f"{NAME}_8000"
SAFE = {"GET", "HEAD"}
WHAT_IF, ROBOTS = "/api/v1/what-if", "/api/v1/robots"
PROBLEMS = ("/problems", "/problems/{name}")
VIEWS = {"/runs", "/compare", "/experiments", "/lessons"}
"""Addresses of the page, which has no data in it."""
OPERATORS_READ = {"/l/{lesson_id}/sheet"}
"""Pages that have answers of lessons."""
BY_CODE = {
    "/api/v1/rooms/{code}",
    "/api/v1/rooms/{code}/participants",
    "/r/{code}",
    "/r/{code}/",
}
OPEN_BY_CODE = {("post", "/api/v1/rooms/{code}/participants")}
"""What a room's code is enough for: all paths, and what is no read."""
EVERYWHERE: tuple[dict[str, str], ...] = (
    *(
        {"Host": "evil.example"},
        {"Origin": "http://evil.example"},
        {"Sec-Fetch-Site": "cross-site"},
    ),
    *({}, {"Host": "lab.example", "Origin": "http://lab.example"}),
)
"""Headers that are tried on every route."""
Serve = Callable[..., Api]


def every_route(client: TestClient) -> list[tuple[str, str]]:
    """Return (method, path) of all routes."""
    app = client.app
    assert isinstance(app, FastAPI)
    routes = []
    for route in iter_route_contexts(app.routes):
        path = (route.path or "").replace("{run_id}", "none")
        if path == "/static":
            routes.append(("GET", "/static/favicon.svg"))
        else:
            routes += [(method, path) for method in sorted(route.methods or ())]
    assert len(routes) > 30
    return routes


def answer(client: TestClient, method: str, path: str, headers: dict[str, str]) -> int:
    """Return the response's status."""
    response = client.request(method, path, headers=headers)
    if response.status_code >= 400 and method != "HEAD":
        refused(response, response.status_code)
    return response.status_code


def routes_for(client: TestClient, headers: dict[str, str]) -> list[tuple[str, str]]:
    """Return every route for one case of each header, and for the other cases one of each method.

    What looks at these headers knows no routes: it stands before all of them.
    """
    routes = every_route(client)
    if headers in EVERYWHERE:
        return routes
    return list({method: (method, path) for method, path in routes}.values())


def without_stream(routes: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Omit the event stream: a response that is not a refusal would not end."""
    return [(method, path) for method, path in routes if path != "/api/v1/events"]


def changing(routes: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the routes that change something."""
    return [(method, path) for method, path in routes if method not in SAFE]


def access_of(client: TestClient, method: str, path: str) -> Access:
    """Return the access of a route, as its policy has it."""
    app = client.app
    assert isinstance(app, FastAPI)
    template = re.sub(":(path|robot)}", "}", path.replace("none", "{run_id}"))
    template = "/static" if path.startswith("/static") else template
    read = "get" if method in SAFE else method.lower()
    return policies(app)[read, template].access


def test_policies_open_to_spectators_what_they_are_meant_to(shared: Serve) -> None:
    """Of what changes or computes something; by hand, so that a slip in a policy is seen."""
    app = shared().client.app
    assert isinstance(app, FastAPI)
    everything = policies(app)
    assert ("post", "/api/v1/trainings") in everything
    for (method, path), policy in everything.items():
        if method not in ("get", "head"):
            assert not policy.access.is_read, (method, path)
        else:
            assert policy.access.is_read != (path in OPERATORS_READ), (method, path)
    opened = {
        operation
        for operation, policy in everything.items()
        if policy.access.spectators != "never" and operation[0] not in ("get", "head")
    }
    assert opened == {("post", WHAT_IF), ("post", f"{ROBOTS}/preview"), *OPEN_BY_CODE}
    public = {
        path for (_, path), policy in everything.items() if policy.access.spectators == "always"
    }
    assert public == {"/", *VIEWS, *PROBLEMS, "/healthz", "/readyz", "/static", *BY_CODE}
    assert policy_without_route({"type": "http", "method": "PUT"}).access.spectators == "never"


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:8000"},
        {"Host": "127.0.0.1.evil.example"},
        {"Host": "localhost.evil.example"},
        {"Host": ""},
        {"Host": "user@127.0.0.1"},
        {"Host": "127.0.0.1/x"},
        {"Origin": "http://evil.example"},
        {"Origin": "https://127.0.0.1.evil.example"},
        {"Origin": "null"},
        {"Origin": "file://"},
        {"Origin": "http://203.0.113.7:8000"},
        {"Host": "192.168.1.5:8000", "Origin": "http://192.168.1.6:8000"},
        {"Host": "192.168.1.5:8000", "Origin": "http://localhost:8000"},
        {"Host": "192.168.1.5:8000", "Origin": "http://192.168.1.5:9000"},
        {"Origin": "http://127.0.0.1:8399"},
        {"Origin": "http://127.0.0.1"},
        {"Origin": "http://localhost:8000"},
        {"Host": "127.0.0.1:8000", "Origin": "http://localhost:9000"},
        {"Host": "localhost:8000", "Origin": "http://a.localhost:8000"},
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"},
        {"Sec-Fetch-Site": "none, cross-site"},
    ],
    ids=str,
)
def test_foreign_hosts_and_origins_are_refused(shared: Serve, headers: dict[str, str]) -> None:
    client = shared().client
    for method, path in [*routes_for(client, headers), ("GET", "/nothing")]:
        assert answer(client, method, path, headers) == 403, (method, path)


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Host": "localhost"},
        {"Host": "LOCALHOST:8000"},
        {"Host": "[::1]:8000"},
        {"Host": "192.168.1.5:8000", "Origin": "http://192.168.1.5:8000"},
        {"Host": "192.168.1.5", "Origin": "http://192.168.1.5"},
        {"Origin": "http://127.0.0.1:8000"},
        {"Origin": "http://127.0.0.1:8000", "Sec-Fetch-Site": "same-origin"},
        {"Sec-Fetch-Site": "none"},
        {"Host": "localhost", "Origin": "http://localhost:80"},
        {"Host": "lab.example", "Origin": "http://lab.example"},
        {"Host": "127.0.0.1:8000", "Origin": "https://lab.example"},
        {"Host": "hexapods.example", "Origin": "https://hexapods.example"},
        {"Host": "127.0.0.1:8000", "Origin": "https://hexapods.example"},
    ],
    ids=str,
)
def test_own_hosts_and_origins_are_accepted(shared: Serve, headers: dict[str, str]) -> None:
    client = shared(public_url="https://hexapods.example", allowed_hosts=("lab.example",)).client
    headers = {"X-Requested-With": "tests", **headers}
    for method, path in without_stream(routes_for(client, headers)):
        assert answer(client, method, path, headers) not in (401, 403), (method, path)


def test_spectator_has_read_access_only(shared: Serve) -> None:
    client = shared(token=TOKEN).client
    for method, path in without_stream(every_route(client)):
        status = answer(client, method, path, {})
        access = access_of(client, method, path)
        if access.spectators == "always":
            assert status in (200, 303, 404, 503), (method, path)
        elif access.spectators == "watching":
            assert status != 401, (method, path)
        else:
            assert status == 401, (method, path)
    for path in ("/nothing", f"{WHAT_IF}/", f"{WHAT_IF}/x"):
        refused(client.post(path), 401, "Bearer")
    refused(client.put(WHAT_IF), 401, "Bearer")


def test_reading_needs_the_token_if_so_configured(serve: Serve) -> None:
    client = serve(token=TOKEN, spectators="token").client
    for method, path in every_route(client):
        status = answer(client, method, path, {})
        if access_of(client, method, path).spectators == "always":
            assert status in (200, 404, 503), (method, path)
        else:
            assert status == 401, (method, path)


@pytest.mark.parametrize("how", ["Bearer", "bearer", "cookie"])
def test_operator_has_access_to_every_route(serve: Serve, how: str) -> None:
    client = serve(token=TOKEN, spectators="token").client
    headers = {}
    if how == "cookie":
        assert client.get(f"/?token={TOKEN}").status_code == 303
        headers = {
            "Cookie": f"{COOKIE}={client.cookies[COOKIE]}",
            "X-Requested-With": "tests",
        }
    else:
        headers["Authorization"] = f"{how} {TOKEN}"
    for method, path in without_stream(routes_for(client, headers)):
        assert answer(client, method, path, headers) not in (401, 403), (method, path)


@pytest.mark.parametrize(
    "headers",
    [
        {"Authorization": "Bearer wrong"},
        {"Authorization": "Bearer "},
        {"Authorization": f"Basic {TOKEN}"},
        {"Authorization": TOKEN},
        {"Authorization": b"Bearer t\xf6k"},
        {"Cookie": f"{COOKIE}={TOKEN}"},
        {"Cookie": f"{COOKIE}="},
        {"Cookie": "\x7f;;=;"},
    ],
    ids=str,
)
def test_wrong_credentials_are_refused(serve: Serve, headers: Any) -> None:
    client = serve(token=TOKEN).client
    response = client.put("/api/v1/stage", json={}, headers=headers)
    refused(response, 401, "token")
    assert response.headers["www-authenticate"].startswith("Bearer")


def test_token_link_sets_a_cookie_and_redirects_without_the_token(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    response = client.get(f"/?gait=x&token={TOKEN}&steps=5")
    assert response.status_code == 303
    assert response.headers["location"] == "?gait=x&steps=5"
    cookie = response.headers["set-cookie"]
    for said in ("HttpOnly", "SameSite=strict", "Path=/"):
        assert said.lower() in cookie.lower()
    assert TOKEN not in cookie
    assert client.put("/api/v1/stage", json={"playing": True}).status_code == 200
    of_view = client.get(f"/runs?token={TOKEN}", follow_redirects=False)
    assert (of_view.status_code, of_view.headers["location"]) == (303, "runs")
    refused(client.get("/?token=wrong"), 401, "not the server's token")
    page = client.get("/?token=wrong", headers={"Accept": "text/html,*/*;q=0.8"})
    assert (page.status_code, page.headers["content-type"]) == (401, "text/html; charset=utf-8")
    assert "This is not the server&#39;s token" in page.text
    secure = serve(token=TOKEN, public_url="https://hexapods.example").client
    shown = {"Host": "hexapods.example"}
    cookie = secure.get(f"/?token={TOKEN}", headers=shown).headers["set-cookie"]
    assert cookie.startswith(f"__Host-{NAME}_443=")
    assert cookie.endswith("; Secure")
    assert serve().client.get("/?token=any").headers["location"] == "./"


FORM_HEADERS = [
    {"Content-Type": "text/plain"},
    {"Content-Type": "text/plain; application/json"},
    {"Content-Type": "application/x-www-form-urlencoded"},
    {"Content-Type": "multipart/form-data; boundary=x"},
    {},
]


@pytest.mark.parametrize("headers", FORM_HEADERS, ids=str)
@pytest.mark.parametrize("mark", ["Origin", "Cookie", "Referer", "Sec-Fetch-Site"])
def test_cross_site_form_requests_are_refused(
    shared: Serve, mark: str, headers: dict[str, str]
) -> None:
    client = shared().client
    value = {"Origin": "http://127.0.0.1:8000", "Sec-Fetch-Site": "same-origin"}.get(mark, "x=y")
    for method, path in changing(every_route(client)):
        by_browser = {mark: value, **headers}
        refused(client.request(method, path, headers=by_browser), 403, "X-Requested-With")
        for header in ({"X-Requested-With": "x"}, {"Content-Type": "application/json"}):
            by_page = {**by_browser, **header}
            assert client.request(method, path, headers=by_page).status_code != 403, (method, path)


@pytest.mark.parametrize("headers", FORM_HEADERS, ids=str)
def test_form_requests_of_other_programs_need_no_header(
    shared: Serve, headers: dict[str, str]
) -> None:
    client = shared().client
    for method, path in changing(every_route(client)):
        assert client.request(method, path, headers=headers).status_code != 403, (method, path)


def test_links_from_other_sites_can_be_followed(serve: Serve) -> None:
    headers = {
        "Sec-Fetch-Site": "cross-site",
        "Sec-Fetch-Mode": "navigate",
        "Sec-Fetch-Dest": "document",
    }
    client = serve(token=TOKEN).client
    assert client.get("/", headers=headers).status_code == 200
    assert client.get(f"/?token={TOKEN}", headers=headers).status_code == 303
    refused(client.post("/api/v1/trainings", headers=headers), 403, "another origin")


def test_wrong_session_cookies_are_rate_limited_like_tokens(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    statuses = [
        client.get("/healthz", headers={"Cookie": f"{COOKIE}=guess-{number}"}).status_code
        for number in range(500)
    ]
    assert statuses[:WRONG_TOKENS] == [200] * WRONG_TOKENS
    assert statuses.count(429) > 400
    # A browser's expired session cookie is deleted, so that it is a spectator again.
    answer = client.get("/healthz", headers={"Cookie": f"{COOKIE}=guess"})
    refused(answer, 429, "wrong tokens")
    assert f"{COOKIE}=; Max-Age=0" in answer.headers["set-cookie"]
    assert client.get("/healthz").status_code == 200


def test_every_response_has_security_headers(shared: Serve) -> None:
    client = shared().client
    for method, path in without_stream(every_route(client)):
        headers = client.request(method, path).headers
        assert headers["x-content-type-options"] == "nosniff", path
        assert "frame-ancestors 'self'" in headers["content-security-policy"], path
        assert headers["referrer-policy"] == "same-origin", path
    page = client.get("/").headers["content-security-policy"]
    assert "script-src 'self' 'sha256-" in page
    assert "unsafe-inline" not in page.partition("script-src")[2].partition(";")[0]


@pytest.mark.parametrize("path", ["/", "/viewer/", "/static/favicon.svg", "/api/v1/events", "/x"])
def test_app_speaks_no_other_protocol_than_http(shared: Serve, path: str) -> None:
    """No guard knows websockets; a server that speaks them gets an error for each."""
    client = shared().client
    scope: Scope = {"type": "websocket", "path": path, "headers": [], "query_string": b""}

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        raise AssertionError(message)

    async def connect() -> None:
        await client.app(scope, receive, send)

    with pytest.raises(RuntimeError, match="HTTP alone, not websocket"):
        asyncio.run(connect())


def test_request_bodies_are_limited(serve: Serve) -> None:
    api = serve()
    large = b"x" * (MAX_BODY_BYTES + 1)
    refused(api.call("POST", "/trainings", content=large), 413, "1,048,576")
    chunks = (b"x" * 65536 for _ in range(32))
    refused(api.call("POST", "/trainings", content=chunks), 413, "1,048,576")
    refused_body = b'{"steps": 0}'
    exact = refused_body.rjust(MAX_BODY_BYTES)
    json: Any = {"Content-Type": "application/json"}
    refused(api.call("POST", "/trainings", content=exact, headers=json), 422, "steps")
    refused(api.client.post("/api/v1/trainings/import", content=large), 422, "The file")
    refused(
        api.client.post("/api/v1/trainings/import", headers={"Content-Length": "99999999999"}), 413
    )
