"""Robots from files over REST: stored, corrected, trained, raced and taken to another server."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from app.settings import Settings
from hexapods.domain import robot_documents
from tests.api.calls import Api, refused
from tests.api.conftest import running
from tests.features.needing import needs
from tests.imports.robots import HOME, bug, dog, zipped

SPOT = dog(keyframes={"home": HOME})
"""It stands as its file says: to search for a stance takes most of the time of an import."""
QUOTA_MB = 10
SHORT = {"steps": 3, "evaluate_every": 0, "gait": "trot"}


def send(api: Api, data: str | bytes, name: str = "Spot", file: str = "spot.xml") -> Any:
    return api.call("POST", "/robots", params={"name": name, "file": file}, content=data)


def used(api: Api, robot_id: str) -> list[dict[str, Any]]:
    runs: list[dict[str, Any]] = api.get("/runs?limit=100")["items"]
    return [run for run in runs if robot_id in str(run["config"])]


@pytest.fixture
def spot(api: Api) -> Iterator[dict[str, Any]]:
    answer = send(api, SPOT)
    assert answer.status_code == 201, answer.text
    yield answer.json()
    for stored in api.get("/robots?hidden=true")["items"]:
        for run in used(api, stored["id"]):
            api.call("DELETE", f"/{run['kind']}s/{run['id']}")
        assert api.call("DELETE", f"/robots/{stored['id']}").status_code == 200


def test_a_file_is_stored_with_what_was_guessed(api: Api, spot: dict[str, Any]) -> None:
    assert (spot["name"], spot["file"]) == ("Spot", "spot.xml")
    assert [leg["joints"] for leg in spot["legs"]] == [["hip", "thigh", "calf"]] * 4
    assert spot["groups"] == [[1, 3], [2, 4]]
    assert spot["guesses"]
    whole = api.get(f"/robots/{spot['id']}")
    assert whole["found"]["feet"]
    assert whole["found"]["file_format"] == "mjcf"
    assert whole["preview"]["largest_side_m"] > 0
    option = next(entry for entry in api.get("/options")["robots"] if entry["id"] == spot["id"])
    assert option["body"] is None
    assert option["grid_side_m"] == pytest.approx(0.06, abs=0.02)
    assert option["joints"][0] == ["hip", "thigh", "calf"]
    again = send(api, SPOT, "Another")
    assert (again.status_code, again.json()) == (200, spot)


def test_it_learns_and_races(api: Api, spot: dict[str, Any]) -> None:
    robot = {"id": spot["id"]}
    run = api.finished(api.start("/trainings", {**SHORT, "robot": robot}))
    assert run["config"]["robot"] == {"id": spot["id"], "name": "Spot"}
    lanes = [{"agent": "greedy"}, {"agent": "q-learning", "training_id": run["id"]}]
    weak = {**robot, "friction": 0.5}
    race = {"gait": "trot", "robot": weak, "lanes": lanes, "steps": 2, "seed": 1}
    raced = api.finished(api.start("/races", race))
    assert raced["config"]["robot"] == {**weak, "name": "Spot"}
    refused(
        api.call("POST", "/races", json={**race, "robot": {**robot, "femur_m": 0.1}}), 422, "femur"
    )


@needs("archives")
def test_it_travels_with_a_run(api: Api, spot: dict[str, Any], serve: Callable[..., Api]) -> None:
    lanes, robot = [{"agent": "greedy"}], {"id": spot["id"]}
    race = {"gait": "trot", "robot": robot, "lanes": lanes, "steps": 2}
    raced = api.finished(api.start("/races", race))
    data = api.call("GET", f"/races/{raced['id']}/export").content
    other = serve()
    answer = other.call("POST", "/import", content=data)
    assert answer.status_code == 201, answer.text
    (stored,) = other.get("/robots")["items"]
    assert (stored["id"], stored["name"], stored["guesses"]) == (spot["id"], "Spot", [])


def test_it_is_corrected_and_has_another_id(api: Api, spot: dict[str, Any]) -> None:
    path = f"/robots/{spot['id']}"
    answer = api.call("PATCH", path, json={"choices": {"forward": "-x", "servo_torque_nm": 12}})
    assert answer.status_code == 200, answer.text
    changed = answer.json()
    assert (changed["name"], changed["choices"]["forward"]) == ("Spot", "-x")
    assert changed["id"] != spot["id"]
    assert [entry["id"] for entry in api.get("/robots?hidden=true")["items"]] == [changed["id"]]
    assert api.get(f"/robots/{changed['id']}")["robot"]["servo_torque_nm"] == 12
    again = api.call("PATCH", f"/robots/{changed['id']}", json={"choices": {}, "name": "Rover"})
    assert (again.json()["id"], again.json()["name"]) == (spot["id"], "Rover")
    assert api.call("PATCH", path, json={"choices": {}}).json()["id"] == spot["id"]


def test_a_corrected_robot_that_runs_use_is_hidden_and_not_deleted(
    api: Api, spot: dict[str, Any]
) -> None:
    run = api.finished(api.start("/trainings", {**SHORT, "robot": {"id": spot["id"]}}))
    path = f"/robots/{spot['id']}"
    changed = api.call("PATCH", path, json={"choices": {"servo_kp": 30}}).json()
    before = api.get(path)
    assert (before["name"], before["hidden"]) == ("Spot, earlier", True)
    assert changed["name"] == "Spot"
    assert api.look(run)["config"]["robot"]["id"] == spot["id"]


def test_a_wrong_choice_changes_nothing(api: Api, spot: dict[str, Any]) -> None:
    path = f"/robots/{spot['id']}"
    choices: list[dict[str, Any]] = [
        {"feet": ["no", "such", "foot"]},
        {"forward": "up"},
        {"servo_kp": -1},
        {"wings": 2},
    ]
    for choice in choices:
        assert api.call("PATCH", path, json={"choices": choice}).status_code == 422
    assert api.get("/robots")["items"] == [spot]
    body = api.call("POST", "/robots", json={"robot": {"preset": "ant", "femur_m": 0.07}}).json()
    path = f"/robots/{body['id']}"
    refused(api.call("PATCH", path, json={"choices": {"servo_kp": 30}}), 422, "from no file")


@pytest.mark.parametrize(
    ("content", "word"),
    [
        ("<mujoco/>", "leg"),
        ("<robot name='x'><link name='a'/></robot>", "leg"),
        ("<html>", ""),
        (zipped({"readme.txt": "nothing"}), ""),
        (dog(sections='<include file="/etc/passwd"/>'), "include"),
        (b"PK\3\4 no zip", ""),
    ],
)
def test_a_file_without_a_robot_is_refused_and_nothing_is_stored(
    api: Api, content: str | bytes, word: str
) -> None:
    refused(send(api, content, "Bad", "bad.xml"), 422, word)
    assert api.get("/robots?hidden=true")["items"] == []


def test_urdf_in_a_zip_gets_the_name_of_the_file(api: Api) -> None:
    data = zipped({"robots/bug.urdf": bug()})
    answer = api.call("POST", "/robots?file=bug.zip", content=data)
    assert answer.status_code == 201, answer.text
    stored = answer.json()
    assert len(stored["legs"]) == 6
    document = api.call("GET", f"/robots/{stored['id']}/file").content
    assert robot_documents.id_of(document) == stored["id"]
    assert api.call("DELETE", f"/robots/{stored['id']}").status_code == 200
    again = api.call("POST", "/robots?name=Bug", content=document)
    assert (again.status_code, again.json()["id"]) == (201, stored["id"])
    api.call("DELETE", f"/robots/{stored['id']}")


def test_on_a_full_disk_a_file_is_not_read_again(tmp_path: Path) -> None:
    with running(Settings(data=tmp_path, quota_mb=QUOTA_MB)) as api:
        robot_id = send(api, SPOT).json()["id"]
        (tmp_path / "filler").write_bytes(bytes(QUOTA_MB * 1_000_000))
        choices = {"choices": {"home_rad": {"no joint": 1.0}}}
        refused(api.call("PATCH", f"/robots/{robot_id}", json=choices), 507, "data folder")
