"""The resource `runs`: runs of every kind, listed, filtered, searched and found by id."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

from tests.api.calls import Api, refused
from tests.features.needing import needs


def names(page: dict[str, Any]) -> list[str]:
    return [run["name"] for run in page["items"]]


def test_runs_of_every_kind_are_listed_and_searched(api: Api) -> None:
    training = api.finished(api.train(name="Zebra tripod", steps=10, evaluate_every=0))
    race = api.finished(api.race(name="A zebra race", lanes=[{"agent": "greedy"}], steps=2))
    assert names(api.get("/runs"))[:2] == ["A zebra race", "Zebra tripod"]
    assert names(api.get("/runs?search=ZEBRA")) == ["A zebra race", "Zebra tripod"]
    assert names(api.get("/runs?search=zebra&kind=training")) == ["Zebra tripod"]
    assert names(api.get("/runs?search=zebra&kind=race&state=finished")) == ["A zebra race"]
    assert names(api.get(f"/runs?search={race['id']}")) == ["A zebra race"]
    assert names(api.get("/trainings?search=zebra%20race")) == []

    first = api.get("/runs?search=zebra&limit=1")
    assert names(first) == ["A zebra race"]
    second = api.get(f"/runs?search=zebra&limit=1&cursor={first['next_cursor']}")
    assert names(second) == ["Zebra tripod"]
    assert second["next_cursor"] is None
    for run in (training, race):
        assert api.get(f"/runs/{run['id']}") == run


@needs("experiments")
def test_an_unknown_filter_value_is_refused_with_the_valid_ones(api: Api) -> None:
    refused(api.call("GET", "/runs?kind=walk"), 422, "kind", "training, race, experiment")
    refused(api.call("GET", "/runs?state=tired"), 422, "state", "running")
    refused(api.call("GET", f"/runs?search={'x' * 101}"), 422, "search", "at most 100 characters")
    refused(api.call("GET", "/runs/nothing"), 404, "nothing")


def test_several_curves_are_answered_at_once_with_few_points(
    api: Api, trained: dict[str, Any]
) -> None:
    often = api.finished(api.train(steps=100, evaluate_every=2))
    never = api.finished(api.train(steps=5, evaluate_every=0))
    query = "&".join(f"id={run_id}" for run_id in (trained["id"], often["id"], never["id"], "none"))
    curves = {curve["id"]: curve for curve in api.get(f"/runs/curves?{query}")["curves"]}
    whole = [api.get(f"/trainings/{run['id']}/curve")["evaluations"] for run in (trained, often)]
    assert curves.keys() == {trained["id"], often["id"]}
    few, many = curves[trained["id"]], curves[often["id"]]
    assert few["steps"] == [row["step"] for row in whole[0]]
    assert few["distances_m"] == [row["distance_m"] for row in whole[0]]
    assert many["steps"] == [row["step"] for row in whole[1]][1::2]
    too_many = "&".join("id=a" for _ in range(101))
    refused(api.call("GET", f"/runs/curves?{too_many}"), 422, "up to 100 of them")
    refused(api.call("GET", "/runs/curves"), 422, "id is missing")


def test_a_run_tells_whether_somebody_named_it(api: Api) -> None:
    start = {"steps": 5, "evaluate_every": 0, "settings": {"alpha": 0.5}, "seed": 3}
    run = api.finished(api.train(**start))
    assert (run["name"], run["is_named"]) == ("Q-learning, α\u00a00.5, 5 steps, seed 3", False)
    more = api.finished(api.train(steps=7, evaluate_every=0, continue_from=run["id"]))
    assert (more["name"], more["is_named"]) == ("Q-learning, 7 more steps, seed 3", False)
    race = api.finished(api.race(lanes=[{"agent": "greedy"}, {"agent": "two-step"}], steps=3))
    branch = {"race_id": race["id"], "step": 1}
    slope = {"kind": "sensor-noise", "at_step": 1, "sd_m": 0.001}
    other = api.start("/races", {"branch_from": branch, "disturbances": [slope]})
    assert (other["name"], other["is_named"]) == (f"{race['name']}, from step 2", False)
    assert [api.finished(other)["is_named"], race["is_named"]] == [False, False]
    path = f"/runs/{run['id']}"
    assert api.call("PATCH", path, json={"name": "My first"}).json()["is_named"]
    # As version 0.1 made them.
    earlier = {"name": "5 steps: Left-right, opposite"}
    assert not api.call("PATCH", path, json=earlier).json()["is_named"]
    assert api.call("POST", f"/runs/{more['id']}/again").json()["is_named"] is False


def test_runs_are_renamed_tagged_and_found_by_tag_in_any_order(api: Api) -> None:
    options = {"steps": 10, "evaluate_every": 0}
    first, second = (api.finished(api.train(name=name, **options)) for name in ("Owl 2", "owl 1"))
    changed = api.call(
        "PATCH", f"/runs/{first['id']}", json={"name": " Owl 3 ", "tags": ["a", "A"]}
    )
    assert changed.status_code == 200
    assert changed.json() == api.look(first) == {**first, "name": "Owl 3", "tags": ["a"]}
    api.call(
        "PATCH", f"/runs/{second['id']}", json={"tags": ["a", "b"], "notes": "one\r\nplumage\t"}
    )
    assert api.look(second) == {**second, "tags": ["a", "b"], "notes": "one\nplumage"}
    assert names(api.get("/runs?tag=A&sort=name")) == ["owl 1", "Owl 3"]
    assert names(api.get("/trainings?tag=b")) == ["owl 1"]
    assert names(api.get("/runs?search=PLUMAGE")) == ["owl 1"]
    page = api.get("/runs?tag=a&sort=distance&limit=1")
    assert names(api.get(f"/runs?tag=a&sort=distance&cursor={page['next_cursor']}")) != names(page)


def test_an_invalid_annotation_is_refused_and_changes_nothing(api: Api) -> None:
    run = api.finished(api.train(name="Kept", steps=5, evaluate_every=0))
    path = f"/runs/{run['id']}"
    for body, words in (
        ({}, ("name, tags, notes",)),
        ({"name": "  "}, ("a visible character",)),
        ({"name": "a\u202eb"}, ("name must be text of at most 100",)),
        ({"tags": ["x" * 31]}, ("at most 20 tags", "at most 30 characters")),
        ({"tags": [f"{n}" for n in range(21)]}, ("at most 20 tags",)),
        ({"tags": "ice"}, ("tags must be a list",)),
        ({"notes": "\x1b"}, ("notes must be text of at most 4,000",)),
        ({"state": "finished"}, ("unknown field 'state'", "name, tags, notes")),
    ):
        refused(api.call("PATCH", path, json=body), 422, *words)
    assert api.look(run) == run
    refused(api.call("PATCH", "/runs/nothing", json={"name": "a"}), 404, "nothing")
    refused(api.call("GET", "/runs?sort=size"), 422, "newest, oldest, name, distance")
    refused(api.call("GET", "/runs?sort=name&cursor=abc"), 422, "must be the next_cursor")
    refused(api.call("GET", "/trainings?cursor=abc"), 422, "must be the next_cursor")


def test_several_runs_are_deleted(api: Api) -> None:
    options = {"steps": 10, "evaluate_every": 0}
    runs = [api.finished(api.train(name=f"Heron {n}", **options)) for n in range(2)]
    live = api.slow_training(name="Heron, live")
    query = "&".join(f"id={run['id']}" for run in runs)
    done = api.call("DELETE", f"/runs?{query}&id={live['id']}&id=none").json()
    assert done["deleted"] == [run["id"] for run in runs]
    reasons = {entry["id"]: entry["reason"] for entry in done["kept"]}
    assert reasons.keys() == {live["id"], "none"}
    assert "stop it first" in reasons[live["id"]]
    api.stop(live)
    refused(api.call("DELETE", "/runs"), 422, "id is missing", "the id of a run")
    many = "&".join("id=a" for _ in range(101))
    refused(api.call("DELETE", f"/runs?{many}"), 422, "up to 100 of them")


def test_a_run_that_was_deleted_is_nowhere_and_comes_back_as_it_was(api: Api) -> None:
    run = api.finished(api.train(name="Heron, deleted", steps=20, evaluate_every=10))
    curve = f"/trainings/{run['id']}/curve"
    before = [api.call("GET", path).json() for path in (f"/runs/{run['id']}", curve)]
    assert api.call("DELETE", f"/trainings/{run['id']}").status_code == 204
    for path in (f"/runs/{run['id']}", curve, f"/trainings/{run['id']}"):
        refused(api.call("GET", path), 404, run["id"])
    for path in ("replay", "replay/scene", "code", "page", "archive"):
        refused(api.call("GET", f"/runs/{run['id']}/{path}"), 404, run["id"])
    assert api.call("GET", f"/runs/curves?id={run['id']}").json() == {"curves": []}
    assert run["id"] not in [item["id"] for item in api.call("GET", "/runs").json()["items"]]
    refused(api.call("POST", f"/runs/{run['id']}/again"), 404, run["id"])
    refused(api.call("DELETE", f"/trainings/{run['id']}"), 404, run["id"])

    restored = api.call("POST", f"/runs/{run['id']}/restore")
    assert (restored.status_code, restored.json()) == (200, before[0])
    assert [api.call("GET", path).json() for path in (f"/runs/{run['id']}", curve)] == before
    assert api.call("GET", f"/runs/{run['id']}/replay/scene").status_code == 200
    again = api.call("POST", f"/runs/{run['id']}/restore")
    assert (again.status_code, again.json()) == (200, before[0]), "it is there already"


def test_what_is_gone_for_good_is_told(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    refused(api.call("POST", "/runs/none/restore"), 404, "none", "can be restored for 1 h")
    run = api.finished(api.train(name="Heron, too late", steps=5, evaluate_every=0))
    answer = api.call("DELETE", f"/runs?id={run['id']}").json()
    assert answer["restorable_until"] > run["ended_at"]
    deletions = api.services.store.deletions
    with monkeypatch.context() as later:
        later.setattr(deletions, "now", lambda: datetime.now(UTC) + timedelta(hours=2))
        assert deletions.purge() > 0
    refused(api.call("POST", f"/runs/{run['id']}/restore"), 404, run["id"], "restored for 1 h")


def test_a_repeated_start_of_a_copy_returns_it_although_the_original_is_gone(api: Api) -> None:
    original = api.finished(api.train(name="Once", steps=5, evaluate_every=0))
    once = {"headers": {"Idempotency-Key": "copied-once"}}
    path = f"/runs/{original['id']}/again"
    copy = api.call("POST", path, **once).json()
    api.finished(copy)
    assert api.call("DELETE", f"/trainings/{original['id']}").status_code == 204
    repeated = api.call("POST", path, **once)
    assert repeated.status_code == 202
    assert repeated.json()["id"] == copy["id"]
    refused(api.call("POST", path), 404, original["id"])
