"""Part of promise 28: no single request of a stranger can stop the server.

Headers and cookies are taken from the app's declarations, routes with their parameters and the
fields of their bodies from the app. Each is sent at its largest and worst, without a token, to a
demo that is open to everyone, and may cost 0.1 s of the server's processor; `/healthz` is asked
beside it all the time, and answers within 1 s. In full by `make soak`: every header and cookie
on every route with the values that cost most, and every value in every path, parameter and field.
The gate sends each header and cookie to one route, and to each route what has cost most.
"""

import itertools
import logging
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import httpx2
import pytest
from starlette.testclient import TestClient
from starlette.types import Receive, Scope, Send

from app.api.request_headers import MAX_BYTES, READ, READ_BEFORE, DeclaredHeaders
from tests.promises.length import at_length, only_whole
from tests.promises.raw import UPGRADE, Route, every_route
from tests.promises.worst_requests import (
    ADMITTED_BYTES,
    LARGE_BYTES,
    NAMES,
    Strangers,
    addresses,
    bodies,
    cookies,
    fields_of,
    headers,
    request,
    worst_framings,
)
from tests.served import Served, serving_from
from tests.timeouts import LONG_S

LIMIT_S = 0.1
"""Of the server's processor, for one request."""
MAX_HEALTH_S = at_length(LONG_S, 1.0)
"""The gate shares the machine with other tests, so that there the answer alone counts."""
TOKEN = "only-the-operator-knows-this"
WORST_VALUES = 3
"""Of each header, which are sent to every route in the long form."""
READ_HERE = "/api/v1/experiments"
"""A route for the headers in the gate: past all middleware, and to the database."""
UPGRADE_LINES = {name.lower(): value for name, value in UPGRADE.items()}
_logger = logging.getLogger(__name__)


class Demo(NamedTuple):
    """A server that is open to strangers, and what it says of its routes."""

    strangers: Strangers
    port: int
    routes: list[Route]
    parameters: dict[tuple[str, str], tuple[str, ...]]
    """Names of query parameters by method and path."""
    fields: dict[tuple[str, str], tuple[str, ...]]
    """Names of the members of JSON bodies by method and path."""


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Demo]:
    with serving_from(tmp_path_factory.mktemp("data")) as make:
        server = make(
            HEXAPODS_TOKEN=TOKEN, HEXAPODS_DEMO="1", HEXAPODS_TRUSTED_PROXIES="127.0.0.0/8"
        )
        port = int(server.address.rpartition(":")[2])
        yield described(server, port)


def described(server: Served, port: int) -> Demo:
    document = server.client.get(
        "/openapi.json", headers={"Authorization": f"Bearer {TOKEN}"}
    ).json()
    # Later requests are not to pay for what the first of its kind does once.
    assert server.client.get("/api/v1/experiments").status_code == 200
    routes = every_route()
    parameters, fields = {}, {}
    for method, path in routes:
        operation = document["paths"].get(path, {}).get(method.lower(), {})
        parameters[method, path] = tuple(
            parameter["name"]
            for parameter in operation.get("parameters", ())
            if parameter["in"] == "query"
        )
        fields[method, path] = fields_of(document, method, path)
    assert any(parameters.values())
    assert any(fields.values())
    return Demo(Strangers(server.process.pid, port), port, routes, parameters, fields)


@contextmanager
def asked_beside(port: int) -> Iterator[None]:
    """Ask for the server's health all the time, and require answers in time."""
    finished = threading.Event()
    waits_s: list[float] = []

    def ask() -> None:
        with httpx2.Client(timeout=LONG_S, trust_env=False, verify=False) as client:
            while not waits_s or not finished.wait(0.05):
                began_s = time.perf_counter()
                assert client.get(f"http://127.0.0.1:{port}/healthz").status_code == 200
                waits_s.append(time.perf_counter() - began_s)

    asker = threading.Thread(target=ask)
    asker.start()
    try:
        yield
    finally:
        finished.set()
        asker.join()
    assert waits_s
    _logger.info("%d answers of /healthz, the slowest after %.3f s", len(waits_s), max(waits_s))
    assert max(waits_s) < MAX_HEALTH_S


def check_costs(demo: Demo, requests: Iterator[tuple[str, bytes]]) -> None:
    """Send requests, and require that each costs no more than it may."""
    costs: dict[str, float] = {}
    with asked_beside(demo.port):
        for what, data in requests:
            cost = demo.strangers.cost(data, LIMIT_S)
            costs[f"{what}: {cost.status}"] = cost.processor_s
    worst = sorted(costs.items(), key=lambda item: -item[1])[:10]
    _logger.info("%d requests; the worst cost %s", len(costs), worst)
    assert worst[0][1] <= LIMIT_S, worst


def test_headers_and_cookies_at_their_worst(demo: Demo) -> None:
    def requests() -> Iterator[tuple[str, bytes]]:
        for name, what, value in headers(demo.port):
            for size in (ADMITTED_BYTES, LARGE_BYTES):
                line = {name: value(size)}
                yield f"{name}: {what}, {size}", request("GET", READ_HERE, demo.port, line)
                if name in READ_BEFORE:
                    yield (
                        f"{name} of an upgrade: {what}, {size}",
                        request("GET", "/viewer/", demo.port, UPGRADE_LINES | line),
                    )

    check_costs(demo, requests())


@only_whole
@pytest.mark.timeout(1800)
def test_each_header_at_its_worst_on_every_route(demo: Demo) -> None:
    """Those values of each header that cost most on one route are sent to all others."""
    costs: dict[str, list[tuple[float, str, str]]] = {}
    for name, what, value in headers(demo.port):
        content = value(ADMITTED_BYTES)
        cost = demo.strangers.cost(request("GET", READ_HERE, demo.port, {name: content}), 0.0)
        costs.setdefault(name, []).append((cost.processor_s, what, content))

    def requests() -> Iterator[tuple[str, bytes]]:
        for (method, path), (name, measured) in itertools.product(demo.routes, costs.items()):
            target = path.replace("{", "").replace("}", "")
            for _, what, content in sorted(measured)[-WORST_VALUES:]:
                data = request(method, target, demo.port, {name: content})
                yield f"{method} {path} {name}: {what}", data

    check_costs(demo, requests())


def test_every_route_with_the_worst_cookies(demo: Demo) -> None:
    def requests() -> Iterator[tuple[str, bytes]]:
        worst = [(what, v) for what, v in cookies(demo.port) if "escaped" in what or "room" in what]
        for (method, path), (what, value) in itertools.product(
            demo.routes, at_length(worst[-2:], worst)
        ):
            target = path.replace("{", "").replace("}", "")
            line = {"cookie": value(ADMITTED_BYTES)}
            yield f"{method} {path} {what}", request(method, target, demo.port, line)

    check_costs(demo, requests())


@pytest.mark.timeout(1800)
def test_paths_and_queries_at_their_worst(demo: Demo) -> None:
    in_gate = ("a line below", "many times", "slashes", "percents", "ampersands")

    def requests() -> Iterator[tuple[str, bytes]]:
        for method, path in demo.routes:
            for what, target in addresses(path, demo.parameters[method, path]):
                if at_length(any(what.startswith(kind) for kind in in_gate), True):
                    yield f"{method} {path} {what}", request(method, target, demo.port, {})

    check_costs(demo, requests())


@pytest.mark.timeout(1800)
def test_bodies_at_their_worst(demo: Demo) -> None:
    in_gate = ("many lists", "many members")

    def requests() -> Iterator[tuple[str, bytes]]:
        for method, path in demo.routes:
            if method not in ("POST", "PUT", "PATCH"):
                continue
            fields = demo.fields[method, path]
            for what, body in bodies(at_length(fields[:1], fields)):
                if at_length(what in in_gate, True):
                    target = path.replace("{", "").replace("}", "")
                    line = {"content-type": "application/json"}
                    yield f"{method} {path} {what}", request(method, target, demo.port, line, body)

    check_costs(demo, requests())


def test_heads_and_framings_at_their_worst(demo: Demo) -> None:
    check_costs(demo, worst_framings(demo.port))


def test_the_app_reads_declared_headers_and_cookies_alone() -> None:
    """What is not declared reaches no code, so that no code can come to read it unnoticed."""
    seen: list[Scope] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        del receive
        seen.append(scope)
        await send({"type": "http.response.start", "status": 204, "headers": []})
        await send({"type": "http.response.body"})

    cookie = "; ".join(["a=b", *(f"{name}_80=x" for name in NAMES)])
    sent = {"range": "bytes=0-1", "x-new": "1", "cookie": cookie, "accept": "text/html"}
    response = TestClient(DeclaredHeaders(app)).get("/", headers=sent)
    assert response.status_code == 204
    (scope,) = seen
    passed = {name.decode(): value for name, value in scope["headers"]}
    assert set(passed) <= READ
    assert passed["accept"] == b"text/html"
    assert passed["cookie"] == b"", "read by cookies_of alone"
    assert scope["state"]["cookies"] == {f"{name}_80": "x" for name in NAMES}


def test_header_parameters_of_routes_are_declared(tmp_path: Path) -> None:
    with serving_from(tmp_path) as make:
        document = make().client.get("/openapi.json").json()
    named = {
        parameter["name"].lower()
        for operations in document["paths"].values()
        for operation in operations.values()
        for parameter in operation.get("parameters", ())
        if parameter["in"] == "header"
    }
    assert named
    assert named <= READ


@pytest.mark.parametrize("name", sorted(READ - {"content-length", "transfer-encoding", "host"}))
def test_a_longer_header_is_refused(demo: Demo, name: str) -> None:
    line = {name: "a" * (MAX_BYTES + 1)}
    cost = demo.strangers.cost(request("GET", "/", demo.port, line), LIMIT_S)
    assert cost.status == 431
