"""Invalid input is refused with a 4xx whose detail names the valid values."""

import json
from typing import Any

import pytest

from tests.api.calls import WALK, Api, refused
from tests.features.needing import needs

NAN = float("nan")
WRONG_TRAININGS: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"gait": "gallop"}, ("gallop", "left-right-origin", "front-back-vertical")),
    ({"gait": 5}, ("gait", "left-right-origin")),
    ({"gait": None}, ("gait", "left-right-origin")),
    ({"gait": {"right_leg": 1, "left_leg": 9, "symmetry": "origin"}}, ("leg 9",)),
    ({"gait": {"right_leg": 1, "left_leg": 2, "symmetry": "round"}}, ("origin, vertical",)),
    ({"gait": {"right_leg": 1, "left_leg": 2}}, ("symmetry", "pairs")),
    ({"gait": {"right_leg": 1, "left_leg": 2, "pairs": [[1, 4], [2, 5]]}}, ("leg 3",)),
    ({"gait": {"right_leg": 1, "left_leg": 2, "pairs": [[1, 4, 5]]}}, ("pairs",)),
    ({"gait": {"right": 1}}, ("right", "right_leg", "left_leg")),
    ({"agent": "wizard"}, ("wizard", "q-learning", "greedy")),
    ({"agent": "os:system"}, ("os:system", "q-learning")),
    ({"agent": "greedy"}, ("Greedy does not learn",)),
    ({"agent": "dyna-q", "divisions": 5}, ("300,000", "1,171,875", "fewer divisions")),
    ({"agent": "r-max", "settings": {"known_after": 0}}, ("known_after", "from 1 to 100")),
    ({"agent": "sarsa", "settings": {"trace_decay": 0.5}}, ("trace_decay",)),
    ({"robot": "steel"}, ("steel", "stiff", "compliant", "slippery")),
    ({"robot": {"wings": 2}}, ("wings", "tibia_m")),
    ({"robot": {"n_legs": 13}}, ("3 to 12 legs",)),
    ({"robot": {"n_legs": 1e400}}, ("n_legs",)),
    ({"robot": {"tibia_m": NAN}}, ("tibia_m",)),
    ({"robot": {"tibia_m": 0.03}}, ("Leg 1", "cell", "grid_side_m")),
    ({"robot": 7}, ("robot", "stiff")),
    ({"grid_side_m": 0.4}, ("Leg 1", "cell", "0.4")),
    ({"tolerance": 0.3}, ("tolerance", "0.2")),
    ({"reward": "sideways"}, ("reward", "forward, or track")),
    ({"tolerance": 0.03, "simulator": "kinematic"}, ("build tolerance", "mujoco")),
    ({"grid_side_m": 0.004}, ("grid_side_m", "0.005")),
    ({"steps": 0}, ("steps", "from 1 to 10,000,000")),
    ({"steps": -1}, ("steps", "from 1 to 10,000,000")),
    ({"steps": 1e12}, ("steps", "from 1 to 10,000,000")),
    ({"steps": 10**12}, ("steps", "from 1 to 10,000,000")),
    ({"steps": NAN}, ("steps", "from 1 to 10,000,000")),
    ({"steps": "500"}, ("steps", "whole number")),
    ({"steps": True}, ("steps", "whole number")),
    ({"steps": None}, ("steps", "whole number")),
    ({"seed": -1}, ("seed", "at least 0")),
    ({"seed": 0.5}, ("seed", "whole number")),
    ({"settings": {"alpha": 0}}, ("alpha", "over 0 and at most 1")),
    ({"settings": {"alpha": 1.1}}, ("alpha", "over 0 and at most 1")),
    ({"settings": {"alpha": float("inf")}}, ("alpha",)),
    ({"settings": {"gamma": 1}}, ("gamma", "under 1")),
    ({"settings": {"epsilon_start": 1.5}}, ("epsilon_start", "from 0 to 1")),
    ({"settings": {"epsilon_end": -0.5}}, ("epsilon_end", "from 0 to 1")),
    ({"steps_per_episode": 0}, ("steps_per_episode",)),
    ({"evaluate_every": -1}, ("evaluate_every", "from 0")),
    ({"divisions": 1}, ("divisions", "from 2 to 8")),
    ({"divisions": 9}, ("divisions", "from 2 to 8")),
    ({"pace": 0}, ("pace", "max")),
    ({"pace": "fast"}, ("pace", "max")),
    ({"pace": True}, ("pace", "max")),
    ({"observation": "guessed"}, ("observation", "measured", "commanded")),
    ({"simulator": "matrix"}, ("simulator", "mujoco", "kinematic")),
    ({"name": "x" * 101}, ("name", "100")),
    ({"name": "two\nlines"}, ("name", "control characters")),
    ({"name": "\ud800"}, ("name",)),
    ({"colour": "red"}, ("colour", "gait", "steps")),
    ({"{braces}": 1}, ("{braces}", "gait")),
    ({"lanes": []}, ("lanes", "gait")),
]


@pytest.mark.parametrize(("wrong", "words"), WRONG_TRAININGS, ids=lambda v: str(v)[:40])
def test_invalid_training_is_refused_with_valid_values(
    api: Api, wrong: dict[str, Any], words: tuple[str, ...]
) -> None:
    # Encoded here, because the client's encoder rejects NaN.
    body = json.dumps({**WALK, **wrong})
    problem = refused(post(api, "/trainings", body), 422, *words)
    assert len(problem["detail"]) < 700


WRONG_RACES: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"lanes": []}, ("lanes", "1 to 6")),
    ({"lanes": [{"agent": "greedy"}] * 7}, ("lanes", "1 to 6")),
    ({"lanes": [{"agent": "wizard"}]}, ("wizard", "two-step")),
    ({"lanes": [{"agent": "q-learning"}]}, ("Lane 1", "training_id", "training")),
    ({"lanes": [{"agent": "greedy", "training": {}}]}, ("Lane 1", "does not learn")),
    ({"lanes": [{"agent": "q-learning", "training_id": "none"}]}, ("none", "/api/v1/trainings")),
    (
        {"lanes": [{"agent": "q-learning", "training": {}, "training_id": "none"}]},
        ("Lane 1", "not both"),
    ),
    ({"lanes": [{"agent": "q-learning", "training": {"gait": "x"}}]}, ("lanes.0", "gait", "steps")),
    ({"lanes": [{"agent": "q-learning", "training": {"steps": 0}}]}, ("lanes.0.training.steps",)),
    ({"lanes": [{"color": "red"}]}, ("color", "training_id")),
    ({"lanes": [{}]}, ("lanes.0.agent", "missing")),
    ({"lanes": "three"}, ("lanes",)),
    ({"steps": 10**7}, ("20,000",)),
    ({"steps": 0}, ("steps",)),
    ({"pace": 1}, ("pace", "lanes")),
    ({"robot": {"n_legs": 12}, "divisions": 8, "grid_side_m": 0.01}, ("64,000,000", "divisions")),
]


@pytest.mark.parametrize(("wrong", "words"), WRONG_RACES, ids=lambda v: str(v)[:40])
def test_invalid_race_is_refused_with_valid_values(
    api: Api, wrong: dict[str, Any], words: tuple[str, ...]
) -> None:
    refused(post(api, "/races", json.dumps({**WALK, **wrong})), 422, *words)


@pytest.mark.parametrize(
    "body",
    ["", "{", "[]", "3", "null", '"text"', "[" * 100_000, '{"gait": 1' + "0" * 10_000 + "}"],
    ids=lambda body: body[:12] or "nothing",
)
def test_invalid_json_is_refused(api: Api, body: str) -> None:
    response = post(api, "/trainings", body)
    assert response.status_code in (400, 422)
    refused(response, response.status_code)


def test_body_that_is_not_json_is_refused(api: Api) -> None:
    refused(api.call("POST", "/trainings", data={"gait": "x"}), 422, "JSON object")
    refused(api.call("POST", "/trainings", content=b"\xff\xfe{"), 422)


@needs("what_if", "experiments")
def test_flat_settings_are_refused_with_the_nested_form(api: Api) -> None:
    for path, body in (
        ("/trainings", {**WALK, "alpha": 0.5, "gamma": 0.8}),
        ("/what-if", {**WALK, "alpha": 0.5, "gamma": 0.8}),
        ("/races", {**WALK, "lanes": [{"agent": "q-learning", "alpha": 0.5, "gamma": 0.8}]}),
        (
            "/races",
            {**WALK, "lanes": [{"agent": "q-learning", "training": {"alpha": 0.5, "gamma": 0.8}}]},
        ),
        ("/experiments", {"experiment": "sweep", "alpha": 0.5, "gamma": 0.8}),
    ):
        refusal = '"settings": {"alpha": 0.5, "gamma": 0.8}'
        assert refusal in refused(api.call("POST", path, json=body), 422)["detail"], path
    run = api.slow_training()
    changed = api.call("PATCH", f"/trainings/{run['id']}", json={"alpha": 0.5})
    assert '"settings": {"alpha": 0.5}' in refused(changed, 422)["detail"]
    api.stop(run)


def test_all_invalid_fields_are_listed(api: Api) -> None:
    body = {**WALK, "steps": 0, "settings": {"alpha": 2}, "pace": "fast"}
    problem = refused(api.call("POST", "/trainings", json=body), 422)
    assert {error["field"] for error in problem["errors"]} == {"steps", "pace", "settings.alpha"}


def test_an_unknown_field_is_told_together_with_the_other_errors(api: Api) -> None:
    body = {"step": 5, "steps": 0, "gait": "hop", "settings": {"alfa": 1, "alpha": 7}}
    problem = refused(api.call("POST", "/trainings", json=body), 422, "did you mean steps?")
    told = {error["field"]: error["detail"] for error in problem["errors"]}
    assert told.keys() == {"", "steps", "gait", "settings", "settings.alpha"}
    assert told[""].startswith("unknown field 'step'; choose one of:")
    assert "did you mean alpha?" in told["settings"]
    assert "Unknown gait 'hop'" in told["gait"]
    lanes = [{"agent": "greedy", "plans": 1, "plans_with": "luck"}, {"agnt": "greedy"}]
    answer = api.call("POST", "/races", json={"lanes": lanes, "steps": 0})
    fields = {error["field"] for error in refused(answer, 422)["errors"]}
    assert fields == {"lanes.0", "lanes.0.plans_with", "lanes.1", "lanes.1.agent", "steps"}
    branch = {"branch_from": {"race_id": 3, "stp": 3}, "more": 1}
    answer = api.call("POST", "/races", json=branch)
    fields = {error["field"] for error in refused(answer, 422)["errors"]}
    assert fields == {"", "branch_from", "branch_from.race_id", "branch_from.step"}


@pytest.mark.parametrize("agent", [3, None, ["greedy"], {"name": "greedy"}])
def test_a_name_that_is_no_text_is_answered_with_all_that_are_valid(
    agent: object, api: Api
) -> None:
    problem = refused(api.call("POST", "/trainings", json={"agent": agent, "steps": 0}), 422)
    told = {error["field"]: error["detail"] for error in problem["errors"]}
    assert told.keys() == {"agent", "steps"}
    assert told["agent"].startswith("agent must be q-learning, double-q, ")
    problem = refused(api.call("POST", "/races", json={"lanes": [{"agent": agent}, 3]}), 422)
    told = {error["field"]: error["detail"] for error in problem["errors"]}
    assert told.keys() == {"lanes.0.agent", "lanes.1"}
    assert ", greedy, " in told["lanes.0.agent"]
    assert told["lanes.1"] == "lanes.1 must be a JSON object."


@needs("experiments", "tournaments", "what_if")
def test_an_unknown_name_is_told_together_with_the_other_errors(api: Api) -> None:
    lane = {"agent": "greedyy", "plans_with": "luck", "settings": {"deep": 1}}
    rules = {"gait": "hop", "worlds": ["moon"], "steps": 0}
    body: dict[str, Any]
    for path, body, wrong in (
        ("/races", {"lanes": [{"agent": "greedyy"}], "steps": -1}, {"lanes.0.agent", "steps"}),
        ("/races", {"lanes": [lane]}, {"lanes.0.agent", "lanes.0.plans_with"}),
        ("/races", {"world": "moon", "steps": -1}, {"world", "steps"}),
        ("/trainings", {"agent": "sarsaa", "step": 1, "seed": -1}, {"agent", "", "seed"}),
        ("/trainings/estimate", {"agent": "sarsaa", "steps": 0}, {"agent", "steps"}),
        ("/what-if", {"agent": "sarsaa", "steps": 0}, {"agent", "steps"}),
        (
            "/experiments",
            {"experiment": "sweep", "agents": ["sarsaa"], "worlds": "moon", "seeds": 0},
            {"agents.0", "worlds.0", "seeds"},
        ),
        ("/tournaments", {"rules": rules}, {"rules.gait", "rules.worlds.0", "rules.steps"}),
    ):
        problem = refused(api.call("POST", path, json=body), 422)
        assert {error["field"] for error in problem["errors"]} == wrong, (path, body)
    several = {"lanes": [{"agent": "greedyy"}, {"agent": "lookahead"}], "gait": "hop"}
    detail = refused(api.call("POST", "/races", json=several), 422)["detail"]
    assert "'greedyy'" in detail
    assert "did you mean look-ahead?" in detail


def test_a_single_unknown_name_is_told_with_its_field(api: Api) -> None:
    for path, body, field in (
        ("/races", {"lanes": [{"agent": "greedy"}, {"agent": "greedyy"}]}, "lanes.1.agent"),
        ("/trainings", {"agent": "sarsaa", "settings": {"trace_decay": 0.5}}, "agent"),
        ("/trainings", {"world": "moon"}, "world"),
    ):
        problem = refused(api.call("POST", path, json=body), 422, "choose one of")
        assert problem["field"] == field
        assert "errors" not in problem


def test_running_training_has_no_table(api: Api) -> None:
    run = api.slow_training()
    lanes = [{"agent": "q-learning", "training_id": run["id"]}]
    problem = refused(
        api.call("POST", "/races", json={**WALK, "lanes": lanes}), 409, "finished or stopped"
    )
    assert problem["state"] == "running"
    refused(api.call("GET", f"/trainings/{run['id']}/q-table"), 409, "running")
    api.stop(run)


def test_table_of_another_gait_or_grid_is_refused(api: Api, trained: dict[str, Any]) -> None:
    lanes = [{"agent": "q-learning", "training_id": trained["id"]}]
    other = {**WALK, "gait": "front-back-origin", "lanes": lanes}
    refused(api.call("POST", "/races", json=other), 422, "gait", "front-back-origin")
    wider = {**WALK, "grid_side_m": 0.05, "lanes": lanes}
    refused(api.call("POST", "/races", json=wider), 422, "grid_side_m")


def test_unknown_paths_and_methods_are_refused(api: Api) -> None:
    refused(api.call("GET", "/contests"), 404, "/docs")
    refused(api.call("GET", "/trainings/none"), 404, "none", "/api/v1/trainings")
    refused(api.call("PUT", "/trainings"), 405, "POST")
    refused(api.client.get("/nothing"), 404)
    refused(api.client.get("/static/../pyproject.toml"), 404)
    refused(api.client.get("/static/%2e%2e/pyproject.toml"), 404)


def test_invalid_stage_change_is_refused(api: Api) -> None:
    refused(api.call("PUT", "/stage", json={"run_id": "none"}), 404, "none")
    for wrong, word in (
        ({"speed": 65}, "0.25 to 64"),
        ({"speed": 0.2}, "0.25 to 64"),
        ({"speed": True}, "time-lapse"),
        ({"speed": "fast"}, "time-lapse"),
        ({"time_s": -1}, "0 or more"),
        ({"clock": "sun"}, "paper, wall, free"),
        ({"playing": 1}, "true or false"),
        ({"volume": 1}, "run_id"),
    ):
        refused(api.call("PUT", "/stage", json=wrong), 422, word)


def post(api: Api, path: str, body: str) -> Any:
    content = body.encode("utf-8", "surrogatepass")
    return api.call("POST", path, content=content, headers={"Content-Type": "application/json"})


@pytest.mark.parametrize("mark", ["\u202e", "\u2066", "\u200f", "\u061c", "\u200b", "\ufeff"])
def test_name_with_invisible_characters_is_refused(api: Api, mark: str) -> None:
    body = {**WALK, "steps": 5, "name": f"a{mark}b"}
    refused(api.call("POST", "/trainings", json=body), 422, "invisible", "writing direction")
    refused(api.call("POST", "/races", json={**WALK, "name": f"{mark}b"}), 422, "invisible")
    imported = api.call("POST", "/trainings/import", params={"name": mark}, content=b"x")
    refused(imported, 422, "invisible")
