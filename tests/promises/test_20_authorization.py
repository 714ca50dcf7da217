"""Promise 20: nothing is unguarded: each route has its role.

In full: routes are enumerated from the app, so that new ones are covered; spectators can change
nothing by any of them, and their page offers no control that would be refused, of which the gate
presses those with one label once. A what-if is a question, which changes nothing.
"""

import json
import time
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import pytest
from playwright.sync_api import Page, Request, expect

from tests.browser.dashboard import PATIENCE_MS, Dashboard
from tests.browser.serving import Serving, serving
from tests.promises.length import at_length
from tests.promises.raw import UPGRADE, Route, accesses, every_route, request_lines, send, status_of

TOKEN = "a-token-for-tests"
READS = {"GET", "HEAD"}
WHAT_IF, PREVIEW = "/api/v1/what-if", "/api/v1/robots/preview"
FOR_ANYONE = {
    *("/", "/runs", "/compare", "/experiments", "/lessons"),
    *("/healthz", "/readyz", "/static/favicon.svg"),
    # What each type of an error means, which who is refused may read, too.
    *("/problems", "/problems/{name}"),
}
OPERATORS_READ = {"/l/{lesson_id}/sheet"}
"""Accessible without the token: the page, which asks for it, and the health checks."""
BY_CODE = {
    ("GET", "/api/v1/rooms/{code}"),
    ("POST", "/api/v1/rooms/{code}/participants"),
    *((method, f"/r/{{code}}{end}") for method in ("GET", "HEAD") for end in ("", "/")),
}
"""Accessible to whoever has the code of a room."""
STARTED = ("/api/v1/trainings", "/api/v1/races", "/api/v1/experiments")
OPERATOR = f"Authorization: Bearer {TOKEN}"
VALID_BODIES: dict[str, Any] = {
    "/api/v1/trainings": {"gait": "left-right-origin", "simulator": "kinematic", "steps": 5},
    "/api/v1/races": {"gait": "left-right-origin", "lanes": [{"agent": "greedy"}]},
    "/api/v1/experiments": {"experiment": "sweep", "simulator": "kinematic", "seeds": 1},
    WHAT_IF: {"gait": "left-right-origin", "steps": 5},
    PREVIEW: {"gait": "left-right-origin"},
    "/api/v1/stage": {"playing": False, "speed": 4, "clock": "free"},
    "/api/v1/trainings/{run_id}": {"pace": 1},
}


def role_of(route: Route) -> str:
    """Return the role that a route must require."""
    if route.path in OPERATORS_READ:
        return "operator"
    if route.method not in READS and route.path not in (WHAT_IF, PREVIEW):
        return "operator"
    return "anyone" if route.path in FOR_ANYONE else "spectator"


def is_open_by_code(route: Route) -> bool:
    """Whether the code of a room is all that a route requires."""
    return (route.method, route.path) in BY_CODE


def test_the_policy_of_each_route_is_its_role() -> None:
    """What is open is listed by hand above; all else is as the policies say."""
    spectators = {"operator": "never", "spectator": "watching", "anyone": "always"}
    for route in every_route():
        role = "anyone" if is_open_by_code(route) else role_of(route)
        assert accesses()[route].spectators == spectators[role], route


def status_for(server: Serving, route: Route, run_id: str, *headers: str) -> int:
    """Return the status of an otherwise valid request."""
    lines = request_lines(
        Route(route.method, route.path.replace("{run_id}", run_id)), f"127.0.0.1:{server.port}"
    )
    body = b""
    if route.path in VALID_BODIES and route.method not in READS:
        body = json.dumps(VALID_BODIES[route.path]).encode()
        lines = [line for line in lines if not line.startswith("Content-Length")]
        lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
    return status_of(send(server.port, *lines, *headers, body=body))


def state_of(server: Serving) -> Any:
    """Return all state that a request could change."""
    paths = (*STARTED, "/api/v1/stage")
    lines = [f"Host: 127.0.0.1:{server.port}", OPERATOR]
    answers = [send(server.port, f"GET {path} HTTP/1.1", *lines) for path in paths]
    state = [json.loads(answer.partition(b"\r\n\r\n")[2]) for answer in answers]
    # These change by themselves.
    for name in ("time_s", "ended", "live", "phase", "announced", "sent_s", "playhead"):
        state[-1].pop(name)
    return state


class Public(NamedTuple):
    """A server that spectators need no token for, and the id of its one run, a finished one."""

    server: Serving
    run_id: str


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with serving(tmp_path_factory.mktemp("guarded"), token=TOKEN, spectators="token") as server:
        yield server


@pytest.fixture(scope="module")
def public(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Public]:
    with serving(tmp_path_factory.mktemp("public"), token=TOKEN) as server:
        yield Public(server, finished_run(server))


def stop_runs(server: Serving) -> None:
    """Stop all runs before their processes have done much."""
    lines = (f"Host: 127.0.0.1:{server.port}", OPERATOR, "Content-Length: 0")
    for path, answer in zip(STARTED, state_of(server), strict=False):
        for run in answer["items"]:
            send(server.port, f"POST {path}/{run['id']}/stop HTTP/1.1", *lines)


def finished_run(server: Serving) -> str:
    """Start a training, wait for its end, and return its id."""
    body = json.dumps(VALID_BODIES["/api/v1/trainings"])
    lines = ["Content-Type: application/json", f"Content-Length: {len(body)}", OPERATOR]
    host = f"Host: 127.0.0.1:{server.port}"
    answer = send(server.port, "POST /api/v1/trainings HTTP/1.1", host, *lines, body=body.encode())
    run_id = str(json.loads(answer.partition(b"\r\n\r\n")[2])["id"])
    look = (f"GET /api/v1/trainings/{run_id} HTTP/1.1", host, OPERATOR)
    while b'"state":"finished"' not in send(server.port, *look):
        time.sleep(0.05)
    return run_id


def test_each_route_has_its_role_and_spectators_change_nothing(public: Public) -> None:
    server, run_id = public
    before = state_of(server)
    for route in every_route():
        status = status_for(server, route, run_id)
        if is_open_by_code(route):
            assert status in (200, 404), route
        elif role_of(route) == "operator":
            assert status == 401, route
        else:
            assert status not in (401, 403), route
    for method in ("POST", "PUT", "PATCH", "DELETE", "TRACE", "CONNECT", "MKCOL", "get"):
        for path in ("/nothing", "/metrics", "/viewer/", "/static/favicon.svg", "/docs"):
            assert status_for(server, Route(method, path), run_id) >= 400, (method, path)
    assert state_of(server) == before


def test_without_the_token_a_guarded_server_refuses_reads(guarded: Serving) -> None:
    for route in every_route():
        status = status_for(guarded, route, "none")
        if is_open_by_code(route):
            assert status in (200, 404), route
        elif role_of(route) == "anyone":
            # Nothing has the name that a path is filled with.
            assert status in ((404,) if "{" in route.path else (200, 503)), route
        else:
            assert status == 401, route


def test_the_handshake_of_a_websocket_is_a_request_as_any_other(guarded: Serving) -> None:
    handshake = [f"{name}: {value}" for name, value in UPGRADE.items()]
    for route in [*every_route(), Route("GET", "/nothing")]:
        status = status_for(guarded, route, "none", *handshake)
        assert status == status_for(guarded, route, "none"), route


def test_operators_are_accepted_on_every_route(guarded: Serving) -> None:
    for route in every_route():
        assert status_for(guarded, route, "none", OPERATOR) not in (401, 403), route
        if route.path in STARTED and route.method == "POST":
            stop_runs(guarded)


def test_a_spectators_page_offers_nothing_that_would_fail(
    page: Page, public: Public, dashboard: Dashboard
) -> None:
    requests: list[Request] = []
    # Playwright cannot inspect the signature of a builtin method.
    page.on("request", lambda request: requests.append(request))  # noqa: PLW0108
    pressed: list[str] = []
    for tab in ("", "?depth=study&tab=board", "?depth=study&tab=train", "?depth=study&tab=world"):
        dashboard.open(f"{public.server.address}{tab}")
        pressed += press_everything(page, pressed)
    page.goto(f"{public.server.address}#runs")
    expect(page.locator("li.run")).to_have_count(1, timeout=PATIENCE_MS)
    pressed += press_everything(page, pressed)
    for key in (" ", "r", "1", "2", "Enter", "s", "p", "ArrowRight", "Delete", "Escape"):
        page.keyboard.press(key)

    assert len(pressed) > 3
    changing = [
        f"{request.method} {request.url}"
        for request in requests
        if request.method not in ("GET", "HEAD")
    ]
    address = public.server.address.rstrip("/")
    assert set(changing) <= {f"POST {address}{path}" for path in (WHAT_IF, PREVIEW)}
    verbs = ("Train ", "Race", "Stop", "Pause", "Resume", "Delete", "Show on", "Start", "Go on")
    # A replay that no other page sees may be held by anybody.
    viewer_buttons = {"Races", "Pause in a replay", "Pause your replay"}
    assert not [
        words for words in pressed if words not in viewer_buttons and words.startswith(verbs)
    ]


def press_everything(page: Page, before: Sequence[str]) -> list[str]:
    """Press all enabled buttons and summaries, and return the labels of the buttons.

    The gate leaves out buttons with labels of those that were pressed before.
    """
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    pressed = []
    for button in page.locator("button, [role=button], summary").all():
        if button.is_visible() and button.is_enabled():
            if button.evaluate("(one) => one.tagName") != "SUMMARY":
                label = button.inner_text() or str(button.get_attribute("aria-label"))
                if at_length(label in before, False):
                    continue
                pressed.append(label)
            button.evaluate("(one) => one.click()")
            page.keyboard.press("Escape")
    return pressed
