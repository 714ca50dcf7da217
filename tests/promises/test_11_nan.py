"""Promise 11: diverged physics is detected: an injected NaN fails the run within one step.

The NaN is injected by a stored checkpoint, the only external input to a robot's state. In full:
one step after it the run is `failed`, reports that the physics diverged, and has no evaluation.
Here at two places of the state; at more by `make soak`.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.storage.run import CHECKPOINT
from hexapods.assembly import build_learner
from hexapods.runs.config import training_config
from hexapods.runs.tables import snapshot, to_bytes
from hexapods.runs.training import train
from tests.promises.length import at_length
from tests.served import Served
from tests.storage.stores import opened, training

pytestmark = pytest.mark.test

CONFIG = training_config(gait="left-right-origin", steps=500, evaluate_every=1)
STEP = 3


PLACES = at_length([2, -1], [*range(-60, 60, 7)])


def test_a_run_with_a_nan_in_its_state_fails_within_a_step(
    launch: Callable[..., Served], tmp_path: Path
) -> None:
    learner = build_learner(CONFIG)
    records = train(learner, CONFIG)
    while learner.step < STEP:
        next(records)
    learner.due_epsilon = None
    saved = snapshot(learner, CONFIG, changes=[])
    ids = [f"broken-{place}" for place in PLACES]
    with opened(tmp_path, None) as store:
        for run_id, place in zip(ids, PLACES, strict=True):
            row = saved.arrays["state.row"].copy()
            row[place] = np.nan
            broken = to_bytes(replace(saved, arrays={**saved.arrays, "state.row": row}))
            fields = {"config": CONFIG, "state": "interrupted", "done": STEP, "total": 500}
            store.create(training(run_id, **fields))
            store.put_artifact(run_id, CHECKPOINT, broken)

    server = launch()
    runs = [server.look({"kind": "training", "id": run_id}) for run_id in ids]
    for run in runs:
        assert server.tell(run, "resume").status_code == 202
    for run in runs:
        now = server.in_state(run, "failed", "finished")
        assert now["state"] == "failed", now
        assert "diverged" in now["error"]
        assert now["progress"]["done"] == STEP
        curve = server.client.get(f"/api/v1/trainings/{run['id']}/curve").json()
        assert curve["evaluations"] == []
