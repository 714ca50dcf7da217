"""The resource `experiments`: what is asked for, what fills, and what is there in the end."""

import csv
import io
import json
from collections.abc import Callable
from typing import Any

import pytest

from app.experiments.config import experiment_config
from tests.api.calls import Api, refused
from tests.jobs.experiments import tried

Serve = Callable[..., Api]
SMALL = {
    "experiment": "sweep",
    "seeds": 3,
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "steps": 40,
    "alpha": [0.1, 0.5],
    "workers": 1,
}


@pytest.fixture(scope="module")
def swept(api: Api) -> dict[str, Any]:
    """A small grid that is finished."""
    return api.finished(api.start("/experiments", {**SMALL, "name": "<b>Mine</b>"}))


def test_it_ends_with_a_summary_and_a_report(swept: dict[str, Any], api: Api) -> None:
    assert (swept["kind"], swept["name"], swept["workers"]) == ("experiment", "<b>Mine</b>", 1)
    assert swept["progress"] == {"done": 7, "total": 7}
    assert swept["config"]["alpha"] == [0.1, 0.5]
    assert swept["config"]["robots"] == [{"preset": "stiff"}]
    result = swept["result"]
    assert result["trials"] == {"done": 7, "total": 7, "failed": 0, "set_aside": 0}
    assert isinstance(result["shared_machine"], bool)
    summary = api.get(f"/experiments/{swept['id']}/summary")
    assert summary["trials"]["done"] == 7
    assert len(summary["settings"]) == 3
    assert "experiment" in {run["kind"] for run in api.get("/experiments")["items"]}
    assert swept["id"] not in {run["id"] for run in api.get("/trainings")["items"]}


def test_the_report_comes_with_a_policy_that_lets_nothing_run(
    swept: dict[str, Any], api: Api
) -> None:
    for path in ("report", *(f"files/{name}" for name in swept["result"]["files"])):
        answer = api.call("GET", f"/experiments/{swept['id']}/{path}")
        assert answer.status_code == 200, path
        policy = answer.headers["content-security-policy"]
        assert policy.startswith("default-src 'none'; style-src 'unsafe-inline'; img-src data:;")
        assert "sandbox" in policy
        assert swept["id"] in answer.headers["content-disposition"]
    page = api.call("GET", f"/experiments/{swept['id']}/report")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.headers["content-disposition"].startswith("inline")
    assert "<script" not in page.text
    kinds = {name.rpartition(".")[2] for name in swept["result"]["files"]}
    assert kinds >= {"html", "json", "csv", "png", "svg", "pdf"}


def test_trials_are_there_one_by_one(swept: dict[str, Any], api: Api) -> None:
    rows = api.get(f"/experiments/{swept['id']}/trials")["trials"]
    given = {"seeds": 3, "simulator": "kinematic", "gaits": ("left-right-origin",)}
    config = experiment_config("sweep", {**given, "steps": (40,), "alpha": (0.1, 0.5)})
    plain = json.loads(json.dumps(tried(config)))
    assert {row["key"]: row["result"] for row in rows} == plain
    answer = api.call("GET", f"/experiments/{swept['id']}/trials?format=csv")
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    table = list(csv.DictReader(io.StringIO(answer.text)))
    assert len(table) == 7
    file = api.call("GET", f"/experiments/{swept['id']}/files/trials.csv")
    assert file.content == answer.content


def test_only_its_own_files_are_given(swept: dict[str, Any], api: Api) -> None:
    for name in ("nothing", "q-table.npz", "../run.json", "..%2f..%2frun.json", "figures", "%00"):
        answer = api.call("GET", f"/experiments/{swept['id']}/files/{name}")
        assert answer.status_code == 404, name
    refused(api.call("GET", f"/experiments/{swept['id']}/files/no"), 404, "report.html")
    for path in ("", "/summary", "/report", "/trials", "/files/report.html", "/export"):
        refused(api.call("GET", f"/experiments/none{path}"), 404, "/api/v1/experiments")


def test_it_moves_to_another_server(swept: dict[str, Any], api: Api) -> None:
    archive = api.call("GET", f"/experiments/{swept['id']}/export")
    assert archive.headers["content-type"] == "application/zip"
    answer = api.call("POST", "/import", content=archive.content)
    assert answer.status_code == 201, answer.text
    copy = answer.json()
    assert copy["id"] != swept["id"]
    assert {**copy, "id": swept["id"]} == swept
    for path in ("summary", "trials"):
        there = api.get(f"/experiments/{copy['id']}/{path}")
        assert there == api.get(f"/experiments/{swept['id']}/{path}")
    assert api.call("DELETE", f"/experiments/{copy['id']}").status_code == 204
    refused(api.call("GET", f"/experiments/{copy['id']}/summary"), 404)


def test_before_it_has_begun_there_is_an_empty_summary_and_no_report(serve: Serve) -> None:
    calm = serve()
    run = calm.start("/experiments", {"experiment": "table1"})
    assert (run["name"], run["progress"]["total"]) == ("Table 1, 30 seeds", 1008)
    summary = calm.get(f"/experiments/{run['id']}/summary")
    assert summary["trials"] == {"done": 0, "total": 1008, "failed": 0, "set_aside": []}
    assert (summary["experiment"], summary["settings"]) == ("table1", [])
    told = refused(calm.call("GET", f"/experiments/{run['id']}/report"), 409, "finished or stopped")
    assert told["state"] == "queued"
    assert calm.get(f"/experiments/{run['id']}/trials") == {"trials": []}
    stopped = calm.tell(run, "stop").json()
    assert stopped["state"] == "stopped"
    assert calm.tell(run, "resume").json()["state"] == "queued"
    refused(calm.tell(run, "resume"), 409, "failed or interrupted or paused or stopped")


def test_the_same_key_is_the_same_experiment(serve: Serve) -> None:
    calm = serve()
    key = {"Idempotency-Key": "once"}
    answers = [calm.call("POST", "/experiments", json=SMALL, headers=key) for _ in range(3)]
    assert len({answer.json()["id"] for answer in answers}) == 1


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({}, "experiment is missing; it must be one of table1, figure4, sweep"),
        ({"experiment": "table2"}, "one of table1, figure4, sweep"),
        ({"seeds": 0}, "seeds must be a whole number from 1 to 10,000"),
        ({"seeds": 2.5}, "seeds must be"),
        ({"seed": -1}, "seed must be"),
        ({"gaits": []}, "gaits must be a list"),
        ({"gaits": ["hop"]}, "left-right-vertical"),
        ({"gaits": ["left-right-origin"] * 2}, "names something twice"),
        ({"observations": "felt"}, "measured, commanded"),
        ({"robots": ["stiff", "soft"]}, "compliant"),
        ({"robots": [{"femur_m": -1}]}, "femur_m"),
        ({"agents": ["app.agents.q_learning:QLearning"]}, "q-learning"),
        ({"alpha": [0.3, 2]}, "alpha.1 must be a number over 0"),
        ({"alpha": "0.3"}, "alpha"),
        ({"gamma": 1}, "gamma"),
        ({"divisions": [1]}, "divisions"),
        ({"grid_side_m": [5]}, "reach"),
        ({"steps": 0}, "steps"),
        ({"workers": 0}, "workers must be"),
        ({"workers": 500}, "cores of this machine"),
        ({"name": "x" * 101}, "name"),
        ({"simulator": "real"}, "mujoco, kinematic"),
        ({"colour": 1}, "colour"),
        ({"blocks": 2}, "blocks"),
        ({"experiment": "table1", "alpha": [0.1]}, "alpha"),
        ({"experiment": "figure4", "steps": [100]}, "steps"),
        ({"seeds": 10_000, "alpha": [n / 100 for n in range(1, 51)]}, "trials"),
        ({"gamma": [n / 200 for n in range(100)], "alpha": [n / 100 for n in range(1, 101)]},
         "settings"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_in_a_sentence(
    serve: Serve, body: dict[str, Any], words: str
) -> None:
    whole = body if not body else {"experiment": "sweep", "simulator": "kinematic", **body}
    calm = serve()
    refused(calm.call("POST", "/experiments", json=whole), 422, words)
    assert calm.get("/experiments")["items"] == []


def test_experiments_are_not_for_the_stage(serve: Serve) -> None:
    calm = serve()
    run = calm.start("/experiments", SMALL)
    assert calm.get("/stage")["run_id"] is None
    refused(calm.call("PUT", "/stage", json={"run_id": run["id"]}), 422, "trainings and races")
    assert calm.get("/stage")["run_id"] is None
    training = calm.train()
    assert calm.get("/stage")["run_id"] == training["id"]


def test_a_form_is_told_all_that_it_needs(api: Api) -> None:
    options = api.get("/options")
    shown = {one["name"]: one for one in options["experiments"]}
    assert list(shown) == ["table1", "figure4", "sweep"]
    assert shown["table1"]["defaults"]["robots"] == ["stiff", "compliant"]
    assert shown["table1"]["defaults"]["seeds"] == 30
    assert shown["figure4"]["defaults"]["blocks"] == 8
    assert shown["sweep"]["grid"][:3] == ["steps", "alpha", "gamma"]
    assert "agents" not in shown["table1"]["fields"]
    assert options["limits"]["seeds"] == [1, 10_000]
    for one in shown.values():
        assert one["title"]
        assert one["description"].endswith(".")
        assert set(one["fields"]) <= set(options["help"])


@pytest.mark.parametrize("body", [{}, {"gait": "left-right-origin", "steps": 2_001}])
def test_a_what_if_says_what_is_wrong(serve: Serve, body: dict[str, Any]) -> None:
    refused(serve().call("POST", "/what-if", json=body), 422)


def test_a_what_if_begins_with_an_empty_table(serve: Serve) -> None:
    body = {"gait": "left-right-origin", "continue_from": "abc"}
    refused(serve().call("POST", "/what-if", json=body), 422, "continue_from")


def test_a_what_if_has_both_halves(api: Api) -> None:
    body = {"gait": "left-right-origin", "steps": 20, "alpha": 0.7, "seed": 3, "name": "x"}
    answer = api.call("POST", "/what-if", json=body).json()
    assert (answer["seeds"], len(answer["chosen"]["distances_m"])) == (30, 30)
    assert (answer["chosen"]["alpha"], answer["default"]["alpha"]) == (0.7, 0.3)
    assert answer["compute_s"] > 0
