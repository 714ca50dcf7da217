"""Promise 11: diverged physics is detected: an injected NaN fails the run within one step.

The NaN is injected by a stored checkpoint, the only external input to a robot's state. In full:
one step after it the run is `failed`, reports that the physics diverged, and has no evaluation.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.assembly import build_learner
from app.runs.config import training_config
from app.runs.tables import snapshot, to_bytes
from app.runs.training import train
from app.storage.run import CHECKPOINT
from tests.promises.length import at_length
from tests.served import Served
from tests.storage.stores import opened, training

CONFIG = training_config(gait="left-right-origin", steps=500, evaluate_every=1)
STEP = 3


@pytest.mark.parametrize("place", at_length([2, -1], range(-60, 60, 7)))
def test_a_run_with_a_nan_in_its_state_fails_within_a_step(
    place: int, launch: Callable[..., Served], tmp_path: Path
) -> None:
    learner = build_learner(CONFIG)
    records = train(learner, CONFIG)
    while learner.step < STEP:
        next(records)
    learner.due_epsilon = None
    saved = snapshot(learner, CONFIG, changes=[])
    row = saved.arrays["state.row"].copy()
    row[place] = np.nan
    broken = to_bytes(replace(saved, arrays={**saved.arrays, "state.row": row}))
    with opened(tmp_path, None) as store:
        store.create(training("broken", config=CONFIG, state="interrupted", done=STEP, total=500))
        store.put_artifact("broken", CHECKPOINT, broken)

    server = launch()
    run = server.look({"kind": "training", "id": "broken"})
    assert server.tell(run, "resume").status_code == 202
    now = server.in_state(run, "failed", "finished")
    assert now["state"] == "failed"
    assert "diverged" in now["error"]
    assert now["progress"]["done"] == STEP
    curve = server.client.get("/api/v1/trainings/broken/curve").json()
    assert curve["evaluations"] == []
