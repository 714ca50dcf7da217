"""A robot's file that is looked at, corrected and stored: `POST /robots/readings`."""

import base64
import gzip
import json
import struct
from typing import Any

import pytest
from pydantic import TypeAdapter

from app.features.robots.reading_view import RobotReadingView
from app.features.robots.readings import RobotReadings
from app.storage.errors import NotFound
from hexapods.domain.errors import DamagedFile
from tests.api.calls import Api, refused
from tests.imports.robots import HOME, bug, dog, zipped
from tests.imports.robots_in_parts import in_xacro

SPOT = dog(keyframes={"home": HOME})
TWO_LEGS = dog({"FL": (0.2, 0.1), "FR": (0.2, -0.1)}, keyframes={"home": HOME})


def look(api: Api, data: str | bytes, file: str = "spot.xml") -> Any:
    answer = api.call("POST", "/robots/readings", params={"file": file}, content=data)
    assert answer.status_code == 200, answer.text
    TypeAdapter(RobotReadingView).validate_python(answer.json())
    return answer.json()


def correct(api: Api, reading: Any, **choices: Any) -> Any:
    path = f"/robots/readings/{reading['id']}"
    answer = api.call("POST", path, json={"choices": choices})
    assert answer.status_code == 200, answer.text
    return answer.json()


def nodes(reading: Any) -> set[str]:
    """Return the names of the nodes in the scene of a reading."""
    data = gzip.decompress(base64.b64decode(reading["scene"]))
    (size,) = struct.unpack_from("<I", data)
    (frame,) = json.loads(data[4 : 4 + size])["frames"]
    messages = [message for message in frame["messages"] if isinstance(message, dict)]
    return {message["name"] for message in messages if "name" in message}


def test_a_robot_is_seen_before_it_is_stored(api: Api) -> None:
    reading = look(api, SPOT)
    assert reading["problem"] is None
    robot = reading["robot"]
    assert robot["groups"] == [[1, 3], [2, 4]]
    assert [leg["foot"] for leg in robot["legs"]] == ["FR", "FL", "RL", "RR"]
    assert {note["topic"] for note in reading["notes"]} >= {"forward", "legs", "stance", "groups"}
    assert api.get("/robots")["items"] == []  # nothing is stored


def test_its_picture_has_each_body_and_each_foot_on_the_ground(api: Api) -> None:
    reading = look(api, SPOT)
    drawn = nodes(reading)
    root = "/world/sketch"
    assert {f"{root}/foot/{leg}" for leg in range(4)} <= drawn
    assert {f"{root}/part/{number}" for number in range(len(reading["parts"]))} <= drawn
    names = [part["name"] for part in reading["parts"]]
    assert names[0] == "trunk"
    assert [part["leg"] for part in reading["parts"]].count(1) == 3
    for foot in reading["feet"]:
        assert foot["at_m"][2] == pytest.approx(foot["radius_m"], abs=2e-3)
    # x is to the right, y ahead: leg 1 is the front right one
    assert reading["feet"][0]["at_m"][0] > 0 < reading["feet"][0]["at_m"][1]


def test_forward_is_corrected_and_the_picture_turns(api: Api) -> None:
    reading = look(api, SPOT)
    turned = correct(api, reading, forward="-x")
    assert turned["robot"]["forward_deg"] == 180
    assert turned["choices"]["forward"] == "-x"
    assert not any(note["topic"] == "forward" for note in turned["notes"])
    trunk = reading["parts"][1]["at_m"], turned["parts"][1]["at_m"]
    assert trunk[1][:2] == pytest.approx([-trunk[0][0], -trunk[0][1]], abs=1e-3)


def test_a_file_without_legs_enough_is_drawn_with_what_could_be_feet(api: Api) -> None:
    reading = look(api, TWO_LEGS)
    assert reading["robot"] is None
    assert "found 2 legs" in reading["problem"]
    assert len(reading["feet"]) == 2
    assert {foot["leg"] for foot in reading["feet"]} == {0}
    assert {f"/world/sketch/foot/{number}" for number in range(2)} <= nodes(reading)
    answer = api.call("POST", "/robots", json={"reading": reading["id"]})
    refused(answer, 422, reading["problem"][1:])
    assert api.get("/robots")["items"] == []


def test_feet_that_a_person_clicks_make_a_robot_of_it(api: Api) -> None:
    arm = '<body name="arm" pos="0 0 0.1"><joint name="a" axis="0 1 0"/><geom size="0.02"/></body>'
    reading = look(api, dog(on_torso=arm, keyframes=None))
    feet = [part["foot"] for part in reading["parts"] if part["foot"]]
    legs = [leg["foot"] for leg in reading["robot"]["legs"]]
    assert set(legs) <= set(feet)
    three = correct(api, reading, feet=legs[:3])
    assert len(three["robot"]["legs"]) == 3


def test_what_is_seen_is_what_is_stored(api: Api) -> None:
    reading = look(api, SPOT)
    choices = {"gait": "trot", "servo_torque_nm": 17.0}
    seen = correct(api, reading, **choices)
    body = {"reading": reading["id"], "choices": choices, "name": "Seen"}
    answer = api.call("POST", "/robots", json=body)
    assert answer.status_code == 201, answer.text
    stored = answer.json()
    assert stored["name"] == "Seen"
    assert stored["file"] == "spot.xml"
    assert stored["groups"] == seen["robot"]["groups"]
    assert stored["choices"]["servo_torque_nm"] == 17.0
    assert stored["guesses"] == [n["text"] for n in seen["notes"] if n["kind"] == "guess"]
    again = api.call("POST", f"/robots/{stored['id']}/reading").json()
    assert again["choices"]["servo_torque_nm"] == 17.0
    assert again["robot"]["legs"] == seen["robot"]["legs"]
    assert api.call("DELETE", f"/robots/{stored['id']}").status_code == 200


def test_a_body_is_drawn_in_the_same_way(api: Api) -> None:
    body = {"robot": {"preset": "dog"}, "gait": "trot"}
    answer = api.call("POST", "/robots/readings", json=body)
    assert answer.status_code == 200, answer.text
    reading = answer.json()
    assert (reading["id"], reading["notes"], len(reading["feet"])) == ("", [], 4)
    assert {part["leg"] for part in reading["parts"]} == {0, 1, 2, 3, 4}
    assert {f"/world/sketch/part/{n}" for n in range(len(reading["parts"]))} <= nodes(reading)
    for foot in reading["feet"]:
        assert foot["at_m"][2] == pytest.approx(foot["radius_m"], abs=1e-6)


def test_documents_and_arguments_can_be_chosen(api: Api) -> None:
    document = "repo/urdf/bug.urdf.xacro"
    reading = look(api, zipped({**in_xacro(), "small/dog.xml": SPOT}), "repo.zip")
    assert (reading["document"], reading["documents"]) == (document, [document, "small/dog.xml"])
    assert reading["arguments"] == {"effort": "2.5", "sim": "false"}

    stronger = correct(api, reading, arguments={"effort": "3"})
    other = correct(api, reading, file="small/dog.xml")

    assert stronger["arguments"] == {"effort": "3", "sim": "false"}
    assert (other["document"], len(other["robot"]["legs"])) == ("small/dog.xml", 4)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "body is empty"),
        (b'{"gait": "trot"}', "has no robot"),
        (b"PK\3\4 nonsense", "zip"),
        (b"<robot", "no whole XML document"),
        (b"%PDF-1.7", "is a PDF: give the robot's URDF or MJCF"),
    ],
)
def test_what_is_no_robot_at_all_is_refused(api: Api, content: bytes, expected: str) -> None:
    answer = api.call("POST", "/robots/readings", content=content)
    refused(answer, 422, expected)


@pytest.mark.parametrize(
    ("choices", "named"),
    [
        ({"forward": "z"}, "forward"),
        ({"feet": ["a", "b"]}, "feet"),
        ({"servo_torque_nm": 0}, "servo_torque_nm"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_choices_that_are_not_valid_are_named(api: Api, choices: Any, named: str) -> None:
    reading = look(api, SPOT)
    answer = api.call("POST", f"/robots/readings/{reading['id']}", json={"choices": choices})
    if answer.status_code == 200:  # valid by itself, but not for this file
        assert named in answer.json()["problem"]
        assert answer.json()["robot"] is None
    else:
        assert named in str(refused(answer, 422))


def test_a_reading_that_is_not_here_says_what_to_do(api: Api) -> None:
    for method, path, body in [
        ("POST", "/robots/readings/0123", {"choices": {}}),
        ("POST", "/robots", {"reading": "0123"}),
    ]:
        refused(api.call(method, path, json=body), 404, "send it again")


def test_the_oldest_files_are_forgotten_first() -> None:
    readings = RobotReadings(max_bytes=100)
    first, second = readings.keep(b"a" * 60, "a.xml"), readings.keep(b"b" * 60, "b.xml")
    assert readings.file(second).name == "b.xml"
    with pytest.raises(NotFound, match="send it again"):
        readings.file(first)
    with pytest.raises(DamagedFile):
        readings.read(second)


def test_files_of_other_names_are_other_files() -> None:
    readings = RobotReadings()
    data = zipped({"bug.urdf": bug()})
    assert readings.keep(data, "a.zip") != readings.keep(data, "b.zip")
    assert readings.keep(data, "a.zip") == readings.keep(data, "a.zip")
