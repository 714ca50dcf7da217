"""The question before a lesson and after it, and what the class gains."""

import csv
import io
from typing import Any

import pytest

from app.features.classroom.gain import Knowledge, class_gain
from tests.api.calls import Api, refused
from tests.features.classroom.school import Class

QUESTION: dict[str, Any] = {
    "kind": "choice",
    "text": "Who wins?",
    "choices": ["The fast", "The lucky"],
    "right": "The lucky",
}
LESSON: dict[str, Any] = {
    "title": "Luck",
    "minutes": 20,
    "ages": "from 12",
    "before": QUESTION,
    "cards": [{"title": "Only look", "text": "Look."}],
}


def test_the_gain_is_paired_by_participant() -> None:
    known = [
        Knowledge(False, True),
        Knowledge(False, True),
        Knowledge(True, True),
        Knowledge(True, False),
        Knowledge(None, True),
        Knowledge(False, None),
    ]
    gain = class_gain(dict(enumerate(known)))
    assert gain is not None
    assert (gain.pairs, gain.right_before, gain.right_after) == (4, 2, 3)
    assert gain.gain == 0.25
    assert gain.low is not None
    assert gain.high is not None
    assert -1 <= gain.low < 0.25 < gain.high <= 1


def test_two_participants_have_no_interval_and_none_no_gain() -> None:
    gain = class_gain({0: Knowledge(False, True), 1: Knowledge(True, True)})
    assert gain is not None
    assert (gain.gain, gain.low, gain.high) == (0.5, None, None)
    assert class_gain({0: Knowledge(None, True)}) is None


def answer(school: Class, pupils: list[Api], code: str, card: int, values: list[str]) -> None:
    school.show(code, card)
    for pupil, value in zip(pupils, values, strict=True):
        body = {"card": card, "value": value}
        assert pupil.call("POST", f"/rooms/{code}/predictions", json=body).status_code == 201


def test_a_class_is_asked_before_and_after_and_sees_its_gain_at_the_end(school: Class) -> None:
    code = school.room(LESSON)
    pupils = [school.joined(code) for _ in range(4)]
    view = pupils[0].get(f"/rooms/{code}")
    assert (view["cards"], view["knowledge"], view["shown"]["title"]) == (
        3,
        "before",
        "Before the lesson",
    )
    assert view["shown"]["reveal"] is None
    teachers = school.teacher.get(f"/rooms/{code}")["lesson"]
    assert [card["title"] for card in teachers["cards"]] == [
        "Before the lesson",
        "Only look",
        "After the lesson",
    ]
    fast, lucky = QUESTION["choices"]
    answer(school, pupils, code, 0, [fast, fast, fast, lucky])
    refused(school.teacher.call("POST", f"/rooms/{code}/reveal"), 409, "with card 2")
    school.show(code, 1)
    answer(school, pupils, code, 2, [lucky, lucky, fast, lucky])

    def gain(api: Api, query: str = "") -> Any:
        return api.get(f"/rooms/{code}/results?card=2{query}")["gain"]

    assert gain(school.teacher)["gain"] == 0.5
    assert gain(school.teacher, "&projector=true") is None, "the class reads along"
    assert gain(pupils[0]) is None
    assert school.teacher.call("POST", f"/rooms/{code}/reveal").status_code == 200
    of_class = gain(school.teacher, "&projector=true")
    assert of_class == gain(pupils[0])
    assert (of_class["pairs"], of_class["right_before"], of_class["right_after"]) == (4, 1, 3)
    assert of_class["low"] <= 0.5 <= of_class["high"]
    assert school.teacher.get(f"/rooms/{code}")["revealed"] == [0, 2]

    text = school.teacher.call("GET", f"/rooms/{code}/results?format=csv").text
    rows = list(csv.DictReader(io.StringIO(text)))
    gains = [(row["seed"], row["gain"]) for row in rows if row["card"] == "2"]
    assert gains[:-1] == [("0", "1"), ("1", "1"), ("2", "0"), ("3", "0")]
    assert gains[-1] == ("class", "0.5")
    assert float(rows[-1]["gain_low"]) == pytest.approx(of_class["low"])


def test_a_lesson_that_is_taught_hides_its_question_from_all_but_operators(school: Class) -> None:
    stored = school.teacher.call("POST", "/lessons", json={**LESSON, "title": "Luck, taught"})
    lesson_id = stored.json()["id"]
    code = school.room(lesson_id)
    stranger = school.pupil()
    assert school.teacher.get(f"/lessons/{lesson_id}")["before"]["right"] == "The lucky"
    lesson = stranger.get(f"/lessons/{lesson_id}")
    assert lesson["is_taught"]
    assert (lesson["before"], lesson["minutes"], lesson["ages"]) == (None, 20, "from 12")
    # The room goes on with its copy while the lesson is deleted, and hides it once it is back.
    shown = school.teacher.get(f"/rooms/{code}")
    assert school.teacher.call("DELETE", f"/lessons/{lesson_id}").status_code == 200
    refused(stranger.call("GET", f"/lessons/{lesson_id}"), 404, "no lesson")
    assert school.teacher.get(f"/rooms/{code}")["lesson"] == shown["lesson"]
    assert school.teacher.call("PUT", f"/rooms/{code}/card", json={"card": 1}).status_code == 200
    school.teacher.call("PUT", f"/rooms/{code}/card", json={"card": 0})
    refused(stranger.call("POST", f"/lessons/{lesson_id}/restore"), 401)
    assert school.teacher.call("POST", f"/lessons/{lesson_id}/restore").status_code == 200
    assert stranger.get(f"/lessons/{lesson_id}") == lesson
    school.teacher.call("POST", f"/rooms/{code}/end")
    listed = school.teacher.get("/lessons")["items"]
    (entry,) = [item for item in listed if item["id"] == lesson_id]
    assert (entry["minutes"], entry["has_knowledge_question"]) == (20, True)


def test_a_lesson_that_is_taught_in_one_language_hides_as_much_in_all(school: Class) -> None:
    lesson = {"lesson": "legs-and-balance", "language": "de"}
    room = school.teacher.call("POST", "/rooms", json=lesson).json()
    assert school.teacher.get(f"/rooms/{room['code']}")["language"] == "de"
    for language in ("en", "de", "fr"):
        address = f"/lessons/legs-and-balance?language={language}"
        assert school.teacher.get(address)["before"] is not None
        read = school.pupil().get(address)
        assert read["is_taught"]
        assert read["before"] is None
