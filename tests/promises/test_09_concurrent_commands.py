"""Promise 9: of two identical concurrent commands, one succeeds and the other gets 409.

Promised: 1,000 pairs. Here 60, of pause, resume and stop, and of resuming an interrupted run; by
`make soak` 1,000. No orphaned process is left.
"""

import signal
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import httpx2
import pytest

from tests.promises.length import at_length
from tests.served import ENDLESS, Served
from tests.timeouts import LONG_S

pytestmark = pytest.mark.test

RUNS = at_length(1, 10)
PAIRS_A_RUN = at_length(60, 100)


@pytest.mark.timeout(at_length(120, 1800))
def test_one_of_two_operators_wins(launch: Callable[..., Served]) -> None:
    server = launch()
    with ThreadPoolExecutor(2) as operators:
        barrier = Barrier(2)

        def at_once(path: str) -> list[int]:
            def act(client: httpx2.Client) -> int:
                barrier.wait(LONG_S)
                return client.post(path).status_code

            return sorted(operators.map(act, clients))

        clients = make_clients(server)
        for _ in range(RUNS):
            run = server.start(ENDLESS)
            server.moving(run)
            path = f"/api/v1/trainings/{run['id']}"
            verbs = ["pause", "resume"] * (PAIRS_A_RUN // 2 - 1) + ["pause", "stop"]
            for verb in verbs:
                assert at_once(f"{path}/{verb}") == [202, 409], verb
            assert server.look(run)["state"] == "stopped"
        left = server.start(ENDLESS)
        server.moving(left)
        for client in clients:
            client.close()
        assert server.end(signal.SIGTERM) == 0
        server = launch()
        clients = make_clients(server)
        assert at_once(f"/api/v1/trainings/{left['id']}/resume") == [202, 409]
        assert at_once(f"/api/v1/trainings/{left['id']}/stop") == [202, 409]
        for client in clients:
            client.close()
    deadline = time.monotonic() + LONG_S
    while server.jobs():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def make_clients(server: Served) -> list[httpx2.Client]:
    """Return two HTTP clients, one for each operator."""
    return [
        httpx2.Client(base_url=server.address, timeout=LONG_S, trust_env=False) for _ in range(2)
    ]
