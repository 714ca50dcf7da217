"""The resource `experiments`: start, summary, trials, report."""

import csv
import io
import json
from collections.abc import Callable
from typing import Any

import pytest

from hexapods.experiments.config import experiment_config
from tests.api.calls import Api, refused
from tests.features.experiments.sweeps import results_of_trials
from tests.features.needing import needs

Serve = Callable[..., Api]
SMALL = {
    "experiment": "sweep",
    "seeds": 3,
    "simulator": "kinematic",
    "gaits": "left-right-origin",
    "steps": 40,
    "settings": {"alpha": [0.1, 0.5]},
    "workers": 1,
}


@pytest.fixture(scope="module")
def swept(api: Api) -> dict[str, Any]:
    """Return a finished sweep over a small grid."""
    return api.finished(api.start("/experiments", {**SMALL, "name": "<b>Mine</b>"}))


def test_finished_experiment_has_summary_and_report(swept: dict[str, Any], api: Api) -> None:
    assert (swept["kind"], swept["name"], swept["workers"]) == ("experiment", "<b>Mine</b>", 1)
    assert swept["progress"] == {"done": 7, "total": 7}
    assert swept["config"]["settings"]["alpha"] == [0.1, 0.5]
    assert swept["config"]["robots"] == [{"preset": "stiff"}]
    result = swept["result"]
    assert result["trials"] == {"done": 7, "total": 7, "failed": 0, "set_aside": 0}
    assert isinstance(result["shared_machine"], bool)
    summary = api.get(f"/experiments/{swept['id']}/summary")
    assert summary["trials"]["done"] == 7
    assert len(summary["settings"]) == 3
    assert "experiment" in {run["kind"] for run in api.get("/experiments")["items"]}
    assert swept["id"] not in {run["id"] for run in api.get("/trainings")["items"]}


def test_stored_files_have_a_policy_that_forbids_scripts(swept: dict[str, Any], api: Api) -> None:
    for path in (f"files/{name}" for name in swept["result"]["files"]):
        answer = api.call("GET", f"/experiments/{swept['id']}/{path}")
        assert answer.status_code == 200, path
        policy = answer.headers["content-security-policy"]
        assert policy.startswith("default-src 'none'; style-src 'unsafe-inline'; img-src data:;")
        assert "sandbox" in policy
        assert swept["id"] in answer.headers["content-disposition"]
    page = api.call("GET", f"/experiments/{swept['id']}/report")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.headers["content-disposition"].startswith("inline")
    assert "allow-same-origin" not in page.headers["content-security-policy"]
    assert page.headers["content-security-policy"].startswith("sandbox ")
    assert "connect-src 'none'" in page.text
    assert set(swept["result"]["files"]) == {"report.html", "summary.json", "trials.csv"}


def test_trials_are_returned_as_json_and_csv(swept: dict[str, Any], api: Api) -> None:
    rows = api.get(f"/experiments/{swept['id']}/trials")["trials"]
    values = {"seeds": 3, "simulator": "kinematic", "gaits": ("left-right-origin",)}
    config = experiment_config("sweep", {**values, "steps": (40,), "alpha": (0.1, 0.5)})
    plain = json.loads(json.dumps(results_of_trials(config)))
    assert {row["key"]: row["result"] for row in rows} == plain
    answer = api.call("GET", f"/experiments/{swept['id']}/trials?format=csv")
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    table = list(csv.DictReader(io.StringIO(answer.text)))
    assert len(table) == 7
    file = api.call("GET", f"/experiments/{swept['id']}/files/trials.csv")
    assert file.content == answer.content


def test_only_report_files_are_served(swept: dict[str, Any], api: Api) -> None:
    for name in ("nothing", "q-table.npz", "../run.json", "..%2f..%2frun.json", "figures", "%00"):
        answer = api.call("GET", f"/experiments/{swept['id']}/files/{name}")
        assert answer.status_code == 404, name
    refused(api.call("GET", f"/experiments/{swept['id']}/files/no"), 404, "report.html")
    for path in ("", "/summary", "/report", "/trials", "/files/report.html"):
        refused(api.call("GET", f"/experiments/none{path}"), 404, "/api/v1/experiments")


@needs("archives")
def test_exported_experiment_can_be_imported(swept: dict[str, Any], api: Api) -> None:
    refused(api.call("GET", "/experiments/none/export"), 404, "/api/v1/experiments")
    archive = api.call("GET", f"/experiments/{swept['id']}/export")
    assert archive.headers["content-type"] == "application/zip"
    answer = api.call("POST", "/import", content=archive.content)
    assert answer.status_code == 201, answer.text
    copy = answer.json()
    assert copy["id"] != swept["id"]
    assert {**copy, "id": swept["id"]} == swept
    for path in ("summary", "trials"):
        shown = api.get(f"/experiments/{copy['id']}/{path}")
        assert shown == api.get(f"/experiments/{swept['id']}/{path}")
    assert api.call("DELETE", f"/experiments/{copy['id']}").status_code == 204
    refused(api.call("GET", f"/experiments/{copy['id']}/summary"), 404)


def test_queued_experiment_has_an_empty_summary_and_no_report(serve: Serve) -> None:
    idle = serve()
    run = idle.start("/experiments", {"experiment": "table1"})
    assert (run["name"], run["progress"]["total"]) == ("Table 1 · 30 seeds", 1008)
    summary = idle.get(f"/experiments/{run['id']}/summary")
    assert summary["trials"] == {"done": 0, "total": 1008, "failed": 0, "set_aside": []}
    assert (summary["experiment"], summary["settings"]) == ("table1", [])
    problem = refused(
        idle.call("GET", f"/experiments/{run['id']}/report"), 409, "finished or stopped"
    )
    assert problem["state"] == "queued"
    assert idle.get(f"/experiments/{run['id']}/trials") == {"trials": []}
    stopped = idle.tell(run, "stop").json()
    assert stopped["state"] == "stopped"
    assert idle.tell(run, "resume").json()["state"] == "queued"
    refused(idle.tell(run, "resume"), 409, "failed or interrupted or paused or stopped")


def test_same_idempotency_key_returns_the_same_experiment(serve: Serve) -> None:
    idle = serve()
    key = {"Idempotency-Key": "once"}
    answers = [idle.call("POST", "/experiments", json=SMALL, headers=key) for _ in range(3)]
    assert len({answer.json()["id"] for answer in answers}) == 1


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({}, "experiment is missing; it must be one of table1, figure4, sweep, league, recovery"),
        ({"experiment": "table2"}, "one of table1, figure4, sweep, league, recovery"),
        ({"seeds": 0}, "seeds must be a whole number from 1 to 10,000"),
        ({"seeds": 2.5}, "seeds must be"),
        ({"seed": -1}, "seed must be"),
        ({"gaits": []}, "gaits must be a list"),
        ({"settings": {"alpha": []}}, "alpha must be a list of at least 1 value."),
        ({"settings": {"alpha": [0.1] * 101}}, "alpha must be a list of at most 100 values."),
        ({"experiment": "league", "worlds": []}, "worlds must be a list, each the name of a world"),
        ({"experiment": "league", "worlds": [5]}, "worlds.0 must be a list, each the name"),
        ({"gaits": ["hop"]}, "left-right-vertical"),
        ({"gaits": ["left-right-origin"] * 2}, "names something twice"),
        ({"observations": "felt"}, "measured, commanded"),
        ({"robots": ["stiff", "soft"]}, "compliant"),
        ({"robots": [{"femur_m": -1}]}, "femur_m"),
        ({"agents": ["hexapods.agents.q_learning:QLearning"]}, "q-learning"),
        ({"settings": {"alpha": [0.3, 2]}}, "settings.alpha.1 must be a number over 0"),
        ({"settings": {"alpha": "0.3"}}, "alpha"),
        ({"settings": {"gamma": 1}}, "gamma"),
        ({"divisions": [1]}, "divisions"),
        ({"grid_side_m": [5]}, "reach"),
        ({"steps": 0}, "steps"),
        ({"workers": 0}, "workers must be"),
        ({"workers": 500}, "cores of this machine"),
        ({"name": "x" * 101}, "name"),
        ({"simulator": "real"}, "mujoco, kinematic"),
        ({"colour": 1}, "colour"),
        ({"blocks": 2}, "blocks"),
        ({"experiment": "table1", "settings": {"alpha": [0.1]}}, "alpha"),
        ({"experiment": "figure4", "steps": [100]}, "steps"),
        ({"experiment": "league", "worlds": ["moon"]}, "limp-pair"),
        ({"experiment": "league", "tolerance": 0.3}, "tolerance"),
        ({"experiment": "league", "tolerance": 0.1}, "mujoco"),
        ({"experiment": "recovery", "worlds": ["ice:at=5"]}, "ice"),
        ({"worlds": ["ice"]}, "worlds"),
        ({"seeds": 10_000, "settings": {"alpha": [n / 100 for n in range(1, 51)]}}, "trials"),
        ({"settings": {"gamma": [n / 200 for n in range(100)],
                       "alpha": [n / 100 for n in range(1, 101)]}}, "settings"),
    ],
)  # fmt: skip
def test_invalid_experiment_is_refused_with_a_sentence(
    serve: Serve, body: dict[str, Any], words: str
) -> None:
    whole = body if not body else {"experiment": "sweep", "simulator": "kinematic", **body}
    idle = serve()
    refused(idle.call("POST", "/experiments", json=whole), 422, words)
    assert idle.get("/experiments")["items"] == []


def test_experiment_cannot_be_shown_on_stage(serve: Serve) -> None:
    idle = serve()
    run = idle.start("/experiments", SMALL)
    assert idle.get("/stage")["run_id"] is None
    refused(idle.call("PUT", "/stage", json={"run_id": run["id"]}), 422, "trainings and races")
    assert idle.get("/stage")["run_id"] is None
    training = idle.train()
    assert idle.get("/stage")["run_id"] == training["id"]


def test_options_describe_every_experiment(api: Api) -> None:
    options = api.get("/options")
    shown = {entry["name"]: entry for entry in options["experiments"]}
    assert list(shown)[:5] == ["table1", "figure4", "sweep", "league", "recovery"]
    assert list(shown)[5:] == ["groups", "bodies"]
    assert shown["table1"]["defaults"]["robots"] == ["stiff", "compliant"]
    assert shown["table1"]["defaults"]["seeds"] == 30
    assert shown["figure4"]["defaults"]["blocks"] == 8
    assert shown["sweep"]["grid"][:3] == ["steps", "alpha", "gamma"]
    assert "agents" not in shown["table1"]["fields"]
    assert options["limits"]["seeds"] == [1, 10_000]
    ideal = shown["recovery"]["simulator_defaults"]["kinematic"]
    assert ideal == {"worlds": ["noise"], "tolerance": 0.0}
    assert not any(shown["league"]["simulator_defaults"]["mujoco"].values())
    assert {"greedy", "q-learning"} & {*shown["recovery"]["agents"]} == {"q-learning"}
    assert {"greedy", "q-learning"} < {*shown["league"]["agents"]}
    assert shown["table1"]["agents"] == []
    for entry in shown.values():
        assert entry["title"]
        assert entry["description"].endswith(".")
        assert set(entry["fields"]) <= set(options["help"])


@pytest.mark.promises
@pytest.mark.parametrize("experiment", ["league", "recovery", "groups", "bodies"])
def test_experiments_with_curves_run_on_the_server(experiment: str, api: Api) -> None:
    body = {
        "experiment": experiment,
        "seeds": 3,
        "simulator": "kinematic",
        **({"robots": "dog"} if experiment == "bodies" else {"gaits": "left-right-origin"}),
        "agents": ["q-learning", "linear-model"],
        "worlds": "noise",
        "steps": 30,
        "workers": 1,
    }
    run = api.finished(api.start("/experiments", body))
    # greedy, greedy that plans without the noise, two learners; three seeds of each
    assert run["progress"] == {"done": 12, "total": 12}
    assert (run["config"]["worlds"], run["config"]["tolerance"]) == (["noise"], 0.0)
    worlds = api.get(f"/experiments/{run['id']}/summary")["worlds"]
    assert {world["agent"]: world["n"] for world in worlds} == {
        "greedy": 3,
        "q-learning": 3,
        "linear-model": 3,
    }
