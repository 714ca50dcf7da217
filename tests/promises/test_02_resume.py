"""Promise 2: resume is bit-exact.

A training is killed with its server and later interrupted by SIGTERM, its rates are changed in
between, and yet its table, random generator and robot are those of an uninterrupted run: the file
is the same byte by byte. Promised for a run; here for one on each simulator, by `make soak` four.
Both simulators' trainings run beside each other.
"""

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.promises.length import at_length
from tests.promises.trainings import checkpoint_step, uninterrupted
from tests.served import Served

EVALUATED = at_length(60, 20)
"""Steps between evaluations, which take most of the time on MuJoCo."""
SEEDS = at_length([3], [3, 4, 5, 6])
STEPS = {"kinematic": 900, "mujoco": at_length(240, 300)}
"""By simulator; the kinematic one must not be done while a busy machine delays the other."""


@pytest.mark.parametrize("seed", SEEDS)
def test_interrupted_trainings_end_like_uninterrupted_ones(
    seed: int, launch: Callable[..., Served], tmp_path: Path
) -> None:
    body = {"gait": "left-right-origin", "seed": seed, "pace": 20, "steps_per_episode": 20}
    server = launch()
    runs = [
        server.start({**body, "simulator": simulator, "steps": steps, "evaluate_every": EVALUATED})
        for simulator, steps in STEPS.items()
    ]
    for run in runs:
        server.after_step(run, 25)
        assert server.tell(run, "pause").status_code == 202
        server.until(run, lambda now: checkpoint_step(tmp_path, now["id"]) is not None)
    for run in runs:
        assert server.tell(run, "resume").status_code == 202
    for run in runs:
        server.after_step(run, 45)
        rates = {"settings": {"alpha": 0.7, "epsilon": 0.5}}
        changed = server.client.patch(path_of(run), json=rates)
        assert changed.status_code == 200, changed.text
    for run in runs:
        server.after_step(run, 65)
    server.end(signal.SIGKILL)

    server = launch()
    for run in runs:
        assert server.look(run)["state"] == "interrupted"
        assert server.tell(run, "resume").json()["state"] != "interrupted"
    for run in runs:
        server.after_step(run, 85)
        rates = {"settings": {"gamma": 0.8}}
        assert server.client.patch(path_of(run), json=rates).status_code == 200
    assert server.end(signal.SIGTERM) == 0

    server = launch()
    for run in runs:
        left = server.look(run)
        assert left["state"] == "interrupted"
        assert left["progress"]["done"] >= 85
        assert server.tell(run, "resume").json()["progress"]["done"] == left["progress"]["done"]
        server.in_state(run, "running")
        assert server.client.patch(path_of(run), json={"pace": "max"}).status_code == 200
    for run in runs:
        check_end(server, run)


def path_of(run: dict[str, Any]) -> str:
    return f"/api/v1/trainings/{run['id']}"


def check_end(server: Served, run: dict[str, Any]) -> None:
    """Check that a training ends with the table and curve of an uninterrupted one."""
    ended = server.in_state(run, "finished", "failed")
    assert ended["state"] == "finished", ended
    assert [sorted(c.get("settings", c)) for c in ended["changes"]] == [
        ["alpha", "epsilon"],
        ["gamma"],
        ["pace", "step"],
    ]
    table, curve = uninterrupted(ended["config"], ended["changes"])
    assert server.client.get(f"{path_of(run)}/q-table?format=npz").content == table
    assert server.client.get(f"{path_of(run)}/curve").json()["evaluations"] == curve
    assert [row["step"] for row in curve] == list(
        range(EVALUATED, ended["config"]["steps"] + 1, EVALUATED)
    )
