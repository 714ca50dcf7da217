"""Promise 13: SIGTERM drains: a checkpoint is written, exit 0 within 10 s, no child left.

SIGINT does the same. In full but for the 10 s, which apply under `make soak`.
"""

import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx2
import psutil

from app.events.run_view import run_view
from app.features.experiments.trial_rows import Trials
from app.storage.run import NOT_ENDED
from tests.promises.length import at_length
from tests.promises.trainings import checkpoint_step
from tests.served import BODY, ENDLESS, Served
from tests.storage.stores import opened
from tests.timeouts import LONG_S

ENDED_S = at_length(LONG_S, 10.0)
VISITORS = at_length(20, 120)
"""Of a demo: each has two runs that wait."""
OF_ADDRESS = 30
TOKEN = "a-token-for-tests"


def end_and_check(server: Served, by: int) -> None:
    """End a server by a signal, and check that all its processes end in time."""
    children = psutil.Process(server.process.pid).children(recursive=True)
    began = time.monotonic()
    assert server.end(by) == 0
    assert time.monotonic() - began < ENDED_S
    _, left = psutil.wait_procs(children, timeout=LONG_S)
    assert not left


def occupy(server: Served, runs: list[dict[str, Any]]) -> dict[str, int]:
    """Pause the first run, which frees a core for the last but one; return each run's steps."""
    for run in runs[:-1]:
        server.after_step(run, server.look(run)["progress"]["done"] + 1)
        if run is runs[0]:
            assert server.tell(run, "pause").status_code == 202
    states = {server.look(run)["state"] for run in runs}
    assert states == NOT_ENDED, "a run in each state that it can leave"
    return {run["id"]: server.look(run)["progress"]["done"] for run in runs}


def check_interrupted(folder: Path, now: dict[str, Any], done_before: dict[str, int]) -> None:
    assert now["state"] == "interrupted"
    assert now["can_resume"]
    done = now["progress"]["done"]
    assert done >= done_before[now["id"]]
    assert checkpoint_step(folder, now["id"]) == (done or None), "progress and checkpoint agree"


def test_a_signal_drains_the_server(launch: Callable[..., Served], tmp_path: Path) -> None:
    """It is ended by SIGTERM, goes on with the same runs, and is ended by SIGINT."""
    server = launch()
    cores = psutil.cpu_count() or 1
    runs = [server.start(ENDLESS) for _ in range(cores + 2)]
    done_before = occupy(server, runs)
    end_and_check(server, signal.SIGTERM)

    server = launch()
    for run in runs:
        check_interrupted(tmp_path, server.look(run), done_before)
        assert server.tell(run, "resume").json()["state"] != "interrupted"
    done_before = occupy(server, runs)
    end_and_check(server, signal.SIGINT)

    with opened(tmp_path, None) as store:
        for run in runs:
            check_interrupted(tmp_path, run_view(store.get(run["id"])), done_before)


def test_sigterm_drains_a_long_queue(launch: Callable[..., Served], tmp_path: Path) -> None:
    demo = {"HEXAPODS_DEMO": "1", "HEXAPODS_STARTS_PER_MINUTE": "1000000"}
    server = launch(HEXAPODS_TOKEN=TOKEN, **demo)
    operator = {"Authorization": f"Bearer {TOKEN}"}
    for _ in range(psutil.cpu_count() or 1):
        started = server.client.post("/api/v1/trainings", json=ENDLESS, headers=operator)
        assert started.status_code == 202, started.text
    ids = [run_id for number in range(VISITORS) for run_id in visit(server, number)]
    end_and_check(server, signal.SIGTERM)
    with opened(tmp_path, None) as store:
        runs = [store.get(run_id) for run_id in ids]
    ends = {(run.state, run.error) for run in runs}
    assert ends == {("interrupted", "The server was stopped before its turn came.")}
    assert all(run.ended_at is not None for run in runs)


def visit(server: Served, number: int) -> list[str]:
    """Start two runs as a visitor, of an address that it shares; return their ids."""
    address = f"127.0.0.{2 + number // OF_ADDRESS}"
    transport = httpx2.HTTPTransport(local_address=address)
    with httpx2.Client(base_url=server.address, transport=transport, timeout=LONG_S) as client:
        body = {**BODY, "steps": 20}
        answers = [client.post("/api/v1/trainings", json=body) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [202, 202], answers[-1].text
    return [answer.json()["id"] for answer in answers]


def test_sigterm_ends_an_experiment_and_its_cluster(
    launch: Callable[..., Served], tmp_path: Path
) -> None:
    """The processes of a what-if end as well."""
    server = launch()
    body = {"experiment": "sweep", "simulator": "kinematic", "steps": 1000, "workers": 1}
    run = server.start(body, "/experiments")
    question = {"gait": "left-right-origin", "steps": 5}
    assert server.client.post("/api/v1/what-if", json=question).status_code == 200
    server.after_step(run, 1)
    end_and_check(server, signal.SIGTERM)

    with opened(tmp_path, None) as store:
        now = store.get(run["id"])
        trials = Trials(store.database).get(run["id"])
    assert (now.state, now.error) == ("interrupted", "The server was stopped while it ran.")
    assert len(trials) >= now.done > 0
