"""The resource `trainings`: start, live changes, learning curve, Q-table, import."""

import csv
import io
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from hexapods.agents.table_rows import TableRows
from hexapods.assembly import build_learner
from hexapods.runs.config import training_config
from hexapods.runs.results import training_result
from hexapods.runs.tables import from_bytes, table_of
from hexapods.runs.training import train
from tests.api.calls import WALK, Api, refused
from tests.quick_robot import HASTY, HASTY_JSON


def train_directly(**fields: Any) -> dict[str, Any]:
    config = training_config(gait=WALK["gait"], **fields)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    return asdict(training_result(learner, config))


def test_training_needs_only_a_gait(api: Api) -> None:
    run = api.start("/trainings", {"gait": "front-back-vertical"})
    api.stop(run)
    config = run["config"]
    assert run["kind"] == "training"
    assert run["name"] == "Q-learning, 500 steps"
    assert run["state"] == "queued"
    assert run["progress"] == {"done": 0, "total": 500}
    assert (config["steps"], config["settings"]["alpha"], config["settings"]["gamma"]) == (
        500,
        0.3,
        0.9,
    )
    assert (config["observation"], config["simulator"]) == ("measured", "mujoco")
    assert run["created_at"].endswith("Z")


def test_names_tell_what_runs_differ_in(api: Api) -> None:
    settings = {"settings": {"alpha": 0.5}, "world": "ice", "steps": 30}
    training = api.start("/trainings", {"gait": WALK["gait"], **settings})
    lanes = [{"agent": "greedy"}, {"agent": "look-ahead", "settings": {"depth": 3}}]
    race = api.start("/races", {"gait": WALK["gait"], "lanes": lanes, "steps": 2})
    assert training["name"] == "Q-learning, α\u00a00.5, 30 steps, ice"
    assert race["name"] == "Race: Greedy, Look-ahead"


def test_result_equals_that_of_a_direct_call_on_kinematic(
    api: Api, trained: dict[str, Any]
) -> None:
    again = api.finished(api.train())
    assert trained["result"] == again["result"]
    assert trained["result"] == train_directly(steps=100, simulator="kinematic")


def test_result_equals_that_of_a_direct_call_on_mujoco(api: Api) -> None:
    body = {"gait": WALK["gait"], "robot": HASTY_JSON, "steps": 30, "seed": 7}
    run = api.finished(api.start("/trainings", body))
    assert run["result"] == train_directly(robot=HASTY, steps=30, seed=7)


def test_curve_has_the_evaluations_as_json_and_csv(api: Api, trained: dict[str, Any]) -> None:
    curve = api.get(f"/trainings/{trained['id']}/curve")
    assert [row["step"] for row in curve["evaluations"]] == [50, 100]
    assert curve["evaluations"][-1]["distance_m"] == trained["result"]["distance_m"]
    assert curve["greedy_distance_m"] == pytest.approx(24.833 * 0.02, abs=1e-3 * 0.02)
    assert curve["best_known_m"] is None  # it is computed in MuJoCo
    response = api.call(
        "GET", f"/trainings/{trained['id']}/curve", headers={"Accept": "text/csv, */*;q=0.1"}
    )
    rows = list(csv.DictReader(io.StringIO(response.text)))
    assert [{k: float(v) for k, v in row.items()} for row in rows] == curve["evaluations"]


def test_table_is_returned_as_json_npz_and_csv(api: Api, trained: dict[str, Any]) -> None:
    path = f"/trainings/{trained['id']}/q-table"
    shown = api.get(path)
    assert (shown["gait"], shown["divisions"], shown["grid_side_m"]) == (WALK["gait"], 2, 0.04)
    assert shown["cells"][0] == [0, 0]
    assert len(shown["values"]) == 1500
    table = table_of(from_bytes(api.call("GET", path, params={"format": "npz"}).content, "it"))
    assert isinstance(table, TableRows)
    assert table.sha256() == trained["result"]["q_table_sha256"]
    by_state = {state: (values, visits) for state, values, visits in table.rows()}
    for entry in shown["values"]:
        (values, visits), (pair, cell) = by_state[tuple(entry["state"])], entry["action"]
        assert values[pair, cell] == entry["value"]
        assert visits[pair, cell] == entry["visits"]
    rows = list(csv.DictReader(io.StringIO(api.call("GET", f"{path}?format=csv").text)))
    assert len(rows) == 1500
    assert sum(int(row["visits"]) for row in rows) == 100
    by_accept = api.call("GET", path, headers={"Accept": "application/x-npz"})
    assert by_accept.headers["content-type"] == "application/x-npz"


def test_table_can_be_imported_and_raced(api: Api, trained: dict[str, Any]) -> None:
    data = api.call("GET", f"/trainings/{trained['id']}/q-table?format=npz").content
    response = api.call("POST", "/trainings/import?name=from+elsewhere", content=data)
    assert response.status_code == 201
    run = response.json()
    assert response.headers["location"] == f"/api/v1/trainings/{run['id']}"
    assert (run["name"], run["state"]) == ("from elsewhere", "finished")
    assert run["result"]["q_table_sha256"] == trained["result"]["q_table_sha256"]
    shared = ("gait", "steps", "seed", "settings", "observation", "agent")
    assert all(run["config"][name] == trained["config"][name] for name in shared)
    lanes = [{"agent": "q-learning", "training_id": run["id"]}]
    assert api.finished(api.race(lanes=lanes))["result"]["lanes"][0]["steps"] == 50


def test_damaged_table_is_refused(api: Api, trained: dict[str, Any]) -> None:
    data = api.call("GET", f"/trainings/{trained['id']}/q-table?format=npz").content
    middle = len(data) // 2
    changed = data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :]
    bomb = io.BytesIO()
    np.savez_compressed(bomb, meta=np.zeros(10_000_000))
    for wrong in (changed, data[:middle], b"no zip", bomb.getvalue()):
        refused(api.call("POST", "/trainings/import", content=wrong), 422, "The file")
    refused(api.call("POST", "/trainings/import"), 422, ".npz")


def test_training_continues_from_another(api: Api, trained: dict[str, Any]) -> None:
    more = api.finished(api.train(continue_from=trained["id"]))
    assert more["config"]["continue_from"] == trained["id"]
    table = api.get(f"/trainings/{more['id']}/q-table")
    assert sum(entry["visits"] for entry in table["values"]) == 200
    body = {**WALK, "continue_from": trained["id"]}
    refused(api.call("POST", "/trainings", json={**body, "seed": 1}), 422, "seed")
    other = {**body, "gait": "front-back-origin"}
    refused(api.call("POST", "/trainings", json=other), 422, "gait", "front-back-origin")
    unseen = {**body, "continue_from": "nothing"}
    refused(api.call("POST", "/trainings", json=unseen), 422, "nothing", "/api/v1/trainings")


def test_training_can_be_paused_resumed_and_stopped(api: Api) -> None:
    run = api.slow_training()
    refused(api.tell(run, "resume"), 409, "running", "paused")
    assert api.tell(run, "pause").json()["state"] == "paused"
    assert api.tell(run, "pause").json()["state"] == "paused"
    refused(api.call("DELETE", f"/trainings/{run['id']}"), 409)
    assert api.tell(run, "resume").json()["state"] == "running"
    stopped = api.tell(run, "stop")
    assert stopped.status_code == 202
    now = api.look(run)
    assert now["state"] == "stopped"
    assert now["result"]["q_table_sha256"]
    table = api.get(f"/trainings/{run['id']}/q-table")
    assert sum(entry["visits"] for entry in table["values"]) == now["progress"]["done"]
    problem = refused(api.tell(run, "stop"), 409, "stopped")
    assert problem["state"] == "stopped"
    assert api.call("DELETE", f"/trainings/{run['id']}").status_code == 204
    refused(api.call("GET", f"/trainings/{run['id']}"), 404, run["id"])


def test_learner_without_values_has_no_table_to_show(api: Api) -> None:
    run = api.finished(api.train(agent="linear-model", steps=5, evaluate_every=0))
    assert run["result"]["q_table_sha256"] is None
    for how in ("json", "csv"):
        response = api.call("GET", f"/trainings/{run['id']}/q-table", params={"format": how})
        refused(response, 409, "agent linear-model keeps no Q-table; take it as ?format=npz")


def test_live_changes_are_applied_and_recorded(api: Api) -> None:
    run = api.slow_training()
    path = f"/trainings/{run['id']}"
    now = api.call("PATCH", path, json={"settings": {"alpha": 0.1, "epsilon": 0.5}}).json()
    assert [c["settings"] for c in now["changes"]] == [{"alpha": 0.1, "epsilon": 0.5}]
    api.tell(run, "pause")
    now = api.call("PATCH", path, json={"pace": "max", "settings": {"gamma": 0}}).json()
    step = now["changes"][-1]["step"]
    assert now["changes"][-1] == {"step": step, "pace": "max", "settings": {"gamma": 0}}
    api.stop(run)
    data = api.call("GET", f"{path}/q-table?format=npz").content
    assert from_bytes(data, "it").meta["changes"] == now["changes"]
    refused(api.call("PATCH", path, json={"pace": 1}), 409, "stopped")
    bodies: list[dict[str, Any]] = [{}, {"settings": {}}, {"pace": 0}, {"steps": 5}]
    for body in bodies:
        refused(api.call("PATCH", path, json=body), 422)
    for settings in ({"alpha": None}, {"alpha": 0}, {"gamma": 1}, {"pace": 3}):
        refused(api.call("PATCH", path, json={"settings": settings}), 422)


def test_presses_are_recorded_where_the_agent_learns_from_them(api: Api) -> None:
    run = api.slow_training(agent="tamer", settings={"trainer": "people"})
    path = f"/trainings/{run['id']}"
    now = api.call("PATCH", path, json={"presses": [[0, 1], [0.5, -0.25]]}).json()
    assert now["changes"][-1]["presses"] == [[0, 1], [0.5, -0.25]]
    for presses in ([], [[1]], [[-1, 1]], [[1, 2]], [[1, True]], [[1, 1]] * 101, "+"):
        refused(api.call("PATCH", path, json={"presses": presses}), 422, "presses")
    api.stop(run)
    other = api.slow_training()
    answer = api.call("PATCH", f"/trainings/{other['id']}", json={"presses": [[0, 1]]})
    refused(answer, 422, "does not learn from presses; those that do: tamer")
    api.stop(other)


def test_training_with_live_changes_is_reproducible(api: Api) -> None:
    run = api.slow_training()
    change = {"settings": {"alpha": 0.05}, "pace": 50}
    now = api.call("PATCH", f"/trainings/{run['id']}", json=change).json()
    api.until(run, lambda then: then["progress"]["done"] > now["changes"][0]["step"] + 20)
    api.stop(run)
    now = api.look(run)
    config = training_config(
        gait=WALK["gait"], simulator="kinematic", steps=10_000_000, evaluate_every=0
    )
    learner = build_learner(config)
    for _ in train(learner, config):
        for change in now["changes"]:
            if learner.step == change["step"]:
                learner.walker.agent.tune(**change["settings"])  # type: ignore[attr-defined]
        if learner.step == now["progress"]["done"]:
            break
    result = training_result(learner, config, measure_reference=False)
    assert asdict(result) == now["result"]


def test_list_is_paginated_newest_first(api: Api, trained: dict[str, Any]) -> None:
    ids = [api.finished(api.train(steps=1, name=f"page {n}"))["id"] for n in range(3)]
    first = api.get("/trainings?limit=2&state=finished")
    assert [run["id"] for run in first["items"]] == ids[:0:-1]
    second = api.get(f"/trainings?limit=1&state=finished&cursor={first['next_cursor']}")
    assert [run["id"] for run in second["items"]] == ids[:1]
    assert all(run["kind"] == "training" for run in api.get("/trainings")["items"])
    refused(api.call("GET", "/trainings?state=lost"), 422, "queued", "interrupted")
    refused(api.call("GET", "/trainings?limit=0"), 422, "1 to 100")


def test_race_is_not_found_among_trainings(api: Api) -> None:
    race = api.finished(api.race(lanes=[{"agent": "greedy"}]))
    refused(api.call("GET", f"/trainings/{race['id']}"), 404, race["id"])
    refused(api.call("POST", f"/trainings/{race['id']}/stop"), 404)


def test_diverged_physics_fails_the_run_with_the_reason(api: Api) -> None:
    body = {"gait": WALK["gait"], "steps": 200, "robot": {"dt_s": 0.005, "servo_kp": 1000.0,
            "servo_torque_nm": 100.0, "servo_kv": 0.001, "tibia_kg": 0.001, "foot_kg": 0.001,
            "coxa_kg": 0.001, "femur_kg": 0.001, "joint_armature": 0.0001,
            "joint_damping": 0.0001}}  # fmt: skip
    run = api.ended(api.start("/trainings", body))
    assert run["state"] == "failed", run
    assert "diverged" in run["error"]
    assert "Traceback" not in run["error"]
