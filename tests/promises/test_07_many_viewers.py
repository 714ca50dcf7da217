"""Promise 7: many viewers: 200 for 10 minutes: each has the frames of every moment before it is
shown, but for 1 % of the time at most, and 95 % of commands, and of the API's other answers, come
in under 250 ms. Pages that fetch their frames get them in time, 20 of them beside 30 viewers.

In full by `make soak`. The gate's shorter form has 30 viewers for 5 s; since it shares the machine
with other tests, it requires that every viewer stays and gets pieces, and every command an answer.
"""

import argparse
import asyncio
import statistics
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx2
import pytest

from benchmarks.viewers import measure
from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.timeouts import LONG_S

VIEWERS = at_length(30, 200)
SECONDS = at_length(5.0, 600.0)
MAX_GAP_SHARE = at_length(1.0, 0.01)
MAX_P95_MS = at_length(LONG_S * 1e3, 250.0)


def watch(
    server: Serving, viewers: int, seconds: float, stalled: int = 0, fetching: int = 0
) -> dict[str, float]:
    """Connect viewers for some seconds by `benchmarks.viewers`, and return its figures."""
    options = argparse.Namespace(
        viewers=viewers, seconds=seconds, stalled=stalled, fetching=fetching, pid=server.pid
    )
    setattr(options, "from", None)
    return asyncio.run(measure("127.0.0.1", server.port, options))


def start_moving(server: Serving) -> None:
    """Start a training that keeps the stage moving, and wait for its first step."""
    body: dict[str, Any] = {
        "gait": "left-right-origin",
        "simulator": "kinematic",
        "steps": 10_000_000,
        "evaluate_every": 0,
        "pace": 1,
    }
    run = httpx2.post(f"{server.address}api/v1/trainings", json=body).json()
    while (
        httpx2.get(f"{server.address}api/v1/trainings/{run['id']}").json()["progress"]["done"] == 0
    ):
        time.sleep(0.05)


@contextmanager
def controlling_stage(server: Serving) -> Iterator[list[float]]:
    """Command the stage continually; yield the list of latencies [s]."""
    latencies_s: list[float] = []
    finished = threading.Event()

    def command() -> None:
        with httpx2.Client(base_url=server.address, timeout=LONG_S) as client:
            while not finished.wait(0.05):
                began_s = time.perf_counter()
                client.put("api/v1/stage", json={"playing": True}).raise_for_status()
                latencies_s.append(time.perf_counter() - began_s)

    commander = threading.Thread(target=command, daemon=True)
    commander.start()
    try:
        yield latencies_s
    finally:
        finished.set()
        commander.join()


@pytest.mark.timeout(1200)
def test_gaps_and_latencies_with_many_viewers(server: Serving) -> None:
    start_moving(server)
    with controlling_stage(server) as latencies_s:
        figures = watch(server, VIEWERS, SECONDS)

    assert len(latencies_s) > at_length(1, 10)
    assert statistics.quantiles(latencies_s, n=20)[-1] * 1e3 < MAX_P95_MS
    assert figures["viewers_lost"] == 0
    assert figures["pieces_lowest"] > 0
    assert figures["gap_share"] < MAX_GAP_SHARE
    assert figures["healthz_p95_ms"] < MAX_P95_MS


@pytest.mark.timeout(1200)
def test_pages_that_fetch_get_their_frames(server: Serving) -> None:
    body: dict[str, Any] = {
        "gait": "left-right-origin",
        "simulator": "kinematic",
        "lanes": [{"agent": "greedy"}, {"agent": "greedy"}, {"agent": "two-step"}],
    }
    race = httpx2.post(f"{server.address}api/v1/races", json=body).json()
    while httpx2.get(f"{server.address}api/v1/races/{race['id']}").json()["state"] != "finished":
        time.sleep(0.05)
    body = {"run_id": race["id"], "time_s": 0, "playing": True, "speed": 1}
    httpx2.put(f"{server.address}api/v1/stage", json=body).raise_for_status()
    viewers, fetching = at_length(3, 30), at_length(3, 20)
    figures = watch(server, viewers, at_length(3.0, 15.0), fetching=fetching)

    assert figures["viewers_lost"] == figures["fetch_failures"] == 0
    assert figures["requests"] >= fetching
    assert figures["gap_share"] < MAX_GAP_SHARE
    # A segment is 2.1 s of the picture, and is fetched a second before.
    assert figures["fetch_p95_ms"] < at_length(LONG_S * 1e3, 1000.0)
