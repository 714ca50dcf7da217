"""Promise 10: a retried start is one run: the same `Idempotency-Key` 100 times."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from app.runs import tables
from tests.api.calls import WALK, Api, refused

TIMES = 100
RACE = {**WALK, "steps": 5, "lanes": [{"agent": "greedy"}]}


def start(api: Api, path: str, key: str, **request: Any) -> tuple[int, str, str]:
    answer = api.call("POST", path, headers={"Idempotency-Key": key}, **request)
    return answer.status_code, answer.headers["location"], answer.text


def runs(api: Api, kind: str, name: str) -> list[str]:
    return [run["id"] for run in api.get(f"/{kind}s?limit=100")["items"] if run["name"] == name]


@pytest.mark.parametrize("together", [False, True], ids=["in turn", "at once"])
@pytest.mark.parametrize(("kind", "body"), [("training", {**WALK, "steps": 20}), ("race", RACE)])
def test_a_hundred_times_the_same_key_is_one_run(
    api: Api, kind: str, body: dict[str, Any], together: bool
) -> None:
    name = f"once, {kind}, {together}"
    request: dict[str, Any] = {
        "path": f"/{kind}s",
        "key": name.replace(" ", "-"),
        "json": {**body, "name": name},
    }
    with ThreadPoolExecutor(20 if together else 1) as pool:
        answers = [
            one.result() for one in [pool.submit(start, api, **request) for _ in range(TIMES)]
        ]

    assert len(set(answers)) == 1
    assert answers[0][0] == 202
    [run_id] = runs(api, kind, name)
    assert answers[0][1].endswith(run_id)


def test_an_import_too(api: Api, trained: dict[str, Any]) -> None:
    table = api.call("GET", f"/trainings/{trained['id']}/q-table?format=npz").content
    assert tables.from_bytes(table, "the table").meta["step"] == trained["progress"]["done"]
    path = "/trainings/import?name=imported-once"
    answers = {start(api, path, "import", content=table) for _ in range(10)}

    assert len(answers) == 1
    assert len(runs(api, "training", "imported-once")) == 1


def test_another_request_with_the_key_is_refused_and_starts_nothing(api: Api) -> None:
    body = {**WALK, "steps": 20, "name": "first with the key"}
    start(api, "/trainings", "key", json=body)
    headers = {"Idempotency-Key": "key"}
    for other in ({**body, "steps": 21}, {**body, "name": "other"}):
        refused(api.call("POST", "/trainings", json=other, headers=headers), 422, "new key")
    refused(api.call("POST", "/races", json=RACE, headers=headers), 422, "new key")
    assert len(runs(api, "training", "first with the key")) == 1
    assert not runs(api, "training", "other")


def test_what_was_refused_for_now_can_be_tried_again(api: Api) -> None:
    headers = {"Idempotency-Key": "again"}
    body = {**WALK, "continue_from": "nobody"}
    for _ in range(2):
        refused(api.call("POST", "/trainings", json=body, headers=headers), 422, "nobody")
