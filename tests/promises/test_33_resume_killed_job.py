"""Promise 33: any dead job can be resumed.

SIGKILL (which the OOM killer sends as well) and SIGSTOP at random moments are detected within 10 s:
the run is `failed`, and resumed from its newest checkpoint it ends with the table of an
uninterrupted run, bit by bit. Here once each, SIGSTOP while changes are sent, without the limit of
10 s; by `make soak` 20 times.
"""

import random
import signal
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from tests.promises.length import at_length
from tests.promises.trainings import uninterrupted
from tests.served import BODY, Served
from tests.timeouts import LONG_S

SIGNALS = at_length([signal.SIGKILL], [signal.SIGKILL, signal.SIGSTOP] * 20)
NOTICED_S = at_length(LONG_S, 10.0)
ANSWERED_S = at_length(4.5, 2.0)
"""Limit of a request's time: a change waits for 5 s, and so would a request behind it."""
PACED = {**BODY, "steps": 400, "pace": 20, "evaluate_every": 100, "seed": 33}


@pytest.mark.timeout(at_length(240, 3600))
def test_a_dead_job_is_detected_and_can_be_resumed(launch: Callable[..., Served]) -> None:
    chance = random.Random(33)
    server = launch()
    for signal_sent in SIGNALS:
        run = server.start(PACED)
        server.after_step(run, chance.randrange(1, 200))
        (job,) = server.jobs()
        began = time.monotonic()
        job.send_signal(signal_sent)
        dead = server.in_state(run, "failed", "finished")
        assert dead["state"] == "failed"
        assert time.monotonic() - began < NOTICED_S
        resume_and_check(server, dead)


def resume_and_check(server: Served, dead: dict[str, Any]) -> None:
    """Check that a dead run can be resumed, and ends with the table of an uninterrupted one."""
    assert dead["can_resume"]
    assert server.tell(dead, "resume").status_code == 202
    server.hurry(dead["id"])
    ended = server.in_state(dead, "failed", "finished")
    assert ended["state"] == "finished", ended
    table, curve = uninterrupted(ended["config"], ended["changes"])
    path = f"/api/v1/trainings/{dead['id']}"
    assert server.client.get(f"{path}/q-table?format=npz").content == table
    assert server.client.get(f"{path}/curve").json()["evaluations"] == curve


def test_a_change_to_a_stopped_process_delays_no_other_request(
    launch: Callable[..., Served],
) -> None:
    """The change is refused, other requests are answered, and the run can be resumed."""
    server = launch()
    run = server.start(PACED)
    server.after_step(run, 5)
    (job,) = server.jobs()
    job.send_signal(signal.SIGSTOP)
    path = f"/api/v1/trainings/{run['id']}"

    def change(_: int) -> int:
        return server.client.patch(path, json={"settings": {"alpha": 0.9}}).status_code

    with ThreadPoolExecutor(30) as pool:
        changing = [pool.submit(change, n) for n in range(30)]
        slowest_s = 0.0
        for _ in range(20):
            began = time.monotonic()
            assert server.client.get(path).status_code == 200
            slowest_s = max(slowest_s, time.monotonic() - began)
            time.sleep(0.02)
        assert {future.result(LONG_S) for future in changing} <= {503, 429}
    assert slowest_s < ANSWERED_S
    dead = server.in_state(run, "failed")
    assert "stopped by a signal" in dead["error"]
    assert dead["changes"] == []
    resume_and_check(server, dead)
