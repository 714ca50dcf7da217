"""The server in a process of its own: event streams, shutdown, roles, start errors."""

import http.client
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import psutil
import pytest

from tests.cli.running import hexapods
from tests.event_streams import ReceivedEvent
from tests.served import BODY, ENDLESS, Served, is_job, serving_from
from tests.timeouts import LONG_S

TOKEN = "a-token-for-tests"


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    with serving_from(tmp_path) as make:
        yield make


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server with a token, for the tests that only look."""
    with serving_from(tmp_path_factory.mktemp("guarded")) as make:
        yield make(HEXAPODS_TOKEN=TOKEN)


def test_event_stream_begins_with_a_snapshot_continues_with_changes_and_is_resumed(
    serve: Callable[..., Served],
) -> None:
    server = serve()
    events = server.events()
    name, snapshot, begin = next(events)
    assert name == "snapshot"
    assert (snapshot["role"], snapshot["viewers"], snapshot["runs"]) == ("operator", 0, [])
    assert {"version", "stage", "scene"} <= set(snapshot)
    run = server.start({**BODY, "steps": 100})
    seen: dict[str, list[Any]] = {}
    last = 0
    for name, data, number in events:
        seen.setdefault(name, []).append(data)
        if name != "clock":
            assert int(number) > last
            last = int(number)
        if name == "run" and data["state"] == "finished":
            break
    assert [e["step"] for e in seen["evaluation"]] == [50, 100]
    assert all(e["run_id"] == run["id"] for e in seen["evaluation"])
    assert seen["reference"][0]["greedy_distance_m"] > 0.4
    assert seen["run"][0]["id"] == run["id"]
    assert seen["stage"][-1]["run_id"] == run["id"]

    # A client that reconnects receives all that it has missed.
    events = server.events(last=begin)
    name, snapshot, _ = next(events)
    assert (name, snapshot["runs"][0]["state"]) == ("snapshot", "finished")
    steps: list[int] = []
    for name, data, _ in events:
        if name == "evaluation":
            steps.append(data["step"])
        if steps == [50, 100]:
            break
    events_of_run = server.events(f"?run_id={run['id']}", last="99999999999999999")
    _, snapshot, _ = next(events_of_run)
    assert [row["step"] for row in snapshot["evaluations"]] == [50, 100]
    missing = server.client.get("/api/v1/events?run_id=none")
    assert (missing.status_code, missing.headers["content-type"]) == (
        404,
        "application/problem+json",
    )


@pytest.mark.promises
def test_server_does_not_import_modules_of_experiments() -> None:
    """These modules, and trimesh, which viser may import, would double the start time."""
    look = (
        "import sys, app.server, app.jobs.worker\n"
        "heavy = ('distributed', 'matplotlib', 'scipy', 'trimesh')\n"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", look], capture_output=True, text=True, check=True, timeout=LONG_S
    )
    assert done.stdout.strip() == "[]"


def test_pause_and_live_changes_are_published(serve: Callable[..., Served]) -> None:
    server = serve()
    run = server.start(ENDLESS)
    server.moving(run)
    path = f"/api/v1/trainings/{run['id']}"
    events = server.events(f"?run_id={run['id']}")
    next(events)
    server.client.patch(path, json={"settings": {"alpha": 0.1}})
    server.client.post(f"{path}/pause")
    names: list[str] = []
    for name, data, _ in events:
        names.append(name)
        assert name == "clock" or data.get("run_id", data.get("id")) == run["id"]
        if name == "run" and data["state"] == "paused":
            break
    assert "rates" in names
    server.client.post(f"{path}/stop")
    assert server.client.delete(path).status_code == 204
    assert "run-deleted" in [name for name, _, _ in until_closed(server, events)]


def until_closed(server: Served, events: Iterator[ReceivedEvent]) -> Iterator[ReceivedEvent]:
    server.process.send_signal(signal.SIGTERM)
    yield from events


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "SIGINT"])
def test_signal_shuts_the_server_down_in_spite_of_open_streams(
    serve: Callable[..., Served], by: int
) -> None:
    server = serve()
    run = server.start(ENDLESS)
    server.moving(run)
    events = server.events()
    next(events)
    children = psutil.Process(server.process.pid).children(recursive=True)
    assert children
    assert server.end(by) == 0
    _, alive = psutil.wait_procs(children, timeout=LONG_S)
    assert not alive


def test_killed_server_leaves_no_process(serve: Callable[..., Served]) -> None:
    server = serve()
    server.moving(server.start(ENDLESS))
    children = psutil.Process(server.process.pid).children(recursive=True)
    assert any(is_job(process) for process in children)
    assert server.end(signal.SIGKILL) == -signal.SIGKILL
    _, alive = psutil.wait_procs(children, timeout=LONG_S)
    assert not alive


@pytest.mark.parametrize(
    ("request_line", "status"),
    [
        ("GET / HTTP/1.1", 200),
        ("GET /viewer/?theme=dark HTTP/1.1", 200),
        ("GET /viewer HTTP/1.1", 307),
        ("POST /viewer/ HTTP/1.1", 401),
        ("GET /api/v1/events/snapshot HTTP/1.1", 200),
        ("PUT /api/v1/stage HTTP/1.1", 401),
        ("GET /none HTTP/1.1", 404),
    ],
)
def test_request_for_a_websocket_is_answered_as_any_other(
    guarded: Served, request_line: str, status: int
) -> None:
    handshake = (
        "Upgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
        "Content-Length: 0\r\n"
    )
    parts = urlsplit(guarded.address)
    with socket.create_connection((parts.hostname, parts.port), timeout=LONG_S) as client:
        for _ in range(2):  # the connection goes on as HTTP
            head = f"{request_line}\r\nHost: {parts.netloc}\r\n{handshake}\r\n"
            client.sendall(head.encode())
            with http.client.HTTPResponse(client) as response:
                response.begin()
                assert response.status == status
                response.read()
    assert guarded.client.get("/healthz").status_code == 200


def test_request_for_a_websocket_is_not_logged(tmp_path: Path) -> None:
    """uvicorn would log two warnings for each, and advise to install libraries."""
    log = tmp_path / "log"
    with log.open("w") as file:
        server = Served(tmp_path / "data", file)
        headers = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
        assert server.client.get("/viewer/", headers=headers).status_code == 200
        assert server.end() == 0
    assert "pgrade" not in log.read_text()


def test_page_and_documents_are_served(guarded: Served) -> None:
    assert guarded.client.get("/viewer/").status_code == 200
    assert guarded.client.get("/docs").text.count("<details>") > 20


def test_snapshot_has_the_role_of_the_client(guarded: Served) -> None:
    assert next(guarded.events())[1]["role"] == "spectator"
    assert guarded.client.post("/api/v1/trainings", json=BODY).status_code == 401
    guarded.client.headers["Authorization"] = f"Bearer {TOKEN}"
    try:
        assert next(guarded.events())[1]["role"] == "operator"
        guarded.start({**BODY, "steps": 1})
    finally:
        del guarded.client.headers["Authorization"]


def refusal(*arguments: str, **variables: str) -> str:
    done = hexapods("serve", *arguments, folder=Path.cwd(), **variables)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    return done.stderr


def test_port_in_use_is_refused(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        message = refusal("--port", port, "--data", str(tmp_path))
    assert port in message
    assert "--port" in message


def test_foreign_bind_address_is_refused(tmp_path: Path) -> None:
    message = refusal(
        "--host", "192.0.2.1", "--data", str(tmp_path), HEXAPODS_TOKEN="long-enough-for-all"
    )
    assert "192.0.2.1" in message


def test_unwritable_data_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "HEXAPODS_DATA" in refusal("--port", "0", "--data", str(tmp_path / "file"))


def test_network_address_without_token_is_refused(tmp_path: Path) -> None:
    assert "HEXAPODS_TOKEN" in refusal("--host", "0.0.0.0", "--data", str(tmp_path))
