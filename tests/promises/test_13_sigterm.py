"""Promise 13: SIGTERM drains: a checkpoint is written, exit 0 within 10 s, no child left.

SIGINT does the same. In full, since there is nothing to shorten.
"""

import signal
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from tests.promises.trainings import checkpoint_step
from tests.served import ENDLESS, Served


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "SIGINT"])
def test_a_signal_drains_the_server(by: int, launch: Callable[..., Served], tmp_path: Path) -> None:
    server = launch()
    first = server.start(ENDLESS)
    server.after_step(first, 5)
    assert server.tell(first, "pause").status_code == 202
    cores = psutil.cpu_count() or 1
    runs = [first, *(server.start(ENDLESS) for _ in range(cores + 1))]
    for run in runs[1:-1]:
        server.moving(run)
    assert server.look(runs[-1])["state"] == "queued"
    done_before = {run["id"]: server.look(run)["progress"]["done"] for run in runs}
    children = psutil.Process(server.process.pid).children(recursive=True)
    began = time.monotonic()
    assert server.end(by) == 0
    assert time.monotonic() - began < 10
    _, left = psutil.wait_procs(children, timeout=5)
    assert not left

    server = launch()
    for run in runs:
        now = server.look(run)
        assert now["state"] == "interrupted"
        done = now["progress"]["done"]
        assert done >= done_before[run["id"]]
        assert checkpoint_step(tmp_path, run["id"]) == (done or None), (
            "progress and checkpoint agree"
        )
        assert server.tell(run, "resume").json()["state"] != "interrupted"
        server.tell(run, "stop")


def test_sigterm_ends_an_experiment_and_its_cluster(launch: Callable[..., Served]) -> None:
    """The processes of a what-if end as well."""
    server = launch()
    body = {"experiment": "sweep", "simulator": "kinematic", "steps": 1000, "workers": 1}
    run = server.start(body, "/experiments")
    question = {"gait": "left-right-origin", "steps": 5}
    assert server.client.post("/api/v1/what-if", json=question).status_code == 200
    server.after_step(run, 1)
    children = psutil.Process(server.process.pid).children(recursive=True)
    began = time.monotonic()
    assert server.end() == 0
    assert time.monotonic() - began < 10
    _, left = psutil.wait_procs(children, timeout=5)
    assert not left

    server = launch()
    now = server.look(run)
    assert (now["state"], now["error"]) == ("interrupted", "The server was stopped while it ran.")
    trials = server.client.get(f"/api/v1/experiments/{run['id']}/trials").json()["trials"]
    assert len(trials) >= now["progress"]["done"] > 0
