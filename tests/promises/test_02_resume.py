"""Promise 2: resume is bit-exact.

A training is killed with its server and later interrupted by SIGTERM, its rates are changed in
between, and yet its table, random generator and robot are those of an uninterrupted run: the file
is the same byte by byte. Promised for a run; here for one on each simulator, by `make soak` four.
"""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.promises.length import at_length
from tests.promises.trainings import checkpoint_step, uninterrupted
from tests.served import Served

SEEDS = at_length([3], [3, 4, 5, 6])


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("simulator", ["kinematic", "mujoco"])
def test_an_interrupted_training_ends_like_an_uninterrupted_one(
    simulator: str, seed: int, launch: Callable[..., Served], tmp_path: Path
) -> None:
    body = {"gait": "left-right-origin", "simulator": simulator, "seed": seed, "pace": 30}
    server = launch()
    run = server.start({**body, "steps": 180, "steps_per_episode": 20, "evaluate_every": 20})
    path = f"/api/v1/trainings/{run['id']}"
    server.after_step(run, 25)
    assert server.tell(run, "pause").status_code == 202
    server.until(run, lambda _: checkpoint_step(tmp_path, run["id"]) is not None)
    assert server.tell(run, "resume").status_code == 202
    server.after_step(run, 45)
    changed = server.client.patch(path, json={"alpha": 0.7, "epsilon": 0.5})
    assert changed.status_code == 200, changed.text
    server.after_step(run, 65)
    server.end(signal.SIGKILL)

    server = launch()
    assert server.look(run)["state"] == "interrupted"
    assert server.tell(run, "resume").json()["state"] != "interrupted"
    server.after_step(run, 85)
    assert server.client.patch(path, json={"gamma": 0.8}).status_code == 200
    assert server.end(signal.SIGTERM) == 0

    server = launch()
    left = server.look(run)
    assert left["state"] == "interrupted"
    assert left["progress"]["done"] >= 85
    assert server.tell(run, "resume").json()["progress"]["done"] == left["progress"]["done"]
    server.in_state(run, "running")
    assert server.client.patch(path, json={"pace": "max"}).status_code == 200
    ended = server.in_state(run, "finished", "failed")
    assert ended["state"] == "finished", ended

    assert [sorted(set(c) - {"step"}) for c in ended["changes"]] == [
        ["alpha", "epsilon"],
        ["gamma"],
        ["pace"],
    ]
    table, curve = uninterrupted(ended["config"], ended["changes"])
    assert server.client.get(f"{path}/q-table?format=npz").content == table
    assert server.client.get(f"{path}/curve").json()["evaluations"] == curve
    assert [row["step"] for row in curve] == list(range(20, 181, 20))
