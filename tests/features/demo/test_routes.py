"""A demo over REST: what is told to a visitor, within the allowance and beyond it."""

import secrets
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from app.features.demo.access import VISITOR_NAME
from app.features.demo.response_models import AllowanceView, VisitorList
from app.features.demo.settings import DemoSettings
from app.settings import Settings
from hexapods.domain.records import from_json
from tests.api.calls import WALK, Api
from tests.api.conftest import running

TOKEN = "a-token-for-tests"
OPERATOR = {"Authorization": f"Bearer {TOKEN}"}
X = {"X-Requested-With": "tests"}
SHORT = {**WALK, "steps": 10}
SLOW = {**WALK, "steps": 900, "pace": 0.05}


@pytest.fixture(scope="module")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("demo")


@pytest.fixture(scope="module")
def demo(demo_folder: Path) -> Iterator[Api]:
    """A demo whose visitors have a thousand steps an hour."""
    is_demo = DemoSettings(demo=True, demo_steps_per_hour=1000)
    settings = Settings(data=demo_folder, job_niceness=0, token=TOKEN, features=(is_demo,))
    with running(settings) as api:
        yield api


@pytest.fixture
def stranger(demo: Api) -> Api:
    """The same server for someone without a cookie."""
    demo.client.cookies.clear()
    return demo


def refused(answer: Any, status: int) -> str:
    assert answer.status_code == status, answer.text
    return str(answer.json()["detail"])


def test_a_stranger_trains_and_has_the_rest_of_the_allowance(stranger: Api) -> None:
    assert stranger.get("/allowance")["steps_left"] == 1000
    assert VISITOR_NAME not in str(stranger.client.cookies)
    run = stranger.finished(stranger.start("/trainings", SHORT))
    left = stranger.get("/allowance")
    from_json(AllowanceView, left)
    # A short start counts as the least.
    assert (left["steps_left"], left["runs"], left["unended"]) == (800, [run["id"]], 0)
    race = stranger.start("/races", {**WALK, "steps": 5, "lanes": [{"agent": "greedy"}]})
    assert stranger.get("/allowance")["runs"] == [run["id"], race["id"]]
    again = stranger.call("POST", f"/runs/{run['id']}/again", headers=X)
    assert stranger.get("/allowance")["runs"][-1] == again.json()["id"]


def test_a_start_beyond_the_allowance_is_refused_with_the_limit_and_the_time(stranger: Api) -> None:
    stranger.finished(stranger.start("/trainings", {**WALK, "steps": 800}))
    answer = stranger.call("POST", "/trainings", json={**WALK, "steps": 500})
    problem = refused(answer, 429)
    assert problem.startswith("You have 200 of 1,000 steps an hour left, and this takes 500;")
    assert "choose fewer, or start it in 60 min." in problem
    assert 3500 < int(answer.headers["retry-after"]) <= 3600
    stranger.start("/trainings", SHORT)


def test_huge_settings_are_refused_by_what_they_cost(stranger: Api) -> None:
    problem = refused(stranger.call("POST", "/trainings", json={**WALK, "steps": 100_000}), 422)
    assert "up to 1,000 steps at once" in problem
    lanes = [{"agent": "q-learning", "training": {"steps": 990}}, {"agent": "greedy"}]
    race = {**WALK, "steps": 50, "lanes": lanes}
    assert "this has 1,090" in refused(stranger.call("POST", "/races", json=race), 422)
    assert stranger.get("/allowance")["runs"] == []


def test_two_at_once_and_one_that_is_stopped_makes_place(stranger: Api) -> None:
    runs = [stranger.start("/trainings", {**SLOW, "steps": 300}) for _ in range(2)]
    problem = refused(stranger.call("POST", "/trainings", json=SHORT), 429)
    assert "2 of your runs wait or go on" in problem
    for run in runs:
        path = f"/trainings/{run['id']}/stop"
        assert stranger.call("POST", path, headers=X).status_code == 202
    stranger.start("/trainings", SHORT)


def test_another_cannot_touch_it_and_an_operator_can(stranger: Api) -> None:
    run = stranger.finished(stranger.start("/trainings", SHORT))
    path = f"/trainings/{run['id']}"
    stranger.client.cookies.clear()
    stranger.start("/trainings", SHORT)
    assert "none of yours" in refused(stranger.call("DELETE", path, headers=X), 403)
    name = {"json": {"name": "Mine"}}
    assert "none of yours" in refused(stranger.call("PATCH", f"/runs/{run['id']}", **name), 403)
    assert stranger.get(path)["name"] == run["name"]
    operator = {**name, "headers": OPERATOR}
    assert stranger.call("PATCH", f"/runs/{run['id']}", **operator).status_code == 200
    assert stranger.call("DELETE", path, headers=OPERATOR).status_code == 204
    assert stranger.call("POST", "/experiments", json={}, headers=OPERATOR).status_code == 422


def test_experiments_are_none_of_a_strangers_also_again(stranger: Api) -> None:
    body = {"experiment": "sweep", "simulator": "kinematic", "seeds": 1, "steps": [5]}
    started = stranger.call("POST", "/experiments", json=body, headers=OPERATOR)
    assert started.status_code == 202, started.text
    run = started.json()
    assert "needs the operator" in refused(stranger.call("POST", "/experiments", json=body), 403)
    again = stranger.call("POST", f"/runs/{run['id']}/again", headers=X)
    assert "experiments need the operator" in refused(again, 403)
    for verb in ("stop", "delete"):
        path = f"/experiments/{run['id']}" + ("/stop" if verb == "stop" else "")
        method = "POST" if verb == "stop" else "DELETE"
        assert stranger.call(method, path, headers=X).status_code == 403


def test_a_repeated_start_is_one_run_and_one_charge(stranger: Api) -> None:
    key = {"Idempotency-Key": "once-and-again"}
    first = stranger.call("POST", "/trainings", json=SHORT, headers=key)
    second = stranger.call("POST", "/trainings", json=SHORT, headers=key)
    assert first.json()["id"] == second.json()["id"]
    assert stranger.get("/allowance")["steps_left"] == 800
    # The key does not make another its owner.
    stranger.client.cookies.clear()
    third = stranger.call("POST", "/trainings", json=SHORT, headers=key)
    assert third.json()["id"] == first.json()["id"]
    assert "set-cookie" not in third.headers
    assert stranger.get("/allowance")["runs"] == []


def lost(api: Api, key: str) -> str:
    """Start a training as a stranger whose answer is lost; return the id of the run."""
    api.client.cookies.clear()
    answer = api.call("POST", "/trainings", json=SHORT, headers={"Idempotency-Key": key})
    assert answer.status_code == 202, answer.text
    api.client.cookies.clear()
    return str(answer.json()["id"])


def test_a_first_start_whose_answer_was_lost_is_of_who_repeats_it(stranger: Api) -> None:
    key = secrets.token_urlsafe(16)
    run_id = lost(stranger, key)
    again = stranger.call("POST", "/trainings", json=SHORT, headers={"Idempotency-Key": key})
    assert again.json()["id"] == run_id
    left = stranger.get("/allowance")
    assert (left["runs"], left["steps_left"]) == ([run_id], 800)
    stranger.finished(again.json())
    assert stranger.call("DELETE", f"/trainings/{run_id}", headers=X).status_code == 204


def test_a_visitor_restores_an_own_run_and_no_other(stranger: Api) -> None:
    run = stranger.finished(stranger.start("/trainings", SHORT))
    path = f"/runs/{run['id']}/restore"
    assert stranger.call("DELETE", f"/trainings/{run['id']}", headers=X).status_code == 204
    cookies = dict(stranger.client.cookies)
    stranger.client.cookies.clear()
    refused(stranger.call("POST", path, headers=X), 403)
    stranger.client.cookies.update(cookies)
    assert stranger.call("POST", path, headers=X).json()["id"] == run["id"]
    assert stranger.get(f"/trainings/{run['id']}")["state"] == "finished"


def test_a_repeated_start_belongs_to_a_client_that_became_a_visitor_meanwhile(
    stranger: Api,
) -> None:
    key = secrets.token_urlsafe(16)
    run_id = lost(stranger, key)
    other = stranger.start("/trainings", SHORT)
    cookie = dict(stranger.client.cookies)
    for _ in range(2):
        again = stranger.call("POST", "/trainings", json=SHORT, headers={"Idempotency-Key": key})
        assert again.json()["id"] == run_id
        assert dict(stranger.client.cookies) == cookie
        left = stranger.get("/allowance")
        assert sorted(left["runs"]) == sorted([run_id, other["id"]])
        assert left["steps_left"] == 600


def test_a_key_that_could_be_guessed_makes_no_one_the_owner(stranger: Api) -> None:
    key = "0123456789abcde"
    run_id = lost(stranger, key)
    again = stranger.call("POST", "/trainings", json=SHORT, headers={"Idempotency-Key": key})
    assert again.json()["id"] == run_id
    assert "set-cookie" not in again.headers
    assert stranger.get("/allowance")["runs"] == []
    assert "none of yours" in refused(
        stranger.call("POST", f"/trainings/{run_id}/stop", headers=X), 403
    )


def test_the_key_of_a_known_visitors_start_is_worth_nothing_to_another(stranger: Api) -> None:
    stranger.start("/trainings", SHORT)
    key = {"Idempotency-Key": secrets.token_urlsafe(16)}
    mine = stranger.call("POST", "/trainings", json=SHORT, headers=key)
    stranger.client.cookies.clear()
    again = stranger.call("POST", "/trainings", json=SHORT, headers=key)
    assert again.json()["id"] == mine.json()["id"]
    assert "set-cookie" not in again.headers
    assert stranger.get("/allowance")["runs"] == []


def test_neither_the_key_of_a_request_nor_of_a_visitor_is_stored(
    stranger: Api, demo_folder: Path
) -> None:
    key = secrets.token_urlsafe(16)
    lost(stranger, key)
    stranger.call("POST", "/trainings", json=SHORT, headers={"Idempotency-Key": key})
    cookie = next(iter(stranger.client.cookies.values()))
    with closing(sqlite3.connect(demo_folder / "hexapods.db")) as connection:
        rows = "\n".join(connection.iterdump())
    assert key not in rows
    assert cookie not in rows


def test_a_forged_cookie_is_a_new_visitor(stranger: Api) -> None:
    stranger.client.cookies.set(f"{VISITOR_NAME}_8000", "x" * 43)
    answer = stranger.call("POST", "/trainings", json=SHORT)
    assert f"{VISITOR_NAME}_8000=" in answer.headers["set-cookie"]
    assert "x" * 43 not in answer.headers["set-cookie"]


def test_operators_list_visitors_and_no_one_else_does(stranger: Api) -> None:
    run = stranger.start("/trainings", SHORT)
    listed = stranger.call("GET", "/visitors", headers=OPERATOR).json()
    from_json(VisitorList, listed)
    assert listed["items"][0]["runs"] == [run["id"]]
    assert "operators alone" in refused(stranger.call("GET", "/visitors"), 403)
    cookie = next(iter(stranger.client.cookies.values()))
    assert cookie not in str(listed)


def test_robots_txt_keeps_crawlers_from_the_api(stranger: Api) -> None:
    answer = stranger.client.get("/robots.txt")
    assert answer.headers["content-type"].startswith("text/plain")
    assert "Disallow: /api/" in answer.text
    assert "Disallow: /\n" not in answer.text


def test_no_demo_has_neither(api: Api) -> None:
    assert "--demo" in refused(api.call("GET", "/allowance"), 404)
    assert "--demo" in refused(api.call("GET", "/visitors"), 404)
    assert "--demo" in refused(api.call("DELETE", "/visitors/x", headers=X), 404)
    assert api.client.get("/robots.txt").text == "User-agent: *\nDisallow: /\n"


def test_the_description_tells_what_a_visitor_may(stranger: Api) -> None:
    paths = stranger.client.get("/openapi.json").json()["paths"]
    assert paths["/api/v1/races"]["post"]["security"][-1] == {}
    assert {"visitor": []} in paths["/api/v1/runs"]["delete"]["security"]
    assert {"visitor": []} not in paths["/api/v1/experiments"]["post"]["security"]
