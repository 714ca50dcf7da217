"""Stored robots over REST: stored, chosen, renamed, hidden, deleted and taken elsewhere."""

import contextlib
import io
import json
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter

from app.api.memory_limit import MAX_FILE_BYTES
from app.api.options import options_view
from app.features.robots.response_models import StoredRobotsView, StoredRobotView, WholeRobotView
from app.installed_features import load
from hexapods.domain.robot import PLACED_RANGES, RANGES, robot
from tests.api.calls import WALK, Api, refused
from tests.features.needing import needs

BODY = {"preset": "dog", "femur_m": 0.0912}
TOKEN = "0123456789abcdef0123"


def store(api: Api, name: str | None = None, **body: Any) -> Any:
    query = {} if name is None else {"name": name}
    return api.call("POST", "/robots", params=query, json={"robot": BODY, **body})


@pytest.fixture
def rex(api: Api) -> Iterator[dict[str, Any]]:
    answer = store(api, "Rex")
    assert answer.status_code == 201, answer.text
    stored: dict[str, Any] = answer.json()
    assert answer.headers["location"] == f"/api/v1/robots/{stored['id']}"
    yield stored
    api.call("DELETE", f"/robots/{stored['id']}")


def test_a_stored_robot_has_its_legs_its_groups_and_its_gait(api: Api, rex: dict[str, Any]) -> None:
    assert (rex["name"], rex["hidden"], rex["gait"]) == ("Rex", False, "trot")
    assert rex["groups"] == [[1, 3], [2, 4]]
    assert [leg["joints"] for leg in rex["legs"]] == [["coxa", "femur", "tibia"]] * 4
    assert (rex["guesses"], rex["repairs"], rex["file"]) == ([], [], None)
    assert api.get("/robots")["items"] == [rex]
    whole = api.get(f"/robots/{rex['id']}")
    assert whole["robot"]["femur_m"] == 0.0912
    assert whole["preview"]["tips"] is False
    assert robot(whole["robot"]).feet_out_m == robot(BODY).feet_out_m


def test_answers_match_their_models(api: Api, rex: dict[str, Any]) -> None:
    answers: dict[type, Any] = {
        StoredRobotView: rex,
        WholeRobotView: api.get(f"/robots/{rex['id']}"),
        StoredRobotsView: api.get("/robots"),
        options_view(load().classes): api.get("/options"),
    }
    for model, answer in answers.items():
        TypeAdapter(model).validate_python(answer)


def test_the_same_content_is_stored_once(api: Api, rex: dict[str, Any]) -> None:
    again = store(api, "Another name")
    assert (again.status_code, again.json()) == (200, rex)
    document = api.call("GET", f"/robots/{rex['id']}/file")
    assert "attachment" in document.headers["content-disposition"]
    again = api.call("POST", "/robots", content=document.content)
    assert (again.status_code, again.json()["id"]) == (200, rex["id"])


@pytest.mark.parametrize("file_format", ["xml", "urdf", "zip"])
def test_a_robot_is_downloaded_for_other_programs_and_taken_in_again(
    api: Api, rex: dict[str, Any], file_format: str, serve: Callable[..., Api]
) -> None:
    file = api.call("GET", f"/robots/{rex['id']}/file?format={file_format}")
    assert file.status_code == 200
    assert f"robot-{rex['id']}.{file_format}" in file.headers["content-disposition"]
    query = f"name=Again&file=rex.{file_format}"
    again = serve().call("POST", f"/robots?{query}", content=file.content)
    assert (again.status_code, again.json()["gait"]) == (201, rex["gait"])
    refused(api.call("GET", f"/robots/{rex['id']}/file?format=sdf"), 422, "urdf")


def test_a_document_is_stored_elsewhere_with_the_same_id(
    api: Api, rex: dict[str, Any], serve: Callable[..., Api]
) -> None:
    document = api.call("GET", f"/robots/{rex['id']}/file").content
    other = serve()
    answer = other.call("POST", "/robots?name=Rex", content=document)
    assert (answer.status_code, answer.json()["id"]) == (201, rex["id"])
    changed = document.replace(b"0.0912", b"0.0913 ")
    refused(other.call("POST", "/robots", content=changed), 422, "damaged")


def test_it_is_chosen_by_its_id_alone_or_changed(api: Api, rex: dict[str, Any]) -> None:
    walk = {**WALK, "gait": "trot"}
    run = api.finished(api.train(**{**walk, "robot": {"id": rex["id"]}}))
    assert run["config"]["robot"] == {"id": rex["id"], "name": "Rex"}
    changed = {"id": rex["id"], "friction": 0.5}
    race = api.race(
        **walk, robot=changed, lanes=[{"agent": "greedy"}, *_trained(run)], steps=4, seed=1
    )
    race = api.finished(race)
    assert race["config"]["robot"] == {**changed, "name": "Rex"}
    assert race["result"]["lanes"][1]["trained_robot"] == {"id": rex["id"], "name": "Rex"}
    same = api.finished(
        api.race(**walk, robot={"id": rex["id"]}, lanes=_trained(run), steps=4, seed=1)
    )
    assert same["result"]["lanes"][0]["trained_robot"] is None
    answer = api.call("DELETE", f"/robots/{rex['id']}")
    assert refused(answer, 409, "3 runs use Rex", "hide it instead")["state"] == "used"
    for user in (run, race, same):
        api.call("DELETE", f"/{user['kind']}s/{user['id']}")
    assert api.call("DELETE", f"/robots/{rex['id']}").status_code == 200
    refused(api.call("GET", f"/robots/{rex['id']}"), 404, "no robot")
    refused(api.call("POST", "/trainings", json={**walk, "robot": {"id": rex["id"]}}), 422)


def test_one_that_was_deleted_comes_back_for_an_hour(api: Api, rex: dict[str, Any]) -> None:
    robots = api.services.store.robots
    path, version = f"/robots/{rex['id']}", robots.version
    deleted = api.call("DELETE", path).json()
    assert (deleted["deleted"], deleted["kept"]) == ([rex["id"]], [])
    assert datetime.fromisoformat(deleted["restorable_until"]) > datetime.now(UTC)
    for hidden in (path, f"{path}/file"):
        refused(api.call("GET", hidden), 404, "no robot")
    refused(api.call("PATCH", path, json={"hidden": True}), 404, "no robot")
    refused(api.call("DELETE", path), 404, "no robot")
    assert api.get("/robots?hidden=true")["items"] == []
    assert rex["id"] not in [robot["id"] for robot in api.get("/options")["robots"]]

    for _ in range(2):
        restored = api.call("POST", f"{path}/restore")
        assert (restored.status_code, restored.json()) == (200, rex)
    assert api.get("/robots")["items"] == [rex]
    assert robots.version > version + 1
    run = api.finished(api.train(gait="trot", robot={"id": rex["id"]}, steps=1))
    assert run["config"]["robot"] == {"id": rex["id"], "name": "Rex"}
    api.call("DELETE", f"/trainings/{run['id']}")
    refused(api.call("POST", f"/robots/{'0' * 16}/restore"), 404, "can be restored for 1 h")


def test_what_stands_in_the_way_of_an_undo_is_told(
    api: Api, rex: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = f"/robots/{rex['id']}"
    api.call("DELETE", path)
    other = api.call("POST", "/robots", json={"name": "rex", "robot": {"preset": "dog"}}).json()
    advice = "give that one another name, and restore this one again"
    refused(api.call("POST", f"{path}/restore"), 409, "named 'Rex' by now", advice)
    api.call("PATCH", f"/robots/{other['id']}", json={"name": "Max"})
    assert api.call("POST", f"{path}/restore").json() == rex
    api.call("DELETE", f"/robots/{other['id']}")
    api.call("DELETE", path)
    deletions = api.services.store.deletions
    monkeypatch.setattr(deletions, "now", lambda: datetime.now(UTC) + timedelta(hours=2))
    refused(api.call("POST", f"{path}/restore"), 404, "can be restored for 1 h")


def _trained(run: dict[str, Any]) -> list[dict[str, Any]]:
    return [{"agent": "q-learning", "training_id": run["id"]}]


def test_an_unknown_id_is_refused_with_what_to_do(api: Api, rex: dict[str, Any]) -> None:
    body = {**WALK, "gait": "trot", "robot": {"id": "0" * 16, "name": "Fido"}}
    problem = refused(api.call("POST", "/trainings", json=body), 422)["detail"]
    assert "(Fido); import its document" in problem
    assert f"Rex ({rex['id']})" in problem


def test_it_is_renamed_hidden_and_given_another_gait(api: Api, rex: dict[str, Any]) -> None:
    path = f"/robots/{rex['id']}"
    gait = {"right_leg": 1, "left_leg": 2, "groups": [[1, 3], [2], [4]]}
    changed = api.call("PATCH", path, json={"name": "Max", "hidden": True, "gait": gait}).json()
    assert (changed["id"], changed["name"], changed["hidden"]) == (rex["id"], "Max", True)
    assert changed["groups"] == [[1, 3], [2], [4]]
    assert api.get("/robots")["items"] == []
    assert api.get("/robots?hidden=true")["items"] == [changed]
    option = next(entry for entry in api.get("/options")["robots"] if entry["id"] == rex["id"])
    assert (option["title"], option["hidden"], option["gait"]) == ("Max", True, changed["gait"])
    assert store(api).json()["hidden"] is False
    refused(api.call("PATCH", path, json={"name": "stiff"}), 409, "choose another name")
    refused(api.call("PATCH", path, json={"name": ""}), 422, "visible character")
    refused(api.call("PATCH", path, json={"gait": "tripod"}), 422, "six legs")
    refused(api.call("PATCH", path, json={}), 422, "Give one of")
    refused(api.call("PATCH", f"/robots/{'0' * 16}", json={"hidden": True}), 404)


def test_options_list_stored_robots_beside_those_that_are_built_in(
    api: Api, rex: dict[str, Any]
) -> None:
    options = api.get("/options")["robots"]
    assert {entry["id"] for entry in options[:-1]} == {None}
    option = options[-1]
    assert (option["id"], option["name"], option["title"]) == (rex["id"], rex["id"], "Rex")
    assert option["robot"] == {"id": rex["id"], "name": "Rex"}
    assert len(option["azimuths_deg"]) == 4
    assert option["joints"] == [["coxa", "femur", "tibia"]] * 4
    assert "trot" in option["gaits"]


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "empty"),
        (b"{", "JSON"),
        (b"[]", "JSON object"),
        (b"[" * 100_000, "JSON"),
        (b"{}", "no robot"),
        (b'{"robot": "dog", "wings": 2}', "'wings'"),
        (b'{"robot": "cat"}', "cat"),
        (b'{"robot": {"femur_m": 9}}', "femur_m must be from"),
        (b'{"robot": "dog", "gait": "tripod"}', "six"),
        (b'{"robot": "dog", "name": ""}', "visible character"),
        (b'{"robot": "dog", "name": 5}', "visible character"),
        (b'{"robot": {"preset": "dog", "femur_m": 0.01, "tibia_m": 0.01}}', "leg 1"),
        (b'{"format": "hexapods-robot-1", "robot": {}}', "canonical"),
        (b'{"format":"hexapods-robot-1","robot":{}}', "legs"),
        (b'{"format":"hexapods-robot-2","robot":{}}', "has format 'hexapods-robot-2'"),
    ],
)
def test_an_invalid_robot_is_refused_and_nothing_is_stored(
    api: Api, content: bytes, word: str
) -> None:
    refused(api.call("POST", "/robots", content=content), 422, word)
    assert api.get("/robots?hidden=true")["items"] == []


def test_a_body_that_does_not_stand_is_refused(api: Api) -> None:
    places = [(0.1, 0.1), (0.1, 0.2), (0.1, 0.3)]
    legs = [{"x_m": x, "y_m": y, "yaw_deg": 0, "foot_out_m": 0.12} for x, y in places]
    answer = api.call("POST", "/robots", json={"robot": {"legs": legs}, "gait": "one-by-one"})
    refused(answer, 422, "centre of mass")


def test_a_name_is_taken_once_and_made_up_if_none_is_given(api: Api, rex: dict[str, Any]) -> None:
    other = {**BODY, "femur_m": 0.0931}
    refused(store(api, "REX", robot=other), 409, "named 'REX' already")
    first = store(api, robot=other).json()
    second = store(api, robot={**BODY, "femur_m": 0.0932}).json()
    assert (first["name"], second["name"]) == ("Robot", "Robot 2")
    for stored in (first, second):
        assert api.call("DELETE", f"/robots/{stored['id']}").status_code == 200


def test_a_file_that_is_too_large_is_refused(api: Api) -> None:
    answer = api.call("POST", "/robots", content=b" " * (MAX_FILE_BYTES + 1))
    refused(answer, 413, f"{MAX_FILE_BYTES:,} bytes")
    refused(
        api.call("POST", "/robots", content=b"{" + b" " * (9 << 20)), 422, "at most 8,388,608 bytes"
    )


def test_fields_of_the_editor_have_the_limits_of_requests(api: Api) -> None:
    options = api.call("GET", "/options").json()

    assert options["limits"]["legs"] == [3, 12]
    for name, field in options["leg_fields"].items():
        assert (field["minimum"], field["maximum"]) == PLACED_RANGES[name]
        assert field["minimum"] <= field["default"] <= field["maximum"]
    for name, field in options["torso_fields"].items():
        assert (field["minimum"], field["maximum"]) == RANGES[name]
        assert field["minimum"] <= field["default"] <= field["maximum"]


def test_spectators_read_and_do_not_write(serve: Callable[..., Api]) -> None:
    api = serve(token=TOKEN, spectators="public")
    operator = {"headers": {"Authorization": f"Bearer {TOKEN}"}}
    body = json.dumps({"robot": BODY})
    refused(api.call("POST", "/robots", content=body), 401)
    stored = api.call("POST", "/robots", content=body, **operator).json()
    path = f"/robots/{stored['id']}"
    assert api.get("/robots")["items"] == [stored]
    assert api.get(path)["id"] == stored["id"]
    assert api.call("GET", f"{path}/file").status_code == 200
    refused(api.call("PATCH", path, json={"hidden": True}), 401)
    refused(api.call("DELETE", path), 401)
    assert api.call("DELETE", path, **operator).status_code == 200


@needs("archives")
def test_the_archive_of_a_run_brings_its_robot_to_another_server(
    api: Api, rex: dict[str, Any], serve: Callable[..., Api]
) -> None:
    run = api.finished(api.train(gait="trot", robot={"id": rex["id"]}))
    data = api.call("GET", f"/trainings/{run['id']}/export").content
    other = serve()
    answer = other.call("POST", "/import", content=data)
    assert answer.status_code == 201, answer.text
    assert [entry["id"] for entry in other.get("/robots")["items"]] == [rex["id"]]
    api.call("DELETE", f"/trainings/{run['id']}")


def test_the_code_of_a_run_makes_its_robot_known_first(
    api: Api, rex: dict[str, Any], tmp_path: Path
) -> None:
    run = api.finished(api.train(gait="trot", robot={"id": rex["id"]}))
    code, file = api.get(f"/runs/{run['id']}/code"), f"robot-{rex['id']}.json"
    download, stored, trained = code["command"].replace("\\\n", "").splitlines()
    assert download.startswith(f"curl --fail --output {file} ")
    assert stored == f"hexapods robots import {file} --name Rex"
    assert rex["id"] in trained
    (tmp_path / file).write_bytes(api.call("GET", f"/robots/{rex['id']}/file").content)
    output = io.StringIO()
    with contextlib.chdir(tmp_path), contextlib.redirect_stdout(output):
        exec(compile(code["python"], "the program", "exec"), {"__name__": "__main__"})
    assert run["result"]["q_table_sha256"] in output.getvalue()
    api.call("DELETE", f"/trainings/{run['id']}")
