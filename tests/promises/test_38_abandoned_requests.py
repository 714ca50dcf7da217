"""Promise 38: nobody computes for the departed, and no reader takes the others' turn: while forty
requests for the heaviest answers are abandoned, or thirty exports are read, another spectator's
95th percentile is under 1 s, and SIGTERM takes under 10 s.

In full by `make soak`, with a race of 6 lanes of 3,333 steps, 1,024 files and 1 GB; the gate's
form has lanes of 300 steps, and bounds no time that a busy machine could exceed.
"""

import http.client
import itertools
import json
import logging
import socket
import statistics
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.promises.length import at_length
from tests.promises.raw import watched_memory
from tests.served import BODY, Served
from tests.timeouts import LONG_S

STEPS = at_length(300, 3_333)
RACE = {**BODY, "steps": STEPS, "lanes": [{"agent": "greedy"}] * 6}
ABANDONED, EXPORTS = 40, at_length(5, 30)
SECONDS = at_length(1.0, 20.0)
MAX_P95_S, MAX_END_S = at_length(LONG_S, 1.0), at_length(LONG_S, 10.0)
MAX_WHAT_IF_S = at_length(LONG_S, 15.0)
IDLE_CPU_S = 0.06
"""More than an idle server takes in a second, which still draws."""
"""Processor time per second of a server that does nothing, at most [s]."""
FILES, MEMORY_BYTES = 1024, 1 << 30
TOKEN = "a-token-for-tests"
OPERATOR = {"Authorization": f"Bearer {TOKEN}"}
RUDE, POLITE = "127.0.0.2", "127.0.0.3"
HEAVY_WHAT_IF = {
    **BODY,
    "agent": "posterior-sampling",
    "steps": 2_000,
    "settings": {"plan_every": 1, "gamma": 0.9999999},
}


def get(server: Served, path: str, source: str = POLITE) -> tuple[int, float]:
    """Read an answer as a spectator of an address; return its status and how long it took [s]."""
    status, _, took_s = call(server, "GET", path, source=source)
    return status, took_s


def call(
    server: Served,
    method: str,
    path: str,
    *,
    body: Any = None,
    headers: dict[str, str] | None = None,
    source: str = POLITE,
) -> tuple[int, bytes, float]:
    """Send a request from an address; return status, answer, and how long it took [s]."""
    began_s = time.perf_counter()
    port = int(server.address.rpartition(":")[2])
    connection = http.client.HTTPConnection("127.0.0.1", port, LONG_S, (source, 0))
    content_headers = {} if body is None else {"Content-Type": "application/json"}
    content = None if body is None else json.dumps(body)
    connection.request(method, path, content, {**content_headers, **(headers or {})})
    answer = connection.getresponse()
    data = answer.read()
    connection.close()
    return answer.status, data, time.perf_counter() - began_s


@contextmanager
def requests(server: Served, paths: Sequence[str], count: int) -> Iterator[list[socket.socket]]:
    """Send requests from one address, and read nothing; every other one with a second behind it."""
    host, port = server.address.removeprefix("http://").split(":")
    with ExitStack() as stack:
        clients = []
        for number, path in zip(range(count), itertools.cycle(paths), strict=False):
            client = stack.enter_context(socket.socket())
            client.bind((RUDE, 0))
            client.connect((host, int(port)))
            head = f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\n\r\n".encode()
            client.sendall(head * (1 + number % 2))
            clients.append(client)
        yield clients


def p95_s(server: Served) -> float:
    """Read as a spectator for a while; return the 95th percentile of the latencies [s]."""
    latencies_s: list[float] = []
    until_s = time.monotonic() + SECONDS
    while time.monotonic() < until_s or len(latencies_s) < 3:
        status, took_s = get(server, "/api/v1/runs?limit=5")
        assert status == 200
        latencies_s.append(took_s)
        time.sleep(0.02)
    return statistics.quantiles(latencies_s, n=20)[-1]


def heavy_paths(server: Served) -> tuple[str, list[str]]:
    """Compute a race; return its id, and the paths of its heaviest answers."""
    server.client.headers.update(OPERATOR)
    race = server.start(RACE, "/races")["id"]
    server.in_state({"id": race, "kind": "race"}, "finished")
    replay = f"/api/v1/runs/{race}/replay"
    return race, [
        *(f"/api/v1/races/{race}/timeline?clock={clock}" for clock in ("paper", "wall", "free")),
        f"/api/v1/runs/{race}/gait",
        replay,
        *(f"{replay}/segments/0/{number}" for number in range(20)),
    ]


@pytest.mark.timeout(1800)
def test_abandoned_and_long_requests_delay_nobody(launch: Callable[..., Served]) -> None:
    before = ("prlimit", f"--nofile={FILES}:{FILES}")
    server = launch(before=before, HEXAPODS_TOKEN=TOKEN)
    race, paths = heavy_paths(server)
    trajectory = f"/api/v1/runs/{race}/trajectory?format=csv"
    figures: dict[str, float] = {}

    with watched_memory(server.process.pid) as memory:
        with requests(server, paths, ABANDONED):
            pass
        figures["p95 beside the abandoned"] = p95_s(server)
        # The view that all of them asked for, from an address that waits for none of them.
        assert get(server, paths[0])[0] == 200
        with requests(server, [trajectory], EXPORTS) as clients:
            reader = threading.Thread(target=read_all, args=(clients,), daemon=True)
            reader.start()
            figures["p95 beside exports"] = p95_s(server)

    with requests(server, paths, ABANDONED):
        began_s = time.monotonic()
        assert server.end() == 0
        figures["SIGTERM"] = time.monotonic() - began_s
    logging.getLogger(__name__).info("%s, memory + %d MB", figures, memory.grown_bytes >> 20)
    assert figures["p95 beside the abandoned"] < MAX_P95_S
    assert figures["p95 beside exports"] < MAX_P95_S
    assert figures["SIGTERM"] < MAX_END_S
    assert memory.grown_bytes < MEMORY_BYTES


def cpu_s(server: Served) -> float:
    """Return the processor time that a server has taken [s]."""
    now = psutil.Process(server.process.pid).cpu_times()
    return float(now.user + now.system)


def idle_cpu_s(server: Served, drawing_s: float) -> float:
    """Return the processor time of a server once it is idle [s].

    Args:
        server: the server.
        drawing_s: what it took in a second in which it had nothing to do but to draw.
    """
    last_s = cpu_s(server)
    deadline_s = time.monotonic() + LONG_S
    while True:
        time.sleep(1.0)
        now_s = cpu_s(server)
        if now_s - last_s < drawing_s + IDLE_CPU_S or time.monotonic() > deadline_s:
            return now_s
        last_s = now_s


def test_little_is_computed_for_the_departed(launch: Callable[..., Served]) -> None:
    """Less than half of the work of the same answers, in processor time."""
    server = launch(HEXAPODS_TOKEN=TOKEN)
    _, paths = heavy_paths(server)
    segments = [path for path in paths if "segments" in path]
    assert get(server, segments[0])[0] == 200
    before_s = cpu_s(server)
    time.sleep(1.0)
    drawing_s = cpu_s(server) - before_s
    before_s = cpu_s(server)
    with requests(server, segments, len(segments)):
        pass
    abandoned_s = idle_cpu_s(server, drawing_s) - before_s
    before_s = cpu_s(server)
    for path in segments:
        assert get(server, path)[0] == 200
    answered_s = cpu_s(server) - before_s

    logging.getLogger(__name__).info("abandoned %.2f s, read %.2f s", abandoned_s, answered_s)
    assert abandoned_s < answered_s / 2
    assert server.end() == 0


def test_event_streams_that_their_clients_leave_are_no_errors(
    launch: Callable[..., Served], tmp_path: Path
) -> None:
    """Some leave at once, some after the snapshot, some by a reset: nothing of it is logged."""
    with (tmp_path / "log").open("w") as log:
        server = launch(log=log)
        for number in range(30):
            with requests(server, ["/api/v1/events"], 1) as (client,):
                if number % 3:
                    client.recv(100)
                if number % 2:
                    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            # What is sent to those that have left.
            assert server.client.put("/api/v1/stage", json={"speed": 1 + number % 2}).is_success
        assert server.end() == 0
    assert (tmp_path / "log").read_text() == ""


def read_all(clients: Sequence[socket.socket]) -> None:
    """Read what clients are sent until they are closed."""
    for client in clients:
        client.setblocking(False)
    while clients:
        for client in clients:
            try:
                client.recv(1 << 16)
            except BlockingIOError:
                continue
            except OSError:
                return
        time.sleep(0.001)


def test_a_spectators_what_if_is_bounded_and_yields_to_an_operators(
    launch: Callable[..., Served],
) -> None:
    server = launch(HEXAPODS_TOKEN=TOKEN)
    heavy: list[tuple[int, bytes, float]] = []

    def ask() -> None:
        heavy.append(call(server, "POST", "/api/v1/what-if", body=HEAVY_WHAT_IF, source=RUDE))

    spectator = threading.Thread(target=ask)
    spectator.start()
    question = {**BODY, "steps": 20}
    path = "/api/v1/what-if"
    status, _, operator_s = call(server, "POST", path, body=question, headers=OPERATOR)
    spectator.join()
    ((refused, why, spectator_s),) = heavy

    logging.getLogger(__name__).info("operator %.1f s, spectator %.1f s", operator_s, spectator_s)
    assert status == 200
    assert refused in (422, 429)
    assert b"choose fewer steps" in why or b"the operator asked" in why.lower()
    assert max(operator_s, spectator_s) < MAX_WHAT_IF_S
    assert server.end() == 0
