"""Promise 43: strangers of a demo do what they may, and nothing of it outlives a day.

The matrix is generated: every route of the app as a visitor without a cookie, as one
with runs, with a forged cookie, and below a room's path; what is open is listed by hand below. A
server that is killed deletes after its next start what is too old by then.
"""

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import httpx2
import pytest

from app.api.policy import OWN_RUNS, START
from tests.browser.serving import Serving, serving
from tests.jobs.waiting import wait_until
from tests.promises.raw import Route, accesses, every_route, request_lines, send, status_of

pytestmark = pytest.mark.test

TOKEN = "a-token-for-tests"
READS = {"GET", "HEAD"}
BODY = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20}
SLOW = {**BODY, "steps": 5000, "pace": 1}
STARTS = {
    ("POST", "/api/v1/trainings"): BODY,
    ("POST", "/api/v1/races"): {
        "gait": "left-right-origin",
        "simulator": "kinematic",
        "steps": 5,
        "lanes": [{"agent": "greedy"}],
    },
    ("POST", "/api/v1/runs/{run_id}/again"): {},
}
"""By route a valid body: what each stranger may start."""
OF_OWN = {
    ("POST", "/api/v1/trainings/{run_id}/stop"),
    ("POST", "/api/v1/races/{run_id}/stop"),
    ("PATCH", "/api/v1/runs/{run_id}"),
    ("DELETE", "/api/v1/trainings/{run_id}"),
    ("DELETE", "/api/v1/races/{run_id}"),
    ("DELETE", "/api/v1/runs"),
    ("POST", "/api/v1/runs/{run_id}/restore"),
}
QUESTIONS = {("POST", "/api/v1/what-if"), ("POST", "/api/v1/robots/preview")}
BY_CODE = {("POST", "/api/v1/rooms/{code}/participants")}
OPERATORS_READ = {"/api/v1/visitors", "/l/{lesson_id}/sheet"}
"""Of what is read, all that is not public."""


class Demo(NamedTuple):
    """A demo with an operator's run, and two visitors of whom each has one.

    Attributes:
        of_operator, own_run, of_other: ids of runs.
        cookie: header of a visitor.
    """

    server: Serving
    of_operator: str
    own_run: str
    of_other: str
    cookie: str
    code: str

    def status(self, route: Route, run_id: str, cookie: str, prefix: str = "") -> int:
        """Return the status of a request with no body but a valid one where one is known."""
        body = json.dumps(STARTS.get(route, {})).encode()
        path = prefix + self.filled(route.path, run_id)
        if route == ("DELETE", "/api/v1/runs"):
            path += f"?id={run_id}"
        lines = request_lines(Route(route.method, path), f"127.0.0.1:{self.server.port}")
        lines = [line for line in lines if not line.startswith("Content-Length")]
        if route.method not in READS:
            lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
        else:
            body = b""
        headers = [f"Cookie: {cookie}"] if cookie else []
        return status_of(send(self.server.port, *lines, *headers, body=body))

    def filled(self, path: str, run_id: str) -> str:
        """Return a path with something that exists in place of its parameters."""
        for name, value in (("run_id", run_id), ("code", self.code), ("seed", "0")):
            path = path.replace(f"{{{name}}}", value)
        return path.replace("{lesson_id}", "one-run-proves-nothing")

    def operator(self, method: str, path: str, body: Any = None) -> Any:
        """Send a request of the operator, and return the JSON of its answer."""
        with self.server.api(TOKEN) as api:
            answer = api.request(method, path, json=body)
        assert answer.status_code < 300, answer.text
        return answer.json() if answer.content else None

    def state(self) -> Any:
        """Return what a visitor could change of others, as the operator sees it."""
        runs = [
            self.operator("GET", f"runs/{run_id}") for run_id in (self.of_operator, self.of_other)
        ]
        run_fields = [[run[name] for name in ("name", "state", "tags", "notes")] for run in runs]
        stage = self.operator("GET", "stage")
        # That anyone joins who has the code is of the room.
        rooms = [(room["code"], room["state"]) for room in self.operator("GET", "rooms")["items"]]
        robots = self.operator("GET", "robots")["items"]
        return run_fields, stage["run_id"], stage["playing"], stage["clock"], rooms, robots


def visit(server: Serving, body: Any) -> tuple[str, str]:
    """Start something as a new visitor; return the id of the run, and the cookie."""
    with server.api() as api:
        answer = api.post("trainings", json=body)
        assert answer.status_code == 202, answer.text
        [(name, value)] = api.cookies.items()
    assert name.startswith("hexapods_visitor_")
    set_cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in set_cookie
    assert "SameSite=Strict" in set_cookie
    assert "Max-Age=86400" in set_cookie
    return str(answer.json()["id"]), f"{name}={value}"


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Demo]:
    data = tmp_path_factory.mktemp("demo")
    with serving(
        data, token=TOKEN, demo=1, starts_per_minute=100_000, demo_steps_per_hour=1_000_000
    ) as server:
        with server.api(TOKEN) as api:
            run = str(api.post("trainings", json={**SLOW, "steps": 400_000}).json()["id"])
            code = str(api.post("rooms", json={}).json()["code"])
        other, _ = visit(server, SLOW)
        with server.api() as api:
            for run_id in (run, other):
                wait_until(partial(is_running, api, run_id))
        own_run, cookie = visit(server, BODY)
        yield Demo(server, run, own_run, other, cookie, code)


def is_running(api: httpx2.Client, run_id: str) -> bool:
    """Whether a run computes."""
    return bool(api.get(f"runs/{run_id}").json()["state"] == "running")


def may_send(route: Route) -> bool:
    """Whether a visitor may send a request that changes something, of the operator's run."""
    return (route.method, route.path) in {*STARTS, *QUESTIONS, *BY_CODE}


def test_policies_open_to_visitors_what_is_listed_here() -> None:
    assert {tuple(route) for route, access in accesses().items() if access is START} == set(STARTS)
    assert {tuple(route) for route, access in accesses().items() if access is OWN_RUNS} == OF_OWN
    open_to_all = {
        tuple(route)
        for route, access in accesses().items()
        if not access.is_read and access.spectators != "never"
    }
    assert open_to_all == QUESTIONS | BY_CODE


@pytest.mark.parametrize("who", ["new", "known", "forged"])
def test_a_stranger_changes_nothing_of_others_by_any_route(demo: Demo, who: str) -> None:
    name = demo.cookie.partition("=")[0]
    cookie = {"new": "", "known": demo.cookie, "forged": f"{name}=of-another-server"}[who]
    before = demo.state()
    for route in every_route():
        for run_id in (demo.of_operator, demo.of_other):
            status = demo.status(route, run_id, cookie)
            if route.method in READS:
                is_closed = status in (401, 403)
                assert is_closed == (route.path in OPERATORS_READ), (route, status)
            elif may_send(route):
                assert status not in (401, 403), (route, status)
            else:
                assert status == 403, (route, status)
    assert demo.state() == before


def test_below_a_rooms_path_a_stranger_only_watches(demo: Demo) -> None:
    prefix = f"/r/{demo.code}"
    for route in every_route():
        if route.method in READS or (route.method, route.path) in QUESTIONS | BY_CODE:
            continue
        assert demo.status(route, demo.own_run, demo.cookie, prefix) == 403, route


def test_own_runs_are_stopped_renamed_and_deleted(demo: Demo) -> None:
    run_id, cookie = visit(demo.server, SLOW)
    name, _, value = cookie.partition("=")
    with demo.server.api() as api:
        api.cookies.set(name, value)
        assert api.patch(f"runs/{run_id}", json={"name": "Rex"}).json()["name"] == "Rex"
        assert api.get("allowance").json()["runs"] == [run_id]
        ids = httpx2.QueryParams([("id", run_id), ("id", demo.of_other)])
        assert api.request("DELETE", f"runs?{ids}", headers=X).status_code == 403
        assert api.post(f"trainings/{run_id}/pause", headers=X).status_code == 403
        assert api.post(f"trainings/{run_id}/stop", headers=X).status_code == 202
        deleted = api.request("DELETE", f"runs?id={run_id}", headers=X).json()
        assert deleted["deleted"] == [run_id]
        assert api.get("allowance").json()["runs"] == []


X = {"X-Requested-With": "tests"}


def test_operators_are_accepted_everywhere(demo: Demo) -> None:
    run_id, cookie = visit(demo.server, BODY)
    visitors = demo.operator("GET", "visitors")["items"]
    (visitor,) = (visitor_row for visitor_row in visitors if run_id in visitor_row["runs"])
    assert cookie.partition("=")[2] not in json.dumps(visitors)
    demo.operator("DELETE", f"visitors/{visitor['id']}")
    with demo.server.api(TOKEN) as api:
        assert api.get(f"trainings/{run_id}").status_code == 404
        assert api.delete(f"visitors/{visitor['id']}").status_code == 404
        assert api.patch(f"runs/{demo.of_other}", json={"tags": []}).status_code == 200


def test_after_a_day_nothing_is_left_though_the_server_was_down(tmp_path: Path) -> None:
    with serving(tmp_path, token=TOKEN, demo=1) as server:
        run_id, cookie = visit(server, SLOW)
        own_id, _ = visit(server, BODY)
        with server.api(TOKEN) as api:
            wait_until(lambda: api.get(f"trainings/{run_id}").json()["progress"]["done"] > 0)
        server.kill()
    let_a_day_pass(tmp_path, run_id)
    # Also of a server that is no demo any more.
    with serving(tmp_path, token=TOKEN) as server, server.api(TOKEN) as api:
        assert api.get(f"trainings/{run_id}").status_code == 404
        wait_until(lambda: api.get(f"trainings/{own_id}").json()["state"] == "finished")
    assert run_id.encode() not in rows_of(tmp_path)
    assert own_id.encode() in rows_of(tmp_path)
    assert cookie.partition("=")[2].encode() not in rows_of(tmp_path)


def let_a_day_pass(data: Path, run_id: str) -> None:
    """Set the times of a run back by a day in the database."""
    earlier = (datetime.now(UTC) - timedelta(days=1)).replace(tzinfo=None).isoformat(" ")
    with closing(sqlite3.connect(data / "hexapods.db")) as connection, connection:
        changed = connection.execute(
            "UPDATE visitor_runs SET created_at = ? WHERE run_id = ?", (earlier, run_id)
        )
        assert changed.rowcount == 1


def rows_of(data: Path) -> bytes:
    """Return all rows of the database as text."""
    with closing(sqlite3.connect(data / "hexapods.db")) as connection:
        return "\n".join(connection.iterdump()).encode()
