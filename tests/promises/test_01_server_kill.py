"""Promise 1: kill -9 of the server loses at most one checkpoint, 5 s of training.

Promised: 50 kills at random times. Here one of a training, 50 by `make soak`; the store's part is
in `test_01_kill.py`. After each kill the training is resumed from its newest checkpoint.
"""

import random
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from app.storage.run import CHECKPOINT
from hexapods.runs.tables import from_bytes
from tests.promises.length import at_length
from tests.served import BODY, Served
from tests.storage.stores import opened

KILLS = at_length(1, 50)
LOST_S = 5.0


@pytest.mark.timeout(60 + 60 * KILLS)
def test_a_kill_loses_at_most_one_checkpoint(launch: Callable[..., Served], tmp_path: Path) -> None:
    chance = random.Random(1)
    server = launch()
    run = server.start({**BODY, "steps": 10_000_000, "pace": 100, "evaluate_every": 100})
    for _ in range(KILLS):
        observed = watch_progress(server, run, chance.uniform(0, LOST_S + 2))
        server.end(signal.SIGKILL)
        acknowledged = max(
            (done for at_s, done in observed if at_s <= observed[-1][0] - LOST_S), default=0
        )
        with opened(tmp_path, None) as store:
            stored_run = store.get(run["id"])
            data = store.artifact(run["id"], CHECKPOINT)
            step = 0 if data is None else from_bytes(data, "the checkpoint").meta["step"]
            rows = [row["step"] for row in store.curves.get(run["id"])]
        assert stored_run.state == "interrupted"
        assert step >= acknowledged
        assert rows == list(range(100, len(rows) * 100 + 1, 100)), "neither gaps nor duplicates"
        assert len(rows) >= step // 100 - 1, "the curve must not be behind the checkpoint"
        server = launch()
        assert server.tell(run, "resume").json()["progress"]["done"] == step
    server.after_step(run, step + 1)
    assert server.tell(run, "stop").json()["state"] == "stopped"


def watch_progress(server: Served, run: dict[str, object], for_s: float) -> list[tuple[float, int]]:
    """Sample (time [s], steps done) of a run, from its next step on and for `for_s` seconds."""
    begun = server.look(run)["progress"]["done"]
    server.after_step(run, begun + 1)
    observed: list[tuple[float, int]] = []
    until_s = time.monotonic() + for_s
    while not observed or time.monotonic() < until_s:
        done = server.look(run)["progress"]["done"]
        observed.append((time.monotonic(), done))
        time.sleep(0.1)
    return observed
