"""Each problem has a type that clients can branch on, with a page that describes it."""

import asyncio
import json

import pytest
from starlette.requests import Request

from app.api.problem_types import FOLDER, TYPES
from app.api.problems import hexapod_error, problem
from app.storage.errors import Busy, Conflict, Damaged, NotFound, StorageFailed
from hexapods.domain.errors import (
    DamagedFile,
    HexapodError,
    ImpossibleLegs,
    InvalidInput,
    OtherFormat,
    TableMismatch,
    UnknownName,
    Unreachable,
)
from tests.api.calls import WALK, Api


@pytest.mark.parametrize(
    ("error", "name"),
    [
        (InvalidInput("choose another"), "invalid-input"),
        (UnknownName("gait", "hop", ["trot"]), "unknown-name"),
        (ImpossibleLegs("too close", [1, 2]), "impossible-legs"),
        (Unreachable("too far", [1]), "impossible-legs"),
        (TableMismatch("another grid"), "table-mismatch"),
        (DamagedFile("cut off"), "damaged-file"),
        (OtherFormat("of next year"), "damaged-file"),
        (NotFound("there is none"), "not-found"),
        (Conflict("it runs", "running"), "conflict"),
        (Damaged("r1", "no JSON"), "damaged-run"),
        (Busy("wait", 7), "too-many-requests"),
        (StorageFailed("the database is held"), "unavailable"),
        (HexapodError("killed"), "server-error"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_an_error_has_its_type(error: HexapodError, name: str) -> None:
    request = Request({"type": "http", "method": "GET", "path": "/", "headers": []})
    answer = asyncio.run(hexapod_error(request, error))
    document = json.loads(bytes(answer.body))
    assert document["type"] == f"{FOLDER}{name}"
    assert document["title"] == TYPES[name].title
    assert document["status"] == answer.status_code == TYPES[name].status


@pytest.mark.parametrize("status", sorted({kind.status for kind in TYPES.values()}))
def test_each_status_has_a_type(status: int) -> None:
    document = json.loads(bytes(problem(status, "why").body))
    assert TYPES[document["type"].removeprefix(FOLDER)].status == status


def test_the_type_is_the_path_of_a_page(api: Api) -> None:
    answer = api.client.get("/api/v1/races/none")
    page = api.client.get(answer.json()["type"])
    assert page.status_code == 200
    assert TYPES["not-found"].remedy in page.text
    everything = api.client.get("/problems").text
    assert all(f'id="{name}"' in everything for name in TYPES)
    unknown = api.client.get("/problems/none")
    assert unknown.status_code == 404
    assert "invalid-input" in unknown.json()["detail"]


def test_all_wrong_fields_are_answered_at_once(api: Api) -> None:
    wrong = {"steps": 0, "observation": "x", "divisions": 99, "gait": "hop", "robot": "none"}
    document = api.client.post("/api/v1/trainings", json={**WALK, **wrong}).json()
    assert document["type"] == "/problems/invalid-input"
    assert {entry["field"] for entry in document["errors"]} == {*wrong}
    assert "choose one of: left-right-origin" in str(document["errors"])


def test_of_a_single_name_that_is_unknown_the_type_says_so(api: Api) -> None:
    document = api.client.post("/api/v1/trainings", json={**WALK, "gait": "hop"}).json()
    assert document["type"] == "/problems/unknown-name"
    assert "errors" not in document
