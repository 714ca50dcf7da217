"""Rooms over REST: a class of clients with cookies of their own, and real jobs."""

from collections.abc import Callable
from typing import Any

import pytest
from fastapi import FastAPI
from pydantic import TypeAdapter

from app.api.deps import EventListener, Services
from app.features.classroom.access import Participant
from app.features.classroom.response_models import (
    LessonList,
    LessonView,
    RoomList,
    RoomView,
)
from app.features.classroom.results import ResultsView
from app.features.classroom.room import RoomEvent
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.features.classroom.seats import MAX_PARTICIPANTS
from tests.api.calls import Api, refused
from tests.features.classroom.school import FORM, LESSON, TOKEN, Class, started


def test_a_class_predicts_runs_and_sees_what_came_of_it(school: Class) -> None:
    code = school.room()
    assert len(code) == 8
    assert not set(code) & set("0O1I")
    pupils = [school.joined(code) for _ in range(4)]
    views = [pupil.get(f"/rooms/{code}") for pupil in pupils]
    assert [view["me"]["seed"] for view in views] == [0, 1, 2, 3]
    assert len({view["me"]["name"] for view in views}) == 4
    assert {view["role"] for view in views} == {"participant"}
    school.show(code, 1)
    for number, pupil in enumerate(pupils):
        body = {"card": 1, "value": number / 10}
        answer = pupil.call("POST", f"/rooms/{code}/predictions", json=body)
        assert (answer.status_code, answer.json()) == (201, body)
        refused(pupil.call("POST", f"/rooms/{code}/predictions", json=body), 409, "stays")
    runs = [started(pupil.call("POST", f"/rooms/{code}/runs")) for pupil in pupils]
    assert [run["config"]["seed"] for run in runs] == [0, 1, 2, 3]
    for run in runs:
        school.finished(run)

    def results_of_card_1(view: dict[str, Any]) -> dict[str, Any]:
        result: dict[str, Any] = next(card for card in view["cards"] if card["card"] == 1)
        return result

    before = results_of_card_1(pupils[1].get(f"/rooms/{code}/results"))
    assert [entry["seed"] for entry in before["entries"]] == [1]
    assert (before["distances_m"], before["interval"], before["answer"]) == ([], None, None)
    assert (before["predicted"], before["finished"]) == (4, 4)
    assert before["entries"][0]["score"] is None
    teachers = results_of_card_1(school.teacher.get(f"/rooms/{code}/results?card=1"))
    assert [entry["name"] for entry in teachers["entries"]] == [v["me"]["name"] for v in views]
    assert school.teacher.call("POST", f"/rooms/{code}/reveal").status_code == 200
    after = results_of_card_1(pupils[1].get(f"/rooms/{code}/results"))
    distances = sorted(
        entry["run"]["distance_m"] for entry in after["entries"] if entry["run"] is not None
    )
    assert after["distances_m"] == distances
    assert len(distances) == 4
    assert after["interval"]["low_m"] <= after["interval"]["iqm_m"] <= after["interval"]["high_m"]
    score = after["entries"][3]["score"]
    below = (
        sum(distance < 0.3 for distance in distances)
        + sum(distance == 0.3 for distance in distances) / 2
    )
    assert score["quantile"] == pytest.approx(below / 4)
    assert score["error"] == pytest.approx(abs(0.3 - after["interval"]["iqm_m"]))
    assert min(entry["run"]["rank"] for entry in after["entries"]) == 1
    late = pupils[0].call("POST", f"/rooms/{code}/predictions", json={"card": 1, "value": 1})
    refused(late, 409)


def test_who_joins_again_has_the_same_name_and_seed(school: Class) -> None:
    code = school.room()
    pupil = school.pupil()
    first = pupil.call("POST", f"/rooms/{code}/participants")
    cookie = first.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert "Path=/" in cookie
    for typed in (
        f"{code.lower()[:4]}-{code[4:]}",
        f"{code[:4]} {code[4:]}",
        f" {code[:3]}·{code[3:]}",
    ):
        again = pupil.call("POST", f"/rooms/{typed}/participants")
        assert (again.status_code, again.json()) == (200, first.json())
    assert pupil.call("DELETE", f"/rooms/{code}/me").status_code == 204
    refused(pupil.call("POST", f"/rooms/{code}/runs"), 401)
    other = pupil.call("POST", f"/rooms/{code}/participants")
    assert other.status_code == 201
    assert other.json()["seed"] == first.json()["seed"] + 1


def test_a_join_whose_answer_was_lost_is_repeated(school: Class) -> None:
    code = school.room()
    path, secret = f"/rooms/{code}/participants", {"Idempotency-Key": "a-long-secret-of-a-phone"}
    first = school.pupil().call("POST", path, headers=secret)
    again, other = (school.pupil() for _ in range(2))
    answer = again.call("POST", path, headers=secret)
    assert (first.status_code, answer.status_code) == (201, 200)
    assert answer.json() == first.json()
    assert again.get(f"/rooms/{code}")["me"]["seed"] == first.json()["seed"]
    assert school.teacher.get(f"/rooms/{code}")["participants"] == 1
    # Who has left does not come back by it.
    again.call("DELETE", f"/rooms/{code}/me")
    assert other.call("POST", path, headers=secret).json()["seed"] == 1
    refused(other.call("POST", path, headers={"Idempotency-Key": "short"}), 422, "at least 16")


def test_a_run_of_a_card_that_is_shown_no_more_is_refused(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 2)
    answer = pupil.call("POST", f"/rooms/{code}/runs", json={"card": 1})
    refused(answer, 403, "class is at card 2")
    refused(pupil.call("POST", f"/rooms/{code}/runs", json={"card": 9}), 404, "0 to 5")
    started(pupil.call("POST", f"/rooms/{code}/runs", json={"card": 2}))


def test_who_leaves_behind_a_proxy_loses_the_cookie(serve: Callable[..., Api]) -> None:
    api = serve(token=TOKEN, public_url="https://hexapods.example")
    teacher = {"Authorization": f"Bearer {TOKEN}"}
    code = api.call("POST", "/rooms", json={}, headers=teacher).json()["code"]
    joined = api.call("POST", f"/rooms/{code}/participants").headers["set-cookie"]
    assert joined.startswith("__Host-")
    cookie = {"Cookie": joined.partition(";")[0]}
    left = api.call("DELETE", f"/rooms/{code}/me", headers={**cookie, "X-Requested-With": "tests"})
    assert left.status_code == 204
    assert left.headers["set-cookie"].partition("=")[0] == joined.partition("=")[0]
    assert "Max-Age=0" in left.headers["set-cookie"]
    api.call("POST", f"/rooms/{code}/end", headers=teacher)


def test_a_race_and_a_what_if_of_a_card(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 2)
    race = started(pupil.call("POST", f"/rooms/{code}/runs", json={}))
    assert race["kind"] == "race"
    assert race["config"]["seed"] == 0
    assert [lane["agent"] for lane in race["config"]["lanes"]] == ["q-learning", "greedy"]
    body = {"card": 2, "value": "greedy"}
    assert pupil.call("POST", f"/rooms/{code}/predictions", json=body).status_code == 201
    ended = school.finished(race)
    again = started(pupil.call("POST", f"/rooms/{code}/runs"))
    assert again["id"] == race["id"]
    (result,) = school.teacher.get(f"/rooms/{code}/results?card=2")["cards"]
    (entry,) = result["entries"]
    lanes = ended["result"]["lanes"]
    won = [lane["agent"] for lane in lanes if lane["clocks"]["paper"]["rank"] == 1]
    assert entry["run"]["winners"] == won
    assert entry["run"]["distance_m"] == lanes[0]["clocks"]["paper"]["finished_distance_m"]
    assert entry["score"]["share"] == (1 / len(won) if "greedy" in won else 0)
    school.show(code, 3)
    answer = pupil.call("POST", f"/rooms/{code}/runs")
    assert answer.status_code == 200
    assert len(answer.json()["chosen"]["distances_m"]) == 30


@pytest.mark.parametrize(
    ("card", "settings", "words"),
    [
        (1, {"alpha": 0.9}, "lpha must be a number from 0.1 to 0.5"),
        (1, {"steps": 90}, "up to 80"),
        (1, {"gamma": 0.1}, "amma cannot be changed on this card; open are: alpha, steps"),
        (1, {"steps": "many"}, "teps must be a whole number"),
        (1, {"seed": 4}, "eed cannot be changed"),
        (2, {"alpha": 0.3}, "open are: none"),
    ],
)
def test_settings_outside_of_the_card_are_refused(
    school: Class, card: int, settings: dict[str, Any], words: str
) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, card)
    refused(pupil.call("POST", f"/rooms/{code}/runs", json={"settings": settings}), 422, words)


@pytest.mark.parametrize(
    ("card", "value", "words"),
    [
        (1, "far", "must be a number from -1 to 2"),
        (1, 3, "must be a number from -1 to 2"),
        (1, True, "must be a number"),
        (2, "beam", "choose one of: q-learning, greedy"),
        (2, 1, "choose one of"),
        (4, [1], "point is [x, y]"),
        (5, [[0, 0]], "2 to 200 points"),
        (5, [[1, 0], [0, 0]], "from left to right"),
    ],
)
def test_answers_that_are_none_are_refused(
    school: Class, card: int, value: Any, words: str
) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, card)
    answer = pupil.call("POST", f"/rooms/{code}/predictions", json={"card": card, "value": value})
    refused(answer, 422, words)


def test_what_the_card_does_not_allow_is_refused(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    refused(pupil.call("POST", f"/rooms/{code}/runs"), 403, "ard 0 runs nothing")
    body: dict[str, Any] = {"card": 0, "value": 1}
    refused(pupil.call("POST", f"/rooms/{code}/predictions", json=body), 403, "asks nothing")
    school.show(code, 1)
    body = {"card": 2, "value": "greedy"}
    refused(pupil.call("POST", f"/rooms/{code}/predictions", json=body), 403, "is at card 1")
    refused(pupil.call("POST", "/trainings", json=FORM), 403, "an answer to the card")
    refused(pupil.call("PUT", f"/rooms/{code}/card", json={"card": 2}), 403)
    refused(pupil.call("GET", "/lessons/one-run-proves-nothing"), 403)
    assert school.teacher.call("POST", f"/rooms/{code}/freeze").status_code == 200
    refused(pupil.call("POST", f"/rooms/{code}/runs"), 409, "stopped the class")
    answer = school.teacher.call("POST", f"/rooms/{code}/freeze", json={"frozen": False})
    assert answer.json()["state"] == "open"
    other = school.room(is_further=True)
    refused(pupil.call("POST", f"/rooms/{other}/runs"), 403)
    spectator = school.pupil()
    refused(spectator.call("POST", f"/rooms/{code}/runs"), 401)


def test_others_see_no_run_before_the_reveal(school: Class) -> None:
    code = school.room()
    first, second = school.joined(code), school.joined(code)
    spectator = school.pupil()
    school.show(code, 1)
    run = started(first.call("POST", f"/rooms/{code}/runs"))
    school.finished(run)

    def sees(api: Api) -> bool:
        listed = [item["id"] for item in api.get("/runs")["items"]]
        answer = api.call("GET", f"/trainings/{run['id']}/curve")
        assert (run["id"] in listed) == (answer.status_code == 200)
        assert api.call("GET", f"/runs/curves?id={run['id']}").status_code == answer.status_code
        return run["id"] in listed

    assert [sees(api) for api in (school.teacher, first, second, spectator)] == [
        *(True, True, False, False)
    ]
    answer = school.teacher.call("PUT", f"/rooms/{code}/spotlight", json={"run_id": run["id"]})
    assert answer.json()["spotlight"] == run["id"]
    shown = school.teacher.client.get(f"/r/{code}/api/v1/stage").json()
    assert shown["run_id"] == run["id"]
    assert sees(second)
    assert sees(spectator)


def test_names_are_hidden_and_participants_approved(school: Class) -> None:
    code = school.room(needs_approval=True)
    first, second = school.joined(code), school.joined(code)
    school.show(code, 4)
    for pupil in (first, second):
        body = {"card": 4, "value": [1, 2]}
        assert pupil.call("POST", f"/rooms/{code}/predictions", json=body).status_code == 201
    school.teacher.call("POST", f"/rooms/{code}/reveal", json={"card": 4})

    def names_of_others() -> list[tuple[int, str | None]]:
        (result,) = first.get(f"/rooms/{code}/results?card=4")["cards"]
        return [(x["seed"], x["name"]) for x in result["entries"] if not x["is_own"]]

    assert names_of_others() == []
    path = f"/rooms/{code}/participants/1"
    view = school.teacher.call("PATCH", path, json={"is_approved": True}).json()
    assert names_of_others() == [(1, view["people"][1]["name"])]
    school.teacher.call("PATCH", path, json={"is_name_hidden": True})
    assert names_of_others() == [(1, None)]
    csv = school.teacher.call("GET", f"/rooms/{code}/results?format=csv").text
    assert csv.startswith("card,seed,")
    assert view["people"][1]["name"] not in csv
    refused(first.call("PATCH", path, json={"is_approved": True}), 403)


def test_nothing_of_a_participant_is_shown_before_the_approval(school: Class) -> None:
    code = school.room(needs_approval=True)
    first, second = school.joined(code), school.joined(code)
    school.show(code, 1)
    for pupil in (first, second):
        body = {"card": 1, "value": 0.1}
        assert pupil.call("POST", f"/rooms/{code}/predictions", json=body).status_code == 201
        school.finished(started(pupil.call("POST", f"/rooms/{code}/runs")))

    def seen(api: Api, query: str = "") -> tuple[list[int], int]:
        (result,) = api.get(f"/rooms/{code}/results?card=1{query}")["cards"]
        view = {"code": code, "gain": None, "cards": [result]}
        TypeAdapter(ResultsView).validate_python(view)
        return [entry["seed"] for entry in result["entries"]], len(result["distances_m"])

    projector = "&projector=true"
    assert seen(school.teacher) == ([0, 1], 2)
    assert seen(school.teacher, projector) == ([], 0)
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    # Each sees the own one alone, also among the distances without a name.
    assert seen(first) == ([0], 1)
    path = f"/rooms/{code}/participants/1"
    school.teacher.call("PATCH", path, json={"is_approved": True})
    assert seen(first) == ([0, 1], 2)
    assert seen(second) == ([1], 1)
    assert seen(school.teacher, projector) == ([1], 1)
    assert seen(second, projector) == ([1], 1)


def test_a_what_if_is_kept_as_a_result_of_the_card(school: Class) -> None:
    card = {
        **LESSON["cards"][3],
        "may": {"alpha": {"choices": [0.1, 0.5]}},
        "ask": {"kind": "number", "text": "How far?", "unit": "m"},
    }
    code = school.room({"title": "x", "cards": [card]})
    first, second = school.joined(code), school.joined(code)
    path = f"/rooms/{code}/runs"
    prediction = {"card": 0, "value": 0.1}
    assert first.call("POST", f"/rooms/{code}/predictions", json=prediction).status_code == 201
    settings = {"settings": {"alpha": 0.1}, "card": 0}
    answer = first.call("POST", path, json=settings).json()
    assert first.call("POST", path, json=settings).json() == answer
    assert second.call("POST", path, json={}).status_code == 200

    def entries(api: Api) -> list[dict[str, Any]]:
        view = api.get(f"/rooms/{code}/results?card=0")
        TypeAdapter(ResultsView).validate_python(view)
        entries_of_card: list[dict[str, Any]] = view["cards"][0]["entries"]
        return entries_of_card

    (own_entry,) = entries(first)
    assert own_entry["run"]["kind"] == "what-if"
    assert own_entry["run"]["given"] == {"alpha": 0.1}
    assert own_entry["run"]["distance_m"] == answer["chosen"]["iqm_m"]
    assert own_entry["run"]["answer"] == answer
    # Others see it after the reveal alone, and are told how many have asked.
    assert [entry["seed"] for entry in entries(second)] == [1]
    assert second.get(f"/rooms/{code}")["started"] == 2
    view = school.teacher.get(f"/rooms/{code}")
    assert [(x["run_id"], x["run_state"]) for x in view["people"]] == [(None, "finished")] * 2
    assert first.get(f"/rooms/{code}")["me"]["runs"] == []
    spotlight = {"run_id": own_entry["run"]["id"]}
    refused(school.teacher.call("PUT", f"/rooms/{code}/spotlight", json=spotlight), 404)
    csv = school.teacher.call("GET", f"/rooms/{code}/results?format=csv").text
    row = csv.splitlines()[1].split(",")
    assert row[8:10] == ["what-if", "finished"]
    assert float(row[11]) == answer["chosen"]["iqm_m"]
    school.teacher.call("POST", f"/rooms/{code}/reveal")
    seen = entries(second)
    assert [(x["run"]["rank"], x["run"]["answer"] is None) for x in seen if not x["is_own"]] in (
        [(1, True)],
        [(2, True)],
    )
    assert seen[0]["score"]["quantile"] is not None


def test_a_class_behind_one_address_may_ask_what_ifs(school: Class) -> None:
    code = school.room({"title": "x", "cards": [LESSON["cards"][3]]})
    pupils = [school.joined(code) for _ in range(3)]
    for _ in range(12):
        for pupil in pupils:
            assert pupil.call("POST", f"/rooms/{code}/runs", json={}).status_code == 200
    spectator = school.pupil()
    assert (
        spectator.call("POST", "/what-if", json={"gait": "tripod", "steps": 5}).status_code == 200
    )


def test_the_session_of_a_teacher_holds_in_the_room(school: Class) -> None:
    code = school.room()
    client = school.pupil().client
    assert client.get(f"/?token={TOKEN}").status_code == 303
    for prefix in ("", f"/r/{code}"):
        assert client.get(f"{prefix}/api/v1/rooms/{code}").json()["role"] == "teacher"
        answer = client.put(f"{prefix}/api/v1/rooms/{code}/card", json={"card": 1})
        assert answer.status_code == 200
    # Who has the token is teacher, whatever rooms this browser has joined.
    assert client.post(f"/api/v1/rooms/{code}/participants", json={}).status_code == 201
    assert client.get(f"/api/v1/rooms/{code}").json()["role"] == "teacher"


def test_a_room_has_a_page_and_an_end(school: Class) -> None:
    code = school.room()
    client = school.pupil().client
    door = client.get(f"/r/{code}")
    assert door.status_code == 200
    assert "static/features/classroom/room/main.js" in door.text
    assert client.get(f"/r/{code.lower()}/").headers["location"] == f"../{code}/"
    page = client.get(f"/r/{code}/")
    assert page.status_code == 200
    assert "<html" in page.text
    assert client.get(f"/r/{code}/api/v1/rooms/{code}").json()["role"] == "spectator"
    pupil = school.joined(code)
    assert school.teacher.call("POST", f"/rooms/{code}/end").json()["state"] == "ended"
    refused(pupil.call("POST", f"/rooms/{code}/participants"), 409, "has ended")
    refused(school.pupil().call("POST", f"/rooms/{code}/participants"), 409, "has ended")
    assert client.get(f"/r/{code}/").status_code == 410
    refused(client.get("/r/ZZZZZZZZ/"), 404, "look again at the code")
    assert school.teacher.get(f"/rooms/{code}/results")["code"] == code


@pytest.mark.parametrize("runs", [False, True])
def test_a_room_that_has_ended_can_be_deleted(school: Class, runs: bool) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 2)
    race = started(pupil.call("POST", f"/rooms/{code}/runs"))
    school.finished(race)
    training = race["config"]["lanes"][0]["training_id"]
    path = f"/rooms/{code}"
    refused(school.teacher.call("DELETE", path), 409, "end it first")
    school.teacher.call("POST", f"{path}/end")
    refused(pupil.call("DELETE", path), 401)
    listed = school.teacher.get("/rooms")["items"]
    assert next(room["state"] for room in listed if room["code"] == code) == "ended"
    answer = school.teacher.call("DELETE", path, params={"runs": runs})
    assert answer.status_code == 200
    gone = [race["id"], training] if runs else []
    assert answer.json() == {"deleted": gone, "kept": [], "restorable_until": None}
    refused(school.teacher.call("GET", path), 404)
    refused(pupil.call("POST", f"{path}/participants"), 404)
    # What stays is an ordinary run, which all may see.
    status = school.pupil().call("GET", f"/races/{race['id']}").status_code
    assert status == (404 if runs else 200)


def test_a_full_room_gives_the_seats_of_those_who_never_did_anything(school: Class) -> None:
    code = school.room()
    school.show(code, 1)
    path, busy = f"/rooms/{code}/participants", school.joined(code)
    busy.call("POST", f"/rooms/{code}/predictions", json={"card": 1, "value": 0.5})
    idle = [school.joined(code) for _ in range(MAX_PARTICIPANTS)]
    assert busy.get(f"/rooms/{code}")["participants"] == MAX_PARTICIPANTS
    assert busy.get(f"/rooms/{code}")["me"]["seed"] == 0
    # Who has joined first has lost the seat, and comes in again as somebody else.
    assert idle[0].get(f"/rooms/{code}")["role"] == "spectator"
    refused(idle[0].call("POST", f"/rooms/{code}/predictions", json={"card": 1, "value": 1}), 401)
    again = idle[0].call("POST", path)
    assert (again.status_code, again.json()["seed"]) == (201, MAX_PARTICIPANTS + 1)
    for number, pupil in enumerate(idle[2:]):
        body = {"card": 1, "value": number / 100}
        answer = pupil.call("POST", f"/rooms/{code}/predictions", json=body)
        assert answer.status_code == 201, answer.text
    last = {"card": 1, "value": 1}
    assert idle[0].call("POST", f"/rooms/{code}/predictions", json=last).status_code == 201
    refused(school.pupil().call("POST", path), 429, "the most")
    # Who is in already is not disturbed, however often the page is loaded anew.
    for _ in range(20):
        assert busy.call("POST", path).status_code == 200


def test_a_teacher_removes_a_participant(school: Class) -> None:
    code = school.room()
    pupil, other = school.joined(code), school.joined(code)
    school.show(code, 1)
    path = f"/rooms/{code}"
    body = {"card": 1, "value": 0.5}
    assert pupil.call("POST", f"{path}/predictions", json=body).status_code == 201
    ended = school.finished(started(pupil.call("POST", f"{path}/runs")))
    school.show(code, 2)
    name = pupil.get(path)["me"]["name"]
    steps = {"card": 2, "settings": {}}
    waiting = started(pupil.call("POST", f"{path}/runs", json=steps))
    refused(pupil.call("DELETE", f"{path}/participants/1"), 403)
    refused(school.pupil().call("DELETE", f"{path}/participants/0"), 401)
    refused(school.teacher.call("DELETE", f"{path}/participants/7"), 404, "no participant")
    answer = school.teacher.call("DELETE", f"{path}/participants/0")
    assert answer.status_code == 200, answer.text
    assert [person["seed"] for person in answer.json()["people"]] == [1]
    assert school.teacher.get(f"/races/{waiting['id']}")["state"] in ("stopped", "finished")
    results = school.teacher.call("GET", f"{path}/results")
    assert name not in results.text
    assert ended["id"] not in results.text
    assert [card["predicted"] for card in results.json()["cards"]] == [0] * 6
    # Of the removed, a stranger is left, who may join again.
    assert pupil.get(path)["role"] == "spectator"
    refused(pupil.call("POST", f"{path}/predictions", json=body), 401)
    assert pupil.call("POST", f"{path}/participants").json()["seed"] == 2
    for reader in (pupil, other):
        refused(reader.call("GET", f"/trainings/{ended['id']}"), 403)
    assert school.teacher.get(f"/trainings/{ended['id']}")["state"] == "finished"
    school.teacher.call("POST", f"{path}/end")
    refused(school.teacher.call("DELETE", f"{path}/participants/1"), 409, "has ended")
    # With the room, its runs go too.
    deleted = school.teacher.call("DELETE", path, params={"runs": True}).json()["deleted"]
    assert {ended["id"], waiting["id"]} <= set(deleted)


def test_the_events_of_who_was_removed_end(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    services: Services = school.teacher.client.app.state.services  # type: ignore[attr-defined]
    ended: list[str] = []
    listener = EventListener("spectator", Participant(((code, 0),), services.of(Rooms), {}))
    listener.close = lambda: ended.append("closed")
    services.listeners.take(listener, "192.0.2.1", is_operator=False)
    assert services.of(Rooms).is_here((code, 0))
    school.teacher.call("DELETE", f"/rooms/{code}/participants/0")
    services.listeners.leave(listener)
    assert ended == ["closed"]
    assert pupil.get(f"/rooms/{code}")["role"] == "spectator"


def test_cards_that_are_to_come_have_no_results(school: Class) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 2)
    cards = pupil.get(f"/rooms/{code}/results")["cards"]
    assert [card["card"] for card in cards] == [0, 1, 2]
    refused(pupil.call("GET", f"/rooms/{code}/results?card=4"), 403, "was not shown yet")
    assert len(school.teacher.get(f"/rooms/{code}/results")["cards"]) == 6


def test_a_code_for_phones_is_there_where_phones_can_come(serve: Callable[..., Api]) -> None:
    teacher = {"Authorization": f"Bearer {TOKEN}"}
    for settings, is_reachable in (
        ({}, False),
        ({"public_url": "https://hexapods.example"}, True),
        ({"host": "192.0.2.7"}, True),
    ):
        api = serve(token=TOKEN, **settings)
        assert api.call("GET", "/rooms", headers=teacher).json()["is_reachable"] is is_reachable
        room = api.call("POST", "/rooms", json={}, headers=teacher).json()
        code = room["code"]
        view = api.call("GET", f"/rooms/{code}", headers=teacher).json()
        assert room["address"].endswith(f"/r/{code[:4]}-{code[4:]}")
        assert view["address"] == room["address"]
        lesson = {"title": "x", "cards": [{"text": "x"}]}
        stored = api.call("POST", "/lessons", json=lesson, headers=teacher).json()
        for answer in (room, view, stored):
            assert (answer["qr_code"] is not None) is is_reachable
    # By this name somebody has come from elsewhere.
    named = serve(token=TOKEN, allowed_hosts=("lab.example",))
    elsewhere = {**teacher, "Host": "lab.example"}
    assert named.call("GET", "/rooms", headers=elsewhere).json()["is_reachable"] is True


@pytest.mark.parametrize(
    ("method", "path", "body", "words"),
    [
        ("POST", "/participants", {"name": "<b>Bad</b>"}, "unknown field 'name'"),
        ("POST", "/predictions", {"card": 1}, "value"),
        ("POST", "/predictions", {"card": "one", "value": 1}, "card"),
        ("POST", "/runs", {"steps": 4}, "unknown field 'steps'; choose one of: card, settings"),
        ("PUT", "/card", {"card": -1}, "card"),
        ("PUT", "/card", {"card": 1.5}, "card"),
        ("POST", "/freeze", {"frozen": "yes"}, "frozen"),
        ("PUT", "/spotlight", {}, "run_id"),
        ("PATCH", "/participants/0", {"is_approved": 1}, "is_approved"),
    ],
)
def test_invalid_requests_are_refused_with_the_reason(
    school: Class, method: str, path: str, body: Any, words: str
) -> None:
    code = school.room()
    pupil = school.joined(code)
    school.show(code, 1)
    is_pupils = path in ("/participants", "/predictions", "/runs")
    api = pupil if is_pupils and path != "/participants" else school.pupil()
    problem = refused(
        (api if is_pupils else school.teacher).call(method, f"/rooms/{code}{path}", json=body), 422
    )
    assert words in problem["detail"]
    refused(school.teacher.call("PUT", f"/rooms/{code}/card", json={"card": 9}), 404, "0 to 5")
    refused(school.teacher.call("POST", f"/rooms/{code}/reveal", json={"card": 9}), 404)
    answer = school.teacher.call("PUT", f"/rooms/{code}/spotlight", json={"run_id": "none"})
    refused(answer, 404, "has no run")


def test_changes_of_a_room_are_events_of_its_stage(school: Class) -> None:
    assert isinstance(school.teacher.client.app, FastAPI)
    services: Services = school.teacher.client.app.state.services
    code = school.room()
    shared = services.of(RoomStages).of(code)
    assert shared is not None
    subscription = shared.channel.subscribe()
    elsewhere = services.stages[0].channel.subscribe(names={"room"})
    pupil = school.joined(code)
    school.show(code, 1)
    pupil.call("POST", f"/rooms/{code}/predictions", json={"card": 1, "value": 0.5})
    (event,) = [event for event in subscription.drain() if event.event == "room"]
    room_event = TypeAdapter(RoomEvent).validate_json(event.data)
    assert (room_event.card, room_event.participants, room_event.predicted) == (1, 1, 1)
    run = started(pupil.call("POST", f"/rooms/{code}/runs"))
    school.finished(run)
    assert elsewhere.drain() == []
    for subscribed in (subscription, elsewhere):
        subscribed.close()


def test_answers_match_their_models(school: Class) -> None:
    code = school.room("one-run-proves-nothing")
    pupil = school.joined(code)
    school.show(code, 2)
    pupil.call("POST", f"/rooms/{code}/predictions", json={"card": 2, "value": 0.5})
    school.finished(started(pupil.call("POST", f"/rooms/{code}/runs")))
    for api in (school.teacher, pupil, school.pupil()):
        TypeAdapter(RoomView).validate_python(api.get(f"/rooms/{code}"))
        TypeAdapter(ResultsView).validate_python(api.get(f"/rooms/{code}/results"))
        TypeAdapter(RoomList).validate_python(api.get("/rooms"))
    TypeAdapter(LessonView).validate_python(school.teacher.get("/lessons/one-run-proves-nothing"))
    TypeAdapter(LessonList).validate_python(school.teacher.get("/lessons"))
    assert pupil.get(f"/rooms/{code}")["shown"]["reveal"] is None
    assert school.teacher.get(f"/rooms/{code}")["shown"]["reveal"] is not None


def test_there_is_no_room_below_a_room(api: Api) -> None:
    code = api.call("POST", "/rooms", json={}).json()["code"]
    assert api.client.get(f"/r/{code}/").status_code == 200
    assert api.client.get(f"/r/{code}/r/{code}/").status_code == 404
