"""Promise 12: browsers reconnect: 100 dropped connections: full state in 2 s, no gap in a curve.

In full by `make soak`. The gate drops 40, and has no limit of 2 s, since it runs other tests beside
this one.
"""

import contextlib
import http.client
import json
import socket
import struct
import time
from typing import Any

import httpx2
import pytest

from hexapods.drawing.viser_internals import stream
from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.timeouts import LONG_S
from tests.viewer.serving import PATIENCE_S, Viewer

DROPS = at_length(40, 100)
FULL_STATE_S = at_length(LONG_S, 2.0)
EVERY = 5
"""Steps between two evaluations."""
BODY = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 100_000,
    "evaluate_every": EVERY,
    "pace": 20,
}
# SO_LINGER with a timeout of 0: closing resets the connection (RST) without a shutdown.
_RESET = struct.pack("ii", 1, 0)


class Events:
    """Client of the server-sent events, which can drop its connection."""

    def __init__(self, port: int, last_id: str | None) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        headers = {} if last_id is None else {"Last-Event-ID": last_id}
        self._connection.request("GET", "/api/v1/events", headers=headers)
        self._answer = self._connection.getresponse()
        assert self._answer.status == 200

    def next(self) -> tuple[str, str, Any]:
        """Return the next event's name, id and data."""
        fields: dict[str, str] = {}
        while line := self._answer.readline().decode().rstrip("\n").rstrip("\r"):
            name, _, value = line.partition(":")
            fields[name] = value.removeprefix(" ")
        if "data" not in fields:
            return self.next()
        return fields["event"], fields["id"], json.loads(fields["data"])

    def drop(self) -> None:
        assert self._connection.sock is not None
        self._connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET)
        self._answer.close()
        self._connection.close()


def node_names(frame: stream.Frame) -> set[str]:
    """Return the names of the scene's nodes that a frame creates."""
    return {str(m["name"]) for m in frame.messages if "props" in m}


@pytest.fixture
def training(server: Serving) -> Any:
    with httpx2.Client(base_url=f"{server.address}api/v1", timeout=PATIENCE_S) as client:
        run = client.post("/trainings", json=BODY).json()
        while client.get(f"/trainings/{run['id']}").json()["progress"]["done"] == 0:
            time.sleep(0.02)
        yield run
        client.post(f"/trainings/{run['id']}/stop")


def test_a_reconnecting_event_stream_misses_no_evaluation(
    server: Serving, training: dict[str, Any]
) -> None:
    steps: list[int] = []
    took_s: list[float] = []
    last_id = None
    for number in range(DROPS):
        began_s = time.perf_counter()
        events = Events(server.port, last_id)
        name, last_id, snapshot = events.next()
        took_s.append(time.perf_counter() - began_s)
        assert name == "snapshot"
        assert training["id"] in {run["id"] for run in snapshot["runs"]}
        assert {"stage", "scene", "role", "viewers"} <= set(snapshot)
        # Read up to a new evaluation; missed events are replayed before, possibly repeated.
        wanted = steps[-1] + EVERY if steps else EVERY
        while not steps or steps[-1] < wanted:
            name, last_id, fields = events.next()
            if name == "evaluation" and fields["step"] not in steps:
                steps.append(fields["step"])
        events.drop()
        if number % 10 == 0:
            time.sleep(0.3)  # disconnected for longer than between two evaluations

    assert steps == list(range(steps[0], steps[-1] + 1, EVERY))
    curve = httpx2.get(f"{server.address}api/v1/trainings/{training['id']}/curve").json()
    stored_steps = [row["step"] for row in curve["evaluations"]]
    assert stored_steps[: len(steps)] == steps
    assert max(took_s) <= FULL_STATE_S


def test_reconnecting_viewers_get_the_whole_scene(
    server: Serving, training: dict[str, Any]
) -> None:
    address = f"ws://127.0.0.1:{server.port}/viewer/?view=leader"
    scenes: list[set[str]] = []
    took_s: list[float] = []
    for _ in range(DROPS):
        began_s = time.perf_counter()
        viewer = Viewer(address)
        scenes.append(node_names(viewer.frame()))
        took_s.append(time.perf_counter() - began_s)
        with contextlib.suppress(OSError):
            viewer.socket.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET)
        viewer.socket.socket.close()

    # The number of nodes varies, since the training is put on stage meanwhile.
    assert min(map(len, scenes)) > 5
    assert max(took_s) <= FULL_STATE_S
    metrics = f"{server.address}metrics"
    deadline = time.monotonic() + PATIENCE_S
    while "hexapods_viewers 0.0" not in httpx2.get(metrics).text:
        assert time.monotonic() < deadline
        time.sleep(0.05)
