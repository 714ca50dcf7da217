"""A class whose pupils judge the steps of a robot by its rewards, as the picture shows them."""

import time
from collections.abc import Callable, Iterator
from typing import Any

Ask = Callable[[str], Any]
"""Returns the answer to a GET, by the path."""


def moments_of(ask: Ask, code: str, run_id: str) -> Iterator[tuple[float, float]]:
    """Yield the time of a training in the picture of a room's stage [s], and what it earns [m].

    Once for each step, in its second half, until the class teaches no more.
    """
    last = -1
    while (teaching := ask(f"/api/v1/rooms/{code}/teaching"))["state"] != "ended":
        stage = ask(f"/r/{code}/api/v1/stage")
        at_step = stage["time_s"] / teaching["step_s"]
        step = int(at_step)
        if stage["run_id"] == run_id and step > last and at_step - step > 0.5:
            last = step
            explained = ask(f"/api/v1/runs/{run_id}/explain?step={step + 1}")
            yield stage["time_s"], explained["reward_m"]
        time.sleep(0.02)
