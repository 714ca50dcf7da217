"""Promise 12: browsers come back: 100 dropped connections: full state in 2 s, no gap in a curve.

In full, but for one thing: in the gate the two seconds are held by the median, since the machine
may do other things as well; under `make soak` by all hundred.
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

from app.viewer import wire
from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.viewer.serving import PATIENCE_S, Viewer

DROPS = 100
FULL_STATE_S = 2.0
COUNTING = at_length(DROPS // 2, -1)
"""Of the times, sorted: the one that must be short enough."""
EVERY = 5
"""Steps between two evaluations."""
BODY = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 100_000,
    "evaluate_every": EVERY,
    "pace": 20,
}
# Closing then resets the connection, as a cable does that is pulled out.
_RESET = struct.pack("ii", 1, 0)


class Events:
    """A browser's stream of events, by hand, so that it can be dropped by hand."""

    def __init__(self, port: int, last_id: str | None) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        headers = {} if last_id is None else {"Last-Event-ID": last_id}
        self._connection.request("GET", "/api/v1/events", headers=headers)
        self._answer = self._connection.getresponse()
        assert self._answer.status == 200

    def next(self) -> tuple[str, str, Any]:
        """Its name, its id, and what it says."""
        said: dict[str, str] = {}
        while line := self._answer.readline().decode().rstrip("\n").rstrip("\r"):
            name, _, value = line.partition(":")
            said[name] = value.removeprefix(" ")
        if "data" not in said:
            return self.next()
        return said["event"], said["id"], json.loads(said["data"])

    def drop(self) -> None:
        assert self._connection.sock is not None
        self._connection.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET)
        self._answer.close()
        self._connection.close()


def names_in(frame: wire.Frame) -> set[str]:
    """The scene's nodes, of which each must be made before it can be moved."""
    return {str(m["name"]) for m in frame.messages if "props" in m}


@pytest.fixture
def training(server: Serving) -> Any:
    with httpx2.Client(base_url=f"{server.address}api/v1", timeout=PATIENCE_S) as client:
        run = client.post("/trainings", json=BODY).json()
        while client.get(f"/trainings/{run['id']}").json()["progress"]["done"] == 0:
            time.sleep(0.02)
        yield run
        client.post(f"/trainings/{run['id']}/stop")


def test_the_curve_has_no_gap(server: Serving, training: dict[str, Any]) -> None:
    heard: list[int] = []
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
        # Until something new is there; what was missed comes with it, but may come twice.
        wanted = heard[-1] + EVERY if heard else EVERY
        while not heard or heard[-1] < wanted:
            name, last_id, said = events.next()
            if name == "evaluation" and said["step"] not in heard:
                heard.append(said["step"])
        events.drop()
        if number % 10 == 0:
            time.sleep(0.3)  # away for longer than it takes to evaluate

    assert heard == list(range(heard[0], heard[-1] + 1, EVERY))
    curve = httpx2.get(f"{server.address}api/v1/trainings/{training['id']}/curve").json()
    kept = [row["step"] for row in curve["evaluations"]]
    assert kept[: len(heard)] == heard
    assert sorted(took_s)[COUNTING] <= FULL_STATE_S


def test_viewers_get_the_whole_scene(server: Serving, training: dict[str, Any]) -> None:
    address = f"ws://127.0.0.1:{server.port}/viewer/?view=leader"
    scenes: list[set[str]] = []
    took_s: list[float] = []
    for _ in range(DROPS):
        began_s = time.perf_counter()
        viewer = Viewer(address)
        scenes.append(names_in(viewer.frame()))
        took_s.append(time.perf_counter() - began_s)
        with contextlib.suppress(OSError):
            viewer.socket.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _RESET)
        viewer.socket.socket.close()

    # Which nodes there are differs: the training takes the stage meanwhile.
    assert min(map(len, scenes)) > 5
    assert sorted(took_s)[COUNTING] <= FULL_STATE_S
    metrics = f"{server.address}metrics"
    deadline = time.monotonic() + PATIENCE_S
    while "hexapods_viewers 0.0" not in httpx2.get(metrics).text:
        assert time.monotonic() < deadline
        time.sleep(0.05)
