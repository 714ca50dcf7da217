"""Promise 14: a dead worker is noticed, and a dead server's runs can be resumed.

kill -9 of a job's process: `failed` with the signal named within 5 s. kill -9 of the server: its
runs are `interrupted` at the next start, in whatever state they were. An experiment repeats no
stored trial, and neither death leaves a process of its cluster. In full, once each, but for the
5 s, which apply under `make soak`.
"""

import json
import signal
import time
from collections.abc import Callable

import psutil
import pytest

from tests.features.experiments.sweeps import results_of_trials, sweep
from tests.promises.length import at_length
from tests.served import BODY, ENDLESS, Served
from tests.timeouts import LONG_S

SEEDS = at_length(10, 16)
NOTICED_S = at_length(LONG_S, 5.0)


def test_a_killed_job_is_soon_failed(launch: Callable[..., Served]) -> None:
    server = launch()
    run = server.start(ENDLESS)
    server.moving(run)
    (job,) = server.jobs()
    began = time.monotonic()
    job.send_signal(signal.SIGKILL)
    now = server.in_state(run, "failed")
    assert time.monotonic() - began < NOTICED_S
    assert "SIGKILL" in now["error"]
    assert "memory" in now["error"]
    other = server.start({**BODY, "steps": 50})
    assert server.in_state(other, "finished", "failed")["state"] == "finished"


def test_a_dead_servers_runs_are_interrupted_and_can_be_resumed(
    launch: Callable[..., Served],
) -> None:
    server = launch()
    # Takes longer than killing the server even on a busy machine.
    short = {**BODY, "steps": 1000, "pace": 12, "evaluate_every": 0}
    practice_body = {"steps": 1000, "pace": 12, "evaluate_every": 0}
    lanes = [{"agent": "q-learning", "training": practice_body}, {"agent": "greedy"}]
    running = server.start(short)
    race = server.start({**BODY, "steps": 10, "lanes": lanes}, "/races")
    (practice,) = race["waiting_for"]
    paused = server.start(ENDLESS)
    server.moving(running)
    queued = [server.start(short) for _ in range(psutil.cpu_count() or 1)]
    children = server.jobs()
    server.end(signal.SIGKILL)
    _, left = psutil.wait_procs(children, timeout=LONG_S)
    assert not left

    server = launch()
    for run in (running, race, paused, *queued):
        assert server.look(run)["state"] == "interrupted"
    for run in (race, running):
        assert server.tell(run, "resume").status_code == 202
        assert server.tell(run, "resume").status_code == 409, "it is resumed already"
    for training in (running["id"], practice):
        server.hurry(training)
    assert server.in_state(running, "finished", "failed")["state"] == "finished"
    raced = server.in_state(race, "finished", "failed", "stopped")
    assert raced["state"] == "finished", raced
    assert raced["result"]["lanes"][0]["training_id"] == practice
    stopped = server.tell(queued[0], "stop")
    assert stopped.status_code == 409


@pytest.mark.timeout(300)
def test_a_dead_servers_experiment_can_be_resumed_and_leaves_no_process(
    launch: Callable[..., Served],
) -> None:
    server = launch()
    body = {"experiment": "sweep", "simulator": "kinematic", "gaits": "left-right-origin"}
    run = server.start({**body, "seeds": SEEDS, "steps": 3000, "workers": 1}, "/experiments")
    server.after_step(run, 1)
    below = psutil.Process(server.process.pid).children(recursive=True)
    assert len(below) > 2, "the fork server, the job's process, and its cluster's"
    server.end(signal.SIGKILL)
    _, left = psutil.wait_procs(below, timeout=LONG_S)
    assert not left

    server = launch()
    assert server.look(run)["state"] == "interrupted"
    path = f"/api/v1/experiments/{run['id']}"
    stored_trials = server.client.get(f"{path}/trials").json()["trials"]
    assert stored_trials
    assert server.client.get(f"{path}/summary").json()["trials"]["total"] == SEEDS + 1
    assert server.tell(run, "resume").status_code == 202
    ended = server.in_state(run, "finished", "failed", "stopped")
    assert ended["state"] == "finished", ended
    rows = server.client.get(f"{path}/trials").json()["trials"]
    assert all(row in rows for row in stored_trials), "some were repeated"
    plain = json.loads(json.dumps(results_of_trials(sweep(seeds=SEEDS, steps=(3000,)))))
    assert {row["key"]: row["result"] for row in rows} == plain
