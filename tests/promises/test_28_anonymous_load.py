"""Promise 28: an anonymous network cannot cost a run: 10,000 idle, slow and unread connections and
the heaviest reads, against a server with 1,024 files and 1 GB: no run fails, an operator's 95th
percentile is under 500 ms, the log under 1 MB.

In full by `make soak`, for two minutes. The gate's shorter form has 800 connections and 4 readers
for 2 s, and since it shares the machine with other tests it requires that each request is answered:
without limits none is. The connections come from eight addresses, one of which is the operator's
own, and are opened again when the server closes them. Every other request of the operator uses a
new connection.
"""

import json
import logging
import statistics
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import psutil
import pytest

from tests.promises.length import at_length
from tests.promises.processes import start_script
from tests.served import BODY, ENDLESS, Served
from tests.timeouts import LONG_S

CONNECTIONS = at_length(800, 10_000)
SECONDS = at_length(2.0, 120.0)
PROCESSES = at_length(1, 4)
READERS = at_length(4, 8)
ADDRESSES = 8
FILES = 1024
MEMORY_BYTES = 1 << 30
LOG_BYTES = 1_000_000
LOW_PRIORITY = ("nice", "-n", "15")
"""The load generators run at low priority, as if on other machines."""
MAX_P95_S = at_length(LONG_S, 0.5)
TOKEN = "a-token-for-tests"
OPERATOR = {"Authorization": f"Bearer {TOKEN}"}


@contextmanager
def idle_connections(port: int, paths: list[str]) -> Iterator[list[dict[str, int]]]:
    """Run the processes of `idle_connections`; yields the list of their reports.

    The reports are added at the end of the context.
    """
    reports: list[dict[str, int]] = []
    arguments = [str(port), str(CONNECTIONS // PROCESSES), str(ADDRESSES), *paths]
    scripts = [
        start_script("tests.promises.idle_connections", *arguments, before=LOW_PRIORITY)
        for _ in range(PROCESSES)
    ]
    try:
        for script in scripts:
            assert script.stdout is not None
            json.loads(script.stdout.readline())
        yield reports
        for script in scripts:
            output, _ = script.communicate(timeout=LONG_S)
            reports.append(json.loads(output))
    finally:
        for script in scripts:
            script.kill()
            script.communicate()


@contextmanager
def readers(port: int, paths: list[str]) -> Iterator[dict[str, int]]:
    """Run the process of `readers` on the heaviest answers; yields the counts by status.

    The counts are added at the end of the context, which waits until something was read: on a busy
    machine readers of low priority may get no processor for some seconds.
    """
    arguments = [str(port), str(READERS), *paths]
    script = start_script("tests.promises.readers", *arguments, before=LOW_PRIORITY)
    outcomes: dict[str, int] = {}
    try:
        yield outcomes
        assert script.stdout is not None
        script.stdout.readline()
        output, _ = script.communicate(timeout=LONG_S)
        outcomes.update(json.loads(output))
    finally:
        script.kill()
        script.communicate()


@contextmanager
def watched(pid: int) -> Iterator[dict[str, int]]:
    """Monitor peak memory [bytes] of a server with its jobs, and the server's peak open files."""
    peak = {"memory": 0, "files": 0}
    finished = threading.Event()

    def look() -> None:
        server = psutil.Process(pid)
        while not finished.wait(0.25):
            memory = 0
            for process in [server, *server.children(recursive=True)]:
                try:
                    memory += process.memory_full_info().pss
                except psutil.NoSuchProcess:
                    continue
            peak["memory"] = max(peak["memory"], memory)
            peak["files"] = max(peak["files"], server.num_fds())

    watcher = threading.Thread(target=look)
    watcher.start()
    try:
        yield peak
    finally:
        finished.set()
        watcher.join()


def operate(server: Served, until_s: float) -> tuple[list[float], list[dict[str, Any]]]:
    """Send an operator's requests: listings, stage commands and trainings.

    Returns:
        The latency of each request [s], and the started trainings.
    """
    latencies_s: list[float] = []
    runs: list[dict[str, Any]] = []

    def timed(method: str, path: str, body: Any = None, expected: int = 200) -> Any:
        began_s = time.perf_counter()
        if len(latencies_s) % 2:
            answer = httpx2.request(
                method, f"{server.address}{path}", json=body, headers=OPERATOR, timeout=LONG_S
            )
        else:
            answer = server.client.request(method, path, json=body, headers=OPERATOR)
        latencies_s.append(time.perf_counter() - began_s)
        assert answer.status_code == expected, answer.text
        return answer.json()

    while time.monotonic() < until_s:
        timed("GET", "/api/v1/trainings?limit=50")
        timed("PUT", "/api/v1/stage", {"playing": True})
        timed("GET", "/readyz")
        if not runs or timed("GET", f"/api/v1/trainings/{runs[-1]['id']}")["state"] == "finished":
            body = {**BODY, "steps": 200}
            runs.append(timed("POST", "/api/v1/trainings", body, 202))
        time.sleep(0.02)
    return latencies_s, runs


@pytest.mark.timeout(600)
def test_anonymous_load_fails_no_run(launch: Callable[..., Served], tmp_path: Path) -> None:
    with (tmp_path / "log").open("w") as log:
        before = ("prlimit", f"--nofile={FILES}:{FILES}")
        server = launch(log=log, before=before, HEXAPODS_TOKEN=TOKEN)
        server.client.headers.update(OPERATOR)
        lasting = server.start(ENDLESS)
        learned = server.start({**BODY, "steps": 500, "divisions": 8})
        server.in_state(learned, "finished")
        table = f"/api/v1/trainings/{learned['id']}/q-table"
        paths = [table, "/api/v1/events", "/viewer/", "/api/v1/trainings?limit=100"]
        heavy = [table, f"{table}?format=csv", "/openapi.json", "/metrics"]
        port = int(server.address.rpartition(":")[2])
        with (
            watched(server.process.pid) as peak,
            idle_connections(port, paths) as idle,
            readers(port, heavy) as reads,
        ):
            latencies_s, runs = operate(server, time.monotonic() + SECONDS)

        for run in runs:
            server.in_state(run, "finished")
        now = server.look(lasting)
        p95_s = statistics.quantiles(latencies_s, n=20)[-1]
        log_bytes = (tmp_path / "log").stat().st_size
        logging.getLogger(__name__).info(
            "%d requests, p95 %.0f ms, most %.0f ms; %d trainings; most %s; log %d bytes; "
            "idle connections %s; reads %s",
            *(len(latencies_s), p95_s * 1e3, max(latencies_s) * 1e3, len(runs), peak, log_bytes),
            *(idle, reads),
        )
        assert now["state"] == "running", now["error"]
        assert now["progress"]["done"] > 0
        assert runs
        assert p95_s < MAX_P95_S
        assert peak["memory"] < MEMORY_BYTES
        assert peak["files"] < FILES
        assert log_bytes < LOG_BYTES
        assert reads["200"] > 0, reads
        assert sum(report["came_back"] for report in idle) > 0, (
            "the server never closed a connection"
        )
        assert server.end() == 0
