"""Promise 14: a dead worker is noticed, and a dead server's runs can be resumed.

kill -9 of a job's process: `failed` with the signal named within 5 s. kill -9 of the server: its
runs are `interrupted` at the next start, whatever they were at. In full, once each.
"""

import signal
import time
from collections.abc import Callable

import psutil

from tests.served import BODY, ENDLESS, Served


def test_a_killed_job_is_failed_within_five_seconds(launch: Callable[..., Served]) -> None:
    server = launch()
    run = server.start(ENDLESS)
    server.moving(run)
    (job,) = server.jobs()
    began = time.monotonic()
    job.send_signal(signal.SIGKILL)
    now = server.in_state(run, "failed")
    assert time.monotonic() - began < 5
    assert "SIGKILL" in now["error"]
    assert "memory" in now["error"]
    other = server.start({**BODY, "steps": 50})
    assert server.in_state(other, "finished", "failed")["state"] == "finished"
    assert server.tell(run, "resume").status_code == 409, "what failed is final"


def test_a_dead_servers_runs_are_interrupted_and_go_on(launch: Callable[..., Served]) -> None:
    server = launch()
    short = {**BODY, "steps": 200, "pace": 50}
    lanes = [{"agent": "q-learning", "training": {"steps": 200, "pace": 50}}, {"agent": "greedy"}]
    running = server.start(short)
    race = server.start({**BODY, "steps": 10, "lanes": lanes}, "/races")
    (practice,) = race["waiting_for"]
    paused = server.start(ENDLESS)
    server.moving(running)
    queued = [server.start(short) for _ in range(psutil.cpu_count() or 1)]
    children = server.jobs()
    server.end(signal.SIGKILL)
    _, left = psutil.wait_procs(children, timeout=10)
    assert not left

    server = launch()
    for run in (running, race, paused, *queued):
        assert server.look(run)["state"] == "interrupted"
    for run in (race, running):
        assert server.tell(run, "resume").status_code == 202
        assert server.tell(run, "resume").status_code == 409, "it goes on already"
    assert server.in_state(running, "finished", "failed")["state"] == "finished"
    raced = server.in_state(race, "finished", "failed", "stopped")
    assert raced["state"] == "finished", raced
    assert raced["result"]["lanes"][0]["training_id"] == practice
    stopped = server.tell(queued[0], "stop")
    assert stopped.status_code == 409
