"""The race of a card's best, median and last robot; and what a projector tells before a reveal."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from app.api.deps import Services
from app.features.classroom.rooms import Rooms
from tests.api.calls import Api, refused
from tests.features.classroom.school import LESSON, Class, started


def run_on(school: Class, pupils: list[Api], code: str, settings: list[dict[str, Any]]) -> None:
    runs = [
        started(pupil.call("POST", f"/rooms/{code}/runs", json={"settings": given}))
        for pupil, given in zip(pupils, settings, strict=True)
    ]
    for run in runs:
        school.finished(run)


def result(api: Api, code: str, card: int, query: str = "&projector=true") -> dict[str, Any]:
    (view,) = api.get(f"/rooms/{code}/results?card={card}{query}")["cards"]
    return dict(view)


def test_best_median_and_last_race_together_as_far_as_they_did_alone(school: Class) -> None:
    code = school.room()
    pupils = [school.joined(code) for _ in range(5)]
    school.show(code, 1)
    run_on(school, pupils, code, [{}] * 5)
    assert result(school.teacher, code, 1)["race"] is None
    assert school.teacher.call("POST", f"/rooms/{code}/reveal").status_code == 200
    view = result(school.teacher, code, 1)
    alone = {entry["seed"]: entry["run"]["distance_m"] for entry in view["entries"]}
    best, median, last = view["race"]["seeds"]
    assert view["race"]["of"] == 5
    by_distance = sorted(alone.values())
    assert [alone[seed] for seed in (best, median, last)] == [
        by_distance[-1],
        by_distance[2],
        by_distance[0],
    ]
    room = school.teacher.get(f"/rooms/{code}")
    assert room["spotlight"] == view["race"]["run_id"]
    assert room["started"] == 5, "it is no run of a participant"
    race = school.teacher.get(f"/races/{view['race']['run_id']}")
    together = [lane["clocks"]["paper"]["finished_distance_m"] for lane in race["result"]["lanes"]]
    assert together == pytest.approx([alone[seed] for seed in (best, median, last)], abs=1e-9)
    # All see it, and no second one is started.
    assert pupils[0].get(f"/races/{race['id']}")["id"] == race["id"]
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    assert result(school.teacher, code, 1)["race"]["run_id"] == race["id"]
    school.show(code, 2)
    assert school.teacher.get(f"/rooms/{code}")["spotlight"] is None


def test_learners_of_races_race_together_too(school: Class) -> None:
    code = school.room()
    pupils = [school.joined(code) for _ in range(2)]
    school.show(code, 2)
    run_on(school, pupils, code, [{}] * 2)
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    view = result(school.teacher, code, 2)
    race = school.teacher.get(f"/races/{view['race']['run_id']}")
    assert [lane["agent"] for lane in race["config"]["lanes"]] == ["q-learning"] * 2
    assert race["config"]["steps"] == 5
    assert sorted(view["race"]["seeds"]) == [0, 1]


def test_only_robots_that_walk_alike_race_and_it_is_told_of_how_many(school: Class) -> None:
    card = {**LESSON["cards"][1], "may": {"gait": {"choices": ["left-right-origin", "tripod"]}}}
    code = school.room({"title": "Two gaits", "cards": [card]})
    pupils = [school.joined(code) for _ in range(3)]
    run_on(school, pupils, code, [{}, {"gait": "tripod"}, {}])
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    race = result(school.teacher, code, 0)["race"]
    assert (sorted(race["seeds"]), race["of"]) == ([0, 2], 2)


def test_without_a_finished_run_there_is_no_race(school: Class) -> None:
    code = school.room()
    school.joined(code)
    school.show(code, 1)
    assert school.teacher.call("POST", f"/rooms/{code}/reveal").status_code == 200
    assert result(school.teacher, code, 1)["race"] is None
    assert school.teacher.get(f"/rooms/{code}")["spotlight"] is None


def test_a_projector_tells_a_distance_once_its_phone_has_shown_it(school: Class) -> None:
    code = school.room()
    pupils = [school.joined(code) for _ in range(2)]
    school.show(code, 1)
    run_on(school, pupils, code, [{}] * 2)
    run_id = pupils[0].get(f"/rooms/{code}")["me"]["runs"][0]["run_id"]
    with pages_are_open(school):
        view = result(school.teacher, code, 1)
        assert (view["on_their_way"], view["distances_m"], view["finished"]) == (2, [], 2)
        assert [entry["run"] for entry in view["entries"]] == [None, None]
        assert len(result(school.teacher, code, 1, "")["distances_m"]) == 2, "the teacher's own"
        refused(
            pupils[1].call("PUT", f"/rooms/{code}/runs/{run_id}/watched"), 403, "a participant's"
        )
        refused(school.teacher.call("PUT", f"/rooms/{code}/runs/{run_id}/watched"), 403)
        assert pupils[0].call("PUT", f"/rooms/{code}/runs/{run_id}/watched").status_code == 204
        view = result(school.teacher, code, 1)
        assert (view["on_their_way"], len(view["distances_m"])) == (1, 1)
        school.teacher.call("POST", f"/rooms/{code}/reveal")
        view = result(school.teacher, code, 1)
        assert (view["on_their_way"], len(view["distances_m"])) == (0, 2)


def test_a_phone_that_is_closed_is_waited_for_by_nobody(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 1)
    run_on(school, [pupil], code, [{}])
    view = result(school.teacher, code, 1)
    assert (view["on_their_way"], len(view["distances_m"])) == (0, 1)


@contextmanager
def pages_are_open(school: Class) -> Iterator[None]:
    """As if the page of each participant were open: these clients follow no events."""
    services: Services = school.services
    rooms = services.of(Rooms)
    before, rooms.is_here = rooms.is_here, lambda seat: True
    try:
        yield
    finally:
        rooms.is_here = before
