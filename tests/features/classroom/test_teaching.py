"""A class that teaches a robot over REST: presses, what is refused, and what it has learned."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from app.features.classroom.lesson import read_lesson
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.jobs.jobs import MAX_CHANGES
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from hexapods.domain.errors import InvalidInput
from tests.api.calls import ADDRESS, Api, refused
from tests.features.classroom.school import TOKEN, Class
from tests.features.classroom.teachers import moments_of

FORM = {"gait": "tripod", "simulator": "kinematic"}
LESSON: dict[str, Any] = {
    "title": "Teach",
    "cards": [
        {
            "title": "Teach it",
            "text": "Press.",
            "state": {"form": FORM},
            "teach": {"seconds": 24, "step_s": 0.4},
        },
        {"title": "Look", "text": "Only look."},
    ],
}


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Class]:
    with serving(tmp_path_factory.mktemp("teaching")) as school:
        yield school


@contextmanager
def serving(data: Path) -> Iterator[Class]:
    """Serve a class from a folder."""
    settings = Settings(data=data, job_niceness=0, token=TOKEN)
    with ExitStack() as stack:
        store = stack.enter_context(open_store(settings))
        client = TestClient(create_app(settings, store), base_url=ADDRESS, follow_redirects=False)
        yield Class(stack.enter_context(client), stack)


def begun(school: Class, code: str) -> str:
    """Let the class teach; return the id of the training of its robot, which is on the stage."""
    answer = school.teacher.call("POST", f"/rooms/{code}/teaching")
    assert answer.status_code == 202, answer.text
    run_id: str = answer.json()["taught"]["run_id"]
    school.teacher.until(
        {"kind": "training", "id": run_id}, lambda now: now["progress"]["done"] > 2
    )
    return run_id


def pressed(pupil: Api, code: str, run_id: str, at_s: float, value: int = 1) -> Any:
    body = {"run_id": run_id, "at_s": at_s, "value": value}
    return pupil.call("POST", f"/rooms/{code}/presses", json=body)


def test_a_class_that_praises_steps_forward_teaches_a_walk(school: Class) -> None:
    code = school.room(LESSON)
    pupils = [school.joined(code) for _ in range(3)]
    run_id = begun(school, code)
    counted, client = 0, school.teacher.client
    for at_s, reward_m in moments_of(lambda path: client.get(path).json(), code, run_id):
        for pupil in pupils:
            answer = pressed(pupil, code, run_id, at_s, 1 if reward_m > 0.005 else -1)
            counted += answer.status_code == 201
    view = school.teacher.get(f"/rooms/{code}/teaching")
    training = school.finished({"kind": "training", "id": run_id})
    table = {
        (tuple(entry["state"]), tuple(entry["action"])): entry["value"]
        for entry in school.teacher.get(f"/trainings/{run_id}/q-table")["values"]
    }

    assert counted > 60
    assert view["state"] == "ended"
    assert max(press["plus"] + press["minus"] for press in view["presses"]) == 3
    assert sum(len(change["presses"]) for change in training["changes"]) == len(view["presses"])
    assert min(table.values()) < 0 < max(table.values())
    assert training["result"]["distance_m"] > 0.1
    assert view["taught"]["distance_m"] == training["result"]["distance_m"]
    assert view["rival"]["distance_m"] is not None


def test_presses_that_nobody_can_have_meant_are_refused(school: Class) -> None:
    code = school.room(LESSON)
    pupil, other = school.joined(code), school.joined(code)
    refused(pressed(pupil, code, "abc", 0.0), 409, "is taught now; wait")
    refused(pupil.call("POST", f"/rooms/{code}/teaching"), 403)
    run_id = begun(school, code)
    refused(school.teacher.call("POST", f"/rooms/{code}/teaching"), 409, "teaches already")
    refused(pressed(pupil, code, "abc", 0.0), 409, "robot is taught now")
    refused(pressed(pupil, code, run_id, 500.0), 409, "not shown yet")
    refused(pressed(school.pupil(), code, run_id, 0.0), 401)
    for body in (
        {"run_id": run_id, "at_s": -1, "value": 1},
        {"run_id": run_id, "at_s": 1, "value": 0},
        {"run_id": run_id, "at_s": 1, "value": 10},
        {"run_id": run_id, "at_s": 1, "value": 1.0},
        {"run_id": run_id, "at_s": 1, "value": "1"},
        {"run_id": run_id, "value": 1},
    ):
        refused(pupil.call("POST", f"/rooms/{code}/presses", json=body), 422)
    refused(pressed(pupil, code, run_id, 0.0, True), 422, "integer 1 or -1")
    answers = [pressed(pupil, code, run_id, 500.0) for _ in range(12)]
    refused(answers[-1], 429, "press faster")
    # Others of the class press as before.
    assert pressed(other, code, run_id, 500.0).status_code == 409

    assert school.teacher.call("POST", f"/rooms/{code}/freeze").status_code == 200
    refused(pressed(other, code, run_id, 0.5), 409, "stopped the class")
    assert other.get(f"/rooms/{code}/teaching")["state"] == "frozen"
    school.teacher.until({"kind": "training", "id": run_id}, lambda now: now["state"] == "paused")
    school.teacher.call("POST", f"/rooms/{code}/freeze", json={"frozen": False})
    school.teacher.until({"kind": "training", "id": run_id}, lambda now: now["state"] == "running")

    other.call("DELETE", f"/rooms/{code}/me")
    refused(pressed(other, code, run_id, 0.5), 401)
    school.show(code, 1)
    refused(pressed(pupil, code, run_id, 0.5), 403, "ard 1 teaches nothing")
    refused(pupil.call("GET", f"/rooms/{code}/teaching"), 404, "ard 1 teaches nothing")
    ended = school.teacher.look({"kind": "training", "id": run_id})
    assert ended["state"] in ("running", "stopped")
    refused(school.teacher.call("POST", f"/rooms/{code}/teaching"), 403, "teaches nothing")


def test_both_robots_race_at_the_reveal_and_distances_are_told_then(school: Class) -> None:
    code = school.room(LESSON)
    pupil = school.joined(code)
    assert pupil.get(f"/rooms/{code}/teaching")["state"] == "ready"
    run_id = begun(school, code)
    school.teacher.call("DELETE", f"/rooms/{code}/teaching")
    school.teacher.until({"kind": "training", "id": run_id}, lambda now: now["state"] == "stopped")
    assert pupil.get(f"/rooms/{code}/teaching")["taught"]["distance_m"] is None
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    revealed = pupil.get(f"/rooms/{code}/teaching")
    while revealed["race_id"] is None:
        revealed = pupil.get(f"/rooms/{code}/teaching")
    race = school.teacher.finished({"kind": "race", "id": revealed["race_id"]})

    assert [lane["training_id"] for lane in race["config"]["lanes"]] == [
        revealed["taught"]["run_id"],
        revealed["rival"]["run_id"],
    ]
    told = pupil.get(f"/rooms/{code}/teaching")
    walked = [lane["total_distance_m"] for lane in race["result"]["lanes"]]
    assert [told[robot]["distance_m"] for robot in ("taught", "rival")] == walked


def test_after_a_restart_a_room_shows_the_robot_that_it_teaches(tmp_path: Path) -> None:
    with serving(tmp_path) as school:
        code = school.room(LESSON)
        run_id = begun(school, code)
    with serving(tmp_path) as school:
        shared = school.services.of(RoomStages).of(code)
        assert shared is not None
        assert shared.stage.state().run_id == run_id
        assert school.teacher.get(f"/rooms/{code}/teaching")["state"] == "teaching"


def test_a_card_that_is_not_there_ends_no_teaching(school: Class) -> None:
    code = school.room(LESSON)
    run_id = begun(school, code)
    refused(school.teacher.call("PUT", f"/rooms/{code}/card", json={"card": 40}), 404, "0 to 1")
    refused(school.teacher.call("POST", f"/rooms/{code}/reveal", json={"card": 40}), 404)
    school.teacher.call("POST", f"/rooms/{code}/reveal", json={"card": 1})

    assert school.teacher.get(f"/rooms/{code}/teaching")["state"] == "teaching"
    assert school.teacher.look({"kind": "training", "id": run_id})["state"] == "running"


def raced(school: Class, code: str) -> dict[str, Any]:
    """Return the teaching of a room once its robots have raced."""
    view: dict[str, Any] = school.teacher.get(f"/rooms/{code}/teaching")
    while view["race_id"] is None:
        view = school.teacher.get(f"/rooms/{code}/teaching")
    return view


def test_a_reveal_that_is_pressed_thrice_at_once_begins_one_race(school: Class) -> None:
    code = school.room(LESSON)
    begun(school, code)
    with ThreadPoolExecutor(3) as threads:
        path = f"/rooms/{code}/reveal"
        answers = [threads.submit(school.teacher.call, "POST", path) for _ in range(3)]
    school.finished({"kind": "race", "id": raced(school, code)["race_id"]})
    races = [
        run.run_id
        for run in school.services.of(Rooms).get(code).runs.values()
        if run.given == {"teach": "race"}
    ]

    assert [answer.result().status_code for answer in answers] == [200] * 3
    assert len(races) == 1


def test_a_class_that_teaches_again_after_the_reveal_sees_that_robot_race(school: Class) -> None:
    code = school.room(LESSON)
    begun(school, code)
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    first = raced(school, code)
    run_id = begun(school, code)
    again = school.teacher.get(f"/rooms/{code}/teaching")
    school.teacher.call("DELETE", f"/rooms/{code}/teaching")
    second = raced(school, code)

    assert again["race_id"] is None
    assert second["race_id"] != first["race_id"]
    assert second["taught"]["run_id"] == run_id


def test_the_robot_of_the_class_is_put_into_the_light_until_it_is_deleted(school: Class) -> None:
    code = school.room(LESSON)
    run_id = begun(school, code)
    school.teacher.call("DELETE", f"/rooms/{code}/teaching")
    body, path = {"run_id": run_id}, f"/rooms/{code}/spotlight"
    lit = school.teacher.call("PUT", path, json=body)
    school.teacher.until({"kind": "training", "id": run_id}, lambda now: now["state"] == "stopped")
    school.teacher.call("DELETE", f"/trainings/{run_id}")

    assert lit.status_code == 200
    refused(school.teacher.call("PUT", path, json=body), 404, "There is no run")


def test_a_room_that_stops_and_goes_on_in_a_hurry_does_not_stay_stopped(school: Class) -> None:
    code = school.room(LESSON)
    run_id = begun(school, code)
    with ThreadPoolExecutor(4) as threads:
        for number in range(12):
            body = {"frozen": number % 2 == 0}
            threads.submit(school.teacher.call, "POST", f"/rooms/{code}/freeze", json=body)
    view = school.teacher.get(f"/rooms/{code}/teaching")
    run = school.teacher.look({"kind": "training", "id": run_id})

    assert (view["state"], run["state"]) in [("teaching", "running"), ("frozen", "paused")]


def test_a_card_that_teaches_can_be_started_when_it_is_stored(school: Class) -> None:
    def lesson(**card: Any) -> dict[str, Any]:
        return {"title": "T", "cards": [{"text": "Press.", "teach": {}, **card}]}

    with pytest.raises(InvalidInput, match="either runs something or teaches"):
        read_lesson(lesson(go="training"))
    with pytest.raises(InvalidInput, match="teach"):
        read_lesson(lesson(teach={"seconds": 5}))
    with pytest.raises(InvalidInput, match=r"cards.0.teach: .* 2,250 steps .* at most 800 seconds"):
        read_lesson(lesson(teach={"seconds": 900, "step_s": 0.4}))
    longest = read_lesson(lesson(teach={"seconds": 800, "step_s": 0.4})).cards[0].teach
    assert longest is not None
    assert longest.steps == MAX_CHANGES
    with pytest.raises(InvalidInput, match=r"field 'pace'.*agent, rival, seconds, step_s"):
        read_lesson(lesson(teach={"pace": 1}))
    answer = school.teacher.call(
        "POST", "/lessons", json=lesson(state={"form": {"robot": "no robot"}})
    )
    refused(answer, 422, "0.state.form")
