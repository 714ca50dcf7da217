"""Promise 10: a retried start is one run: the same `Idempotency-Key` 100 times.

Also across restarts and `kill -9` at random moments of the start: here 2 kills, 50 by `make soak`.
"""

import random
import signal
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx2
import pytest

from hexapods.runs import tables
from tests.api.calls import WALK, Api, refused
from tests.promises.length import at_length
from tests.served import BODY, Served

TIMES = 100
RACE = {**WALK, "steps": 5, "lanes": [{"agent": "greedy"}]}


def start(api: Api, path: str, key: str, **request: Any) -> tuple[int, str]:
    answer = api.call("POST", path, headers={"Idempotency-Key": key}, **request)
    assert answer.headers["location"].endswith(answer.json()["id"])
    return answer.status_code, answer.headers["location"]


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
            future.result() for future in [pool.submit(start, api, **request) for _ in range(TIMES)]
        ]

    assert len(set(answers)) == 1
    assert answers[0][0] == 202
    [run_id] = runs(api, kind, name)
    assert answers[0][1].endswith(run_id)


def test_a_retried_import_is_one_run(api: Api, trained: dict[str, Any]) -> None:
    table = api.call("GET", f"/trainings/{trained['id']}/q-table?format=npz").content
    assert tables.from_bytes(table, "the table").meta["step"] == trained["progress"]["done"]
    path = "/trainings/import?name=imported-once"
    answers = {start(api, path, "import", content=table) for _ in range(10)}

    assert len(answers) == 1
    assert len(runs(api, "training", "imported-once")) == 1


def test_another_request_with_the_same_key_is_refused(api: Api) -> None:
    body = {**WALK, "steps": 20, "name": "first with the key"}
    start(api, "/trainings", "key", json=body)
    headers = {"Idempotency-Key": "key"}
    for other in ({**body, "steps": 21}, {**body, "name": "other"}):
        refused(api.call("POST", "/trainings", json=other, headers=headers), 422, "new key")
    refused(api.call("POST", "/races", json=RACE, headers=headers), 422, "new key")
    assert len(runs(api, "training", "first with the key")) == 1
    assert not runs(api, "training", "other")


def test_a_refused_request_can_be_retried_with_its_key(api: Api) -> None:
    headers = {"Idempotency-Key": "again"}
    body = {**WALK, "continue_from": "nobody"}
    for _ in range(2):
        refused(api.call("POST", "/trainings", json=body, headers=headers), 422, "nobody")


def test_a_key_whose_run_was_deleted_is_gone(api: Api) -> None:
    body = {**WALK, "steps": 5, "name": "deleted"}
    headers = {"Idempotency-Key": "of one that is gone"[:19].replace(" ", "-")}
    run = api.call("POST", "/trainings", json=body, headers=headers).json()
    api.finished(run)
    assert api.call("DELETE", f"/trainings/{run['id']}").status_code == 204
    answer = api.call("POST", "/trainings", json=body, headers=headers)
    refused(answer, 410, run["id"], "was deleted", "new key")
    assert not runs(api, "training", "deleted")


KILLS = at_length(2, 50)


@pytest.mark.timeout(60 + 30 * KILLS)
def test_a_key_survives_the_death_of_the_server(launch: Callable[..., Served]) -> None:
    chance = random.Random(10)
    server = launch()
    for number in range(KILLS):
        bodies = {
            "/trainings": {**BODY, "steps": 5, "name": f"training {number}"},
            "/races": {**BODY, "steps": 5, "name": f"race {number}"},
        }
        acknowledged: list[str] = []
        starter = threading.Thread(target=start_all, args=(server, number, bodies, acknowledged))
        starter.start()
        time.sleep(chance.uniform(0, 0.3))
        server.process.send_signal(signal.SIGKILL)
        starter.join()
        server.end(signal.SIGKILL)
        server = launch()
        again: list[str] = []
        start_all(server, number, bodies, again)
        assert again[: len(acknowledged)] == acknowledged, (
            "an acknowledged start must be returned again"
        )
        for path, body in bodies.items():
            shown = server.client.get(f"/api/v1{path}").json()["items"]
            names = [run["name"] for run in shown if "damaged" not in run]
            assert names.count(body["name"]) == 1
        trainings = number_of(server, "trainings")
        assert trainings == 2 * (number + 1), "a race starts its one training"
    assert len({*again, *acknowledged}) >= 2


def number_of(server: Served, kind: str) -> int:
    """Count the runs of a kind, page by page."""
    count, query = 0, ""
    while True:
        page = server.client.get(f"/api/v1/{kind}{query}").json()
        count += len(page["items"])
        if page["next_cursor"] is None:
            return count
        query = f"?cursor={page['next_cursor']}"


def start_all(
    server: Served, number: int, bodies: dict[str, dict[str, Any]], acknowledged: list[str]
) -> None:
    """Start each run with its own key; append the ids that the server acknowledged."""
    for path, body in bodies.items():
        headers = {"Idempotency-Key": f"{number}{path}"}
        try:
            with httpx2.Client(base_url=server.address, timeout=60, trust_env=False) as client:
                answer = client.post(f"/api/v1{path}", json=body, headers=headers)
        except httpx2.TransportError:
            return
        assert answer.status_code == 202, answer.text
        acknowledged.append(answer.json()["id"])
