"""A run as code: its commands and its Python program, executed, make the same run."""

import contextlib
import io
import json
import shlex
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from app.features.run_code.run_code import MAX_CONTINUED, run_code
from app.storage.run import Run
from tests.api.calls import Api, refused
from tests.cli.running import in_process
from tests.quick_robot import HASTY_JSON
from tests.storage.stores import temporary_store, training

ROBOT = {**HASTY_JSON, "femur_m": 0.09}
GAIT = {"right_leg": 1, "left_leg": 4, "pairs": [[1, 4], [2, 6], [3, 5]]}


@pytest.fixture
def code(api: Api) -> Any:
    return lambda run: api.get(f"/runs/{run['id']}/code")


def commands_of(text: str) -> list[list[str]]:
    lines = text.replace("\\\n", "").splitlines()
    return [shlex.split(line) for line in lines if not line.startswith("#")]


def results_of_commands(text: str, folder: Path) -> list[dict[str, Any]]:
    """Run the commands, and return the result that each prints."""
    results = []
    for program, *arguments in commands_of(text):
        assert program == "hexapods"
        done = in_process(*arguments, "--json", folder=folder)
        assert done.returncode == 0, done.stderr
        results.append(json.loads(done.stdout)["result"])
    return results


def results_of_program(text: str, folder: Path) -> list[dict[str, Any]]:
    """Run the program, and return its results, each of which it prints."""
    out = io.StringIO()
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.chdir(folder), contextlib.redirect_stdout(out):
        exec(compile(text, "the program", "exec"), names)
    results = [value for value in names.values() if isinstance(value, hx.Training | hx.Race)]
    assert out.getvalue().splitlines() == [repr(run.result) for run in results]
    return [asdict(run.result) for run in results if run.result is not None]


def distances(result: dict[str, Any]) -> list[float]:
    return [lane["total_distance_m"] for lane in result["lanes"]]


def test_a_race_and_its_practice_are_made_again_by_commands_and_by_the_program(
    api: Api, code: Any, tmp_path: Path
) -> None:
    practice = {
        "steps": 60,
        "settings": {"alpha": 0.2},
        "evaluate_every": 0,
        "observation": "commanded",
    }
    race = api.race(
        gait=GAIT,
        robot=ROBOT,
        simulator="mujoco",
        disturbances=[{"kind": "limp", "legs": [1, 4], "at_step": 2}],
        steps=4,
        seed=7,
        lanes=[
            {"agent": "q-learning", "training": practice, "keep_learning": True},
            {"agent": "look-ahead", "settings": {"depth": 1}, "plans_with": "world"},
            {
                "agent": "sarsa",
                "keep_learning": True,
                "observation": "planned",
                "settings": {"gamma": 0.5},
            },
        ],
    )
    finished = api.finished(race)
    training = api.get(f"/trainings/{finished['config']['lanes'][0]['training_id']}")
    shown = code(finished)
    for results in (
        results_of_commands(shown["command"], tmp_path),
        results_of_program(shown["python"], tmp_path),
    ):
        practised, raced = results
        assert practised["q_table_sha256"] == training["result"]["q_table_sha256"]
        assert practised["distance_m"] == training["result"]["distance_m"]
        assert distances(raced) == distances(finished["result"])
    assert "--depth" not in shown["command"]
    assert "--disturb limp:legs=1,4:at=2" in shown["command"]


def test_a_continued_training_begins_with_the_one_before(
    api: Api, code: Any, tmp_path: Path
) -> None:
    first = api.finished(api.train(steps=40, seed=3, evaluate_every=0, agent="sarsa-lambda"))
    second = api.finished(
        api.train(steps=30, evaluate_every=0, agent="sarsa-lambda", continue_from=first["id"])
    )
    shown = code(second)
    for results in (
        results_of_commands(shown["command"], tmp_path),
        results_of_program(shown["python"], tmp_path),
    ):
        assert [result["q_table_sha256"] for result in results] == [
            run["result"]["q_table_sha256"] for run in (first, second)
        ]
    api.call("DELETE", f"/runs?id={first['id']}")
    shown = code(second)
    assert f"trainings/{first['id']}/q-table?format=npz" in shown["command"]
    assert commands_of(shown["command"])[0][0] == "curl"
    assert f"hx.load('q-{first['id']}.npz')" in shown["python"]


def test_what_changed_while_it_ran_changes_in_the_program_too(
    api: Api, code: Any, tmp_path: Path
) -> None:
    run = api.train(steps=400, pace=5, evaluate_every=0, simulator="mujoco", robot=ROBOT)
    api.until(run, lambda now: now["progress"]["done"] > 3)
    change = {"settings": {"alpha": 0.05}}
    assert api.call("PATCH", f"/trainings/{run['id']}", json=change).status_code == 200
    limp = {"kind": "limp", "legs": [2]}
    assert api.call("POST", f"/trainings/{run['id']}/disturbances", json=limp).status_code == 202
    api.call("PATCH", f"/trainings/{run['id']}", json={"pace": "max"})
    finished = api.finished(run)
    assert {name for change in finished["changes"] for name in change} == {
        "step",
        "settings",
        "disturbance",
        "pace",
    }
    shown = code(finished)
    [result] = results_of_program(shown["python"], tmp_path)
    assert result == finished["result"]
    assert "# While it ran, alpha changed" in shown["command"]


def test_an_experiment_is_made_again(api: Api, code: Any, tmp_path: Path) -> None:
    body = {
        "experiment": "sweep",
        "simulator": "kinematic",
        "seeds": 2,
        "gaits": ["left-right-origin"],
        "agents": ["q-learning", "sarsa"],
        "steps": [20],
        "settings": {"alpha": [0.1, 0.3]},
    }
    run = api.start("/experiments", body)
    api.tell(run, "stop")
    shown = code(run)
    [[_, *command]] = commands_of(shown["command"])
    assert command[0] == "sweep"
    compile(shown["python"], "the program", "exec")
    again = in_process(*command, "--workers", "1", "--json", folder=tmp_path)
    assert again.returncode == 0, again.stderr
    summary = json.loads(again.stdout)
    config = {**api.look(run)["config"]}
    assert summary["config"] == config


def test_a_run_is_started_again_with_the_same_outcome(api: Api) -> None:
    race = api.finished(
        api.race(
            lanes=[{"agent": "q-learning", "training": {"steps": 30}}, {"agent": "greedy"}], steps=3
        )
    )
    key = {"Idempotency-Key": f"again-{race['id']}"}
    runs = [api.call("POST", f"/runs/{race['id']}/again", headers=key).json() for _ in range(2)]
    assert runs[0]["id"] == runs[1]["id"] != race["id"]
    again = api.finished(runs[0])
    assert again["config"] == race["config"]
    assert distances(again["result"]) == distances(race["result"])
    refused(api.call("POST", "/runs/nothing/again"), 404, "nothing")
    [training_id] = [i for i in (lane["training_id"] for lane in race["config"]["lanes"]) if i]
    api.call("DELETE", f"/runs?id={training_id}")
    refused(api.call("POST", f"/runs/{race['id']}/again"), 422, training_id)


def test_a_long_row_of_trainings_begins_with_a_table() -> None:
    began = datetime.now(UTC)

    def continued(run_id: str, continued_from: str | None) -> Run:
        fields = {"started_at": began, "continued_from": continued_from}
        return training(run_id, state="finished", **fields)

    with temporary_store() as store:
        ids = [f"{number:04}" for number in range(600)]
        before = [None, *ids]
        store.create(
            *(continued(*run_and_parent) for run_and_parent in zip(ids, before, strict=False))
        )
        store.create(continued("a", "b"), continued("b", "a"))
        lines = commands_of(run_code(store.get(ids[-1]), store, "http://x/").command)
        commands_of(run_code(store.get("a"), store, "http://x/").command)

    assert [line[0] for line in lines] == ["curl", *["hexapods"] * MAX_CONTINUED]
    assert f"/{ids[-1 - MAX_CONTINUED]}/" in lines[0][-1]
    assert f"q-{ids[-1]}.npz" in lines[-1]


def test_what_people_pressed_is_pressed_in_the_program_too(
    api: Api, code: Any, tmp_path: Path
) -> None:
    settings = {"trainer": "people"}
    run = api.train(
        agent="tamer", steps=60, pace=8, evaluate_every=10, settings=settings, gait="tripod"
    )
    api.until(run, lambda now: now["progress"]["done"] > 6)
    for presses in ([[5.2, 1], [5.8, -0.5]], [[7.31, -1]]):
        changed = api.call("PATCH", f"/trainings/{run['id']}", json={"presses": presses})
        assert changed.status_code == 200
        assert changed.json()["changes"][-1]["presses"] == presses
    api.call("PATCH", f"/trainings/{run['id']}", json={"pace": "max"})
    finished = api.finished(run)
    shown = code(finished)
    [result] = results_of_program(shown["python"], tmp_path)

    assert result == finished["result"]
    assert "People taught it by presses" in shown["command"]
