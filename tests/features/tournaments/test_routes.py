"""Tournaments over REST: a class of clients with cookies of their own, and real judging."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from fastapi import FastAPI
from pydantic import TypeAdapter
from starlette.testclient import TestClient

from app.api.deps import Services
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.features.tournaments import tournaments
from app.features.tournaments.response_models import (
    EntryView,
    TournamentList,
    TournamentView,
)
from app.features.tournaments.tournament import TournamentEvent
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from hexapods.tournaments.rules import commitment_of
from hexapods.tournaments.tournament_file import read_file
from hexapods.tournaments.verification import verify
from tests.api.calls import ADDRESS, Api, refused
from tests.features.classroom.school import FORM, TOKEN, Class
from tests.quick_robot import HASTY_JSON
from tests.timeouts import ProgressTimeout

RULES: dict[str, Any] = {
    "gait": "left-right-origin",
    "simulator": "kinematic",
    "steps": 60,
    "draws": 5,
    "tables": True,
}
IN_MUJOCO: dict[str, Any] = {"simulator": "mujoco", "robot": HASTY_JSON}
TRAINING_CARD = {"title": "T", "cards": [{"text": "Go", "state": {"form": FORM}, "go": "training"}]}


class Contest(Class):
    """A class with tournaments."""

    @property
    def app(self) -> FastAPI:
        assert isinstance(self._client.app, FastAPI)
        return self._client.app

    def open(self, room: str | None = None, **options: Any) -> dict[str, Any]:
        """Open a tournament, after the end of those before."""
        for former in self.teacher.get("/tournaments")["items"]:
            self.teacher.call("DELETE", f"/tournaments/{former['id']}")
        rules = {**RULES, **options.pop("rules", {})}
        body = {"rules": rules, **({} if room is None else {"room": room}), **options}
        answer = self.teacher.call("POST", "/tournaments", json=body)
        assert answer.status_code == 201, answer.text
        view: dict[str, Any] = answer.json()
        assert answer.headers["location"] == f"/api/v1/tournaments/{view['id']}"
        return view

    def look(self, tournament: dict[str, Any], reader: Api | None = None) -> dict[str, Any]:
        view: dict[str, Any] = (reader or self.teacher).get(f"/tournaments/{tournament['id']}")
        TypeAdapter(TournamentView).validate_python(view)
        return view

    def until(
        self, tournament: dict[str, Any], is_so: Callable[[dict[str, Any]], bool]
    ) -> dict[str, Any]:
        stall_check = ProgressTimeout()
        while not is_so(view := self.look(tournament)):
            stall_check.check([(entry["state"], entry["judged"]) for entry in view["entries"]])
            time.sleep(0.03)
        return view

    def ended(self, tournament: dict[str, Any], **how: Any) -> dict[str, Any]:
        answer = self.teacher.call("POST", f"/tournaments/{tournament['id']}/end", json=how)
        assert answer.status_code == 200, answer.text
        return self.until(tournament, lambda view: view["state"] == "ended")


def enter(api: Api, tournament: dict[str, Any], **body: Any) -> Any:
    return api.call("POST", f"/tournaments/{tournament['id']}/entries", json=body)


def fields_of(problem: dict[str, Any]) -> list[str]:
    """Return the fields of a problem: those wrong by themselves, or the one that is in the way."""
    by_themselves = [error["field"] for error in problem.get("errors", [])]
    return by_themselves + ([problem["field"]] if "field" in problem else [])


def entered(api: Api, tournament: dict[str, Any], status: int = 202, **body: Any) -> dict[str, Any]:
    answer = enter(api, tournament, **body)
    assert answer.status_code == status, answer.text
    TypeAdapter(EntryView).validate_python(answer.json())
    view: dict[str, Any] = answer.json()
    return view


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Contest]:
    settings = Settings(data=tmp_path_factory.mktemp("school"), job_niceness=0, token=TOKEN)
    with ExitStack() as stack:
        store = stack.enter_context(open_store(settings))
        client = TestClient(create_app(settings, store), base_url=ADDRESS, follow_redirects=False)
        yield Contest(stack.enter_context(client), stack)


def test_a_class_enters_and_the_file_verifies(school: Contest) -> None:
    code = school.room()
    pupils = [school.joined(code) for _ in range(2)]
    tournament = school.open(code, title="Who walks <b>best</b>?")
    assert tournament["title"] == "Who walks <b>best</b>?"
    assert (tournament["secret"], tournament["draws"], tournament["file"]) == (None, None, None)
    first = entered(pupils[0], tournament, agent="q-learning", settings={"alpha": 0.2})
    assert first["is_own"]
    assert first["entry"]["settings"]["alpha"] == 0.2
    entered(pupils[1], tournament, agent="greedy")
    view_of_pupil = school.look(tournament, pupils[0])
    assert view_of_pupil["own"] == {"may_enter": True, "reason": None, "left": 5, "next_at": None}
    assert [entry["entry"] is not None for entry in view_of_pupil["entries"]] == [
        True,
        True,
        True,
        True,
        False,
    ]
    assert {entry["judgements"] for entry in view_of_pupil["entries"]} == {None} or not any(
        entry["judgements"] for entry in view_of_pupil["entries"]
    )
    (shown,) = pupils[0].get(f"/rooms/{code}")["tournaments"]
    assert shown == {"id": tournament["id"], "title": tournament["title"], "state": "open"}
    refused(pupils[0].call("GET", f"/tournaments/{tournament['id']}/file"), 409, "not ended")
    ended = school.ended(tournament)
    assert commitment_of(ended["secret"]) == tournament["commitment"]
    assert len(ended["draws"]) == RULES["draws"]
    assert [entry["state"] for entry in ended["entries"]] == ["judged"] * 5
    assert {len(entry["judgements"]) for entry in ended["entries"]} == {RULES["draws"]}
    assert sorted(standing["number"] for standing in ended["standings"]) == [0, 1, 2, 3, 4]
    file = pupils[0].call("GET", f"/tournaments/{tournament['id']}/file")
    assert f"tournament-{tournament['id']}.json" in file.headers["content-disposition"]
    assert verify(read_file(file.content, "the file"), workers=1) == []
    refused(enter(pupils[0], tournament, agent="greedy"), 409, "no more entries")


def test_what_is_entered_again_is_the_same_entry(school: Contest) -> None:
    code = school.room()
    pupil, tournament = school.joined(code), school.open(code, entries_per_hour=2)
    first = entered(pupil, tournament, agent="sarsa")
    again = entered(pupil, tournament, 200, agent="sarsa", steps=RULES["steps"])
    assert again["number"] == first["number"]
    entered(pupil, tournament, agent="sarsa", steps=10)
    used_up = enter(pupil, tournament, agent="sarsa", steps=20)
    refused(used_up, 429, "You have used up your 2 entries of this hour", "minutes")
    assert 3500 < int(used_up.headers["retry-after"]) <= 3600
    own_entries = school.look(tournament, pupil)["own"]
    assert (own_entries["may_enter"], own_entries["left"]) == (False, 0)
    assert own_entries["next_at"] is not None
    assert own_entries["reason"] == "You have used up your 2 entries of this hour."
    entered(pupil, tournament, 200, agent="sarsa")
    for steps in (1, 2, 3):  # operators have no limit
        view = entered(school.teacher, tournament, agent="sarsa", steps=steps, name="A guest")
        assert (view["name"], view["is_own"]) == ("A guest", True)
    teachers = school.look(tournament)["own"]
    assert teachers == {"may_enter": True, "reason": None, "left": None, "next_at": None}


@pytest.mark.parametrize(
    ("body", "status", "field", "words"),
    [
        ({"agent": "nobody"}, 422, "agent", "nknown agent 'nobody'; choose one of"),
        ({}, 422, "agent", "agent is missing"),
        ({"agent": "q-learning", "settings": {"alpha": 7}}, 422, "settings.alpha", "must be"),
        ({"agent": "q-learning", "settings": {"x": 7}}, 422, "settings", "x"),
        ({"agent": "q-learning", "settings": {"seed": 7}}, 422, "settings", "seed"),
        ({"agent": "q-learning", "steps": 61}, 422, "steps", "from 1 to 60, the budget"),
        ({"agent": "q-learning", "steps": "many"}, 422, "steps", "whole number"),
        ({"agent": "greedy", "steps": 5}, 422, "steps", "practises no steps"),
        ({"agent": "greedy", "robot": "ant"}, 422, "robot", "nt is no robot of this tournament"),
        ({"agent": "greedy", "robot": {"x": 1}}, 422, "robot", "robot field"),
        ({"agent": "greedy", "observation": "seen"}, 422, "observation", "observation must be"),
        ({"agent": "greedy", "name": "me"}, 403, "", "by their name in the room"),
        (
            {"agent": "q-learning", "training_id": "none"},
            422,
            "training_id",
            "no training 'none' in the room",
        ),
        (
            {"agent": "q-learning", "training_id": "x", "steps": 5},
            422,
            "steps",
            "teps of a table are those of its training",
        ),
    ],
)
def test_entries_that_the_rules_do_not_allow_are_refused(
    school: Contest, body: dict[str, Any], status: int, field: str, words: str
) -> None:
    code = school.room()
    pupil, tournament = school.joined(code), school.open(code)
    problem = refused(enter(pupil, tournament, **body), status, words)
    assert fields_of(problem) == ([field] if field else [])
    assert school.look(tournament, pupil)["own"]["left"] == 6


@pytest.mark.parametrize(
    ("body", "field", "words"),
    [
        ({"rules": {"gait": "moonwalk"}}, "rules.gait", "left-right-origin"),
        ({"rules": {"draws": 2}}, "rules.draws", "draws must be"),
        ({"rules": {"steps": 6000}}, "rules.steps", "steps must be a whole number from 1 to 5,000"),
        ({"rules": {"transitions": 100_001}}, "rules.transitions", "from 500 to 100,000"),
        ({"rules": {"transitions": "many"}}, "rules.transitions", "whole number"),
        ({"rules": {"transitions": 500}}, "rules.transitions", "at least 600 here"),
        ({"rules": {"worlds": ["nowhere"]}}, "rules.worlds.0", "nowhere"),
        ({"rules": {"worlds": []}}, "rules.worlds", "worlds"),
        ({"rules": {"worlds": ["flat", "flat"]}}, "rules.worlds", "is there twice"),
        ({"rules": {"disturbances": []}}, "rules", "disturbances"),
        ({"rules": {"robots": ["ant", "ant"]}}, "rules.robots", "is there twice"),
        ({"rules": {"seed": 5}}, "rules", "seed"),
        ({"title": "x" * 101}, "title", "title must be text"),
        ({"title": "a\u202eb"}, "title", "title must be text"),
        (
            {"entries_per_hour": 0},
            "entries_per_hour",
            "entries_per_hour must be a whole number from 1 to 60",
        ),
        ({"room": "ABCDEF"}, "", "there is no room"),
    ],
)
def test_rules_that_are_none_are_refused(
    school: Contest, body: dict[str, Any], field: str, words: str
) -> None:
    rules = {**RULES, **body.pop("rules")} if body.get("rules") else body.pop("rules", RULES)
    answer = school.teacher.call("POST", "/tournaments", json={"rules": rules, **body})
    problem = refused(answer, 404 if "room" in body else 422)
    assert words.lower() in problem["detail"].lower()
    assert fields_of(problem) == ([field] if field else [])


def test_an_unknown_agent_is_told_together_with_the_other_errors(school: Contest) -> None:
    code = school.room()
    pupil, tournament = school.joined(code), school.open(code)
    problem = refused(enter(pupil, tournament, agent="nobody", steps=0, observation="x"), 422)
    assert sorted(fields_of(problem)) == ["agent", "observation", "steps"]


def test_how_much_a_search_may_simulate_is_a_rule(school: Contest) -> None:
    assert school.open()["rules"]["transitions"] == 40_000
    tournament = school.open(rules={"transitions": 7_799})
    assert tournament["rules"]["transitions"] == 7_799
    entered(school.teacher, tournament, agent="look-ahead", settings={"depth": 2})
    ended = school.ended(tournament)
    (failure,) = {judgement["failure"] for judgement in ended["entries"][3]["judgements"]}
    assert "over 7,799 transitions" in failure
    file = school.teacher.call("GET", f"/tournaments/{tournament['id']}/file").content
    assert read_file(file, "file").rules.transitions == 7_799
    assert verify(read_file(file, "file"), workers=1) == []


def test_a_room_decides_who_may_know_and_enter(school: Contest) -> None:
    code, further = school.room(), ""
    further = school.room(is_further=True)
    member, further_member, anyone = school.joined(code), school.joined(further), school.pupil()
    tournament = school.open(code)
    path = f"/tournaments/{tournament['id']}"
    for reader in (further_member, anyone):
        refused(reader.call("GET", path), 403, "join the room")
        refused(reader.call("GET", f"{path}/file"), 403)
        assert reader.get("/tournaments")["items"] == []
    assert [listed["id"] for listed in member.get("/tournaments")["items"]] == [tournament["id"]]
    refused(enter(further_member, tournament, agent="greedy"), 403)
    refused(enter(anyone, tournament, agent="greedy"), 401)
    for method, below in (("POST", "/end"), ("DELETE", "")):
        refused(member.call(method, path + below), 403)
    refused(member.call("POST", "/tournaments", json={"rules": RULES}), 403)
    school.teacher.call("POST", f"/rooms/{code}/freeze")
    refused(enter(member, tournament, agent="greedy"), 409, "stopped the class")
    view = school.look(tournament, member)
    assert view["own"]["reason"] == "The teacher has stopped the class for a moment; wait."
    school.teacher.call("POST", f"/rooms/{code}/freeze", json={"frozen": False})
    entered(member, tournament, agent="greedy")
    school.teacher.call("POST", f"/rooms/{code}/end")
    refused(enter(member, tournament, agent="beam"), 401)
    view = school.look(tournament, anyone)  # all may see what came of it
    assert not view["own"]["may_enter"]
    assert [entry["is_own"] for entry in view["entries"]] == [False] * 4
    assert school.ended(tournament)["state"] == "ended"
    free = school.open()
    assert [listed["id"] for listed in anyone.get("/tournaments")["items"]] == [free["id"]]
    assert school.look(free, anyone)["own"]["reason"].startswith("Operators alone enter")
    TypeAdapter(TournamentList).validate_python(school.teacher.get("/tournaments"))


def test_names_are_those_that_the_room_shows(school: Contest) -> None:
    code = school.room(needs_approval=True)
    first, second = school.joined(code), school.joined(code)
    tournament = school.open(code)
    entered(first, tournament, agent="greedy")
    name = first.get(f"/rooms/{code}")["me"]["name"]

    def names() -> list[str | None]:
        return [
            school.look(tournament, reader)["entries"][3]["name"]
            for reader in (first, second, school.teacher)
        ]

    assert names() == [name, None, name]
    school.teacher.call("PATCH", f"/rooms/{code}/participants/0", json={"is_approved": True})
    assert names() == [name, name, name]
    school.teacher.call("PATCH", f"/rooms/{code}/participants/0", json={"is_name_hidden": True})
    assert names() == [name, None, name]
    school.ended(tournament)
    file = school.teacher.call("GET", f"/tournaments/{tournament['id']}/file")
    assert [e.name for e in read_file(file.content, "file").entries][3:] == ["Entry 3"]
    assert name not in file.text


def test_of_a_room_that_is_deleted_its_tournament_stays_without_names(school: Contest) -> None:
    services: Services = school.app.state.services
    code = school.room(TRAINING_CARD)
    pupil, anyone = school.joined(code), school.pupil()
    run = school.finished(pupil.call("POST", f"/rooms/{code}/runs").json())
    name = pupil.get(f"/rooms/{code}")["me"]["name"]
    tournament = school.open(code)
    entered(pupil, tournament, agent="q-learning", training_id=run["id"])
    # As the clean-up of a demo deletes it after a day without use.
    school.teacher.call("DELETE", f"/trainings/{run['id']}")
    services.of(Rooms).forget(code)
    view = school.ended(tournament)
    assert [entry["name"] for entry in view["entries"]][3] is None
    assert [entry["is_own"] for entry in school.look(tournament, anyone)["entries"]] == [False] * 4
    file = anyone.call("GET", f"/tournaments/{tournament['id']}/file")
    assert name not in file.text
    assert read_file(file.content, "file").entries[3].name == "Entry 3"
    assert verify(read_file(file.content, "file"), workers=1) == []


def test_a_table_enters_whose_practice_is_known(school: Contest) -> None:
    code = school.room(TRAINING_CARD)
    first_pupil, second_pupil = school.joined(code), school.joined(code)
    run = school.finished(first_pupil.call("POST", f"/rooms/{code}/runs").json())
    tournament = school.open(code)
    body = {"agent": "q-learning", "training_id": run["id"]}
    refused(enter(second_pupil, tournament, **body), 422, "no training")
    refused(enter(first_pupil, tournament, **body | {"agent": "sarsa"}), 422, "is of q-learning")
    view = entered(first_pupil, tournament, **body)
    assert (view["training_id"], len(view["entry"]["table"])) == (run["id"], 64)
    entered(first_pupil, tournament, 200, **body)
    entered(school.teacher, tournament, **body)
    teacher = school.teacher
    longer = teacher.finished(teacher.train(steps=61))
    refused(enter(teacher, tournament, agent="q-learning", training_id=longer["id"]), 422, "budget")
    first = teacher.finished(teacher.train(steps=40))
    second = teacher.finished(teacher.train(steps=40, continue_from=first["id"]))
    body = {"agent": "q-learning", "training_id": second["id"]}
    problem_text = "80 steps, with all that it continues"
    problem = refused(enter(teacher, tournament, **body), 422, problem_text)
    assert fields_of(problem) == ["training_id"]
    teacher.call("DELETE", f"/trainings/{first['id']}")
    refused(enter(teacher, tournament, **body), 422, "practice is not known")
    table = teacher.call("GET", f"/trainings/{run['id']}/q-table?format=npz").content
    imported = teacher.call("POST", "/trainings/import", content=table).json()
    body = {"agent": "q-learning", "training_id": imported["id"]}
    refused(enter(teacher, tournament, **body), 422, "was imported")
    teacher.call("DELETE", f"/trainings/{run['id']}")
    ended = school.ended(tournament)
    tables = [entry for entry in ended["entries"] if entry["training_id"] is not None]
    assert [entry["training_id"] for entry in tables] == [run["id"]] * 2
    # The same table on the same draws.
    assert tables[0]["judgements"] == tables[1]["judgements"]
    file = read_file(teacher.call("GET", f"/tournaments/{tournament['id']}/file").content, "file")
    assert list(file.tables) == [view["entry"]["table"]]
    assert verify(file, workers=1) == []
    without = school.open(code, rules={"tables": False})
    body = {"agent": "q-learning", "training_id": longer["id"]}
    refused(enter(teacher, without, **body), 422, "budget")
    short = teacher.finished(teacher.train(steps=10))
    body = {"agent": "q-learning", "training_id": short["id"]}
    problem = refused(enter(teacher, without, **body), 422, "o trained tables enter")
    assert fields_of(problem) == ["training_id"]


def test_robots_of_the_rules_are_in_the_file(school: Contest) -> None:
    teacher = school.teacher
    body = {"name": "Rex", "robot": {"preset": "stiff", "femur_m": 0.09}}
    answer = teacher.call("POST", "/robots", json=body)
    assert answer.status_code == 201, answer.text
    rex = answer.json()["id"]
    tournament = school.open(rules={"robots": [rex, "ant"]})
    view = entered(teacher, tournament, agent="greedy", robot={"id": rex})
    assert view["entry"]["robot"]["id"] == rex
    entered(teacher, tournament, agent="greedy", robot="ant")
    ended = school.ended(tournament)
    assert [len(entry["judgements"]) for entry in ended["entries"]] == [5] * 5
    refused(teacher.call("DELETE", f"/robots/{rex}"), 409, "A tournament uses Rex")
    data = teacher.call("GET", f"/tournaments/{tournament['id']}/file").content
    teacher.call("DELETE", f"/tournaments/{tournament['id']}")
    assert teacher.call("DELETE", f"/robots/{rex}").status_code == 200
    file = read_file(data, "file")
    assert list(file.robots) == [rex]
    assert verify(file, workers=1) == []


@pytest.mark.promises
def test_what_waits_is_withdrawn_or_deleted(school: Contest) -> None:
    tournament = school.open(rules=IN_MUJOCO | {"steps": 50})
    for number in range(4):
        entered(
            school.teacher, tournament, agent="q-learning", settings={"alpha": number / 10 + 0.1}
        )
    ended = school.ended(tournament, withdraw_waiting=True)
    states = [entry["state"] for entry in ended["entries"]]
    assert states[:3] == ["judged"] * 3
    assert "withdrawn" in states[3:]
    assert len(ended["standings"]) == states.count("judged")
    endless = school.open(rules=IN_MUJOCO | {"steps": 200, "draws": 100})
    school.until(endless, lambda view: view["entries"][0]["judged"] > 0)
    path = f"/tournaments/{endless['id']}"
    assert school.teacher.call("DELETE", path).status_code == 200
    refused(school.teacher.call("GET", path), 404, "no tournament")
    refused(school.teacher.call("DELETE", path), 404)
    # The judge goes on with others, and with this one once it is restored.
    assert school.ended(school.open())["state"] == "ended"
    restored = school.teacher.call("POST", f"{path}/restore")
    assert restored.status_code == 200
    judged = restored.json()["entries"][0]["judged"]
    assert judged > 0, "what was judged before is kept"
    school.until(endless, lambda view: view["entries"][0]["judged"] > judged)
    school.teacher.call("DELETE", path)


def test_one_that_was_deleted_comes_back_for_an_hour(
    school: Contest, monkeypatch: pytest.MonkeyPatch
) -> None:
    teacher, tournament = school.teacher, school.ended(school.open())
    others = [teacher.call("POST", "/tournaments", json={"rules": RULES}).json() for _ in "ab"]
    path = f"/tournaments/{tournament['id']}"
    ids = [entry["id"] for entry in teacher.get("/tournaments")["items"]]
    assert ids == [others[1]["id"], others[0]["id"], tournament["id"]]
    file = teacher.call("GET", f"{path}/file").content
    deleted = teacher.call("DELETE", path).json()
    assert (deleted["deleted"], deleted["kept"]) == ([tournament["id"]], [])
    assert datetime.fromisoformat(deleted["restorable_until"]) > datetime.now(UTC)
    refused(teacher.call("GET", f"{path}/file"), 404, "no tournament")
    for _ in range(2):
        restored = teacher.call("POST", f"{path}/restore")
        assert (restored.status_code, restored.json()) == (200, tournament)
    assert [entry["id"] for entry in teacher.get("/tournaments")["items"]] == ids
    assert teacher.call("GET", f"{path}/file").content == file
    refused(school.pupil().call("POST", f"{path}/restore"), 401)

    teacher.call("DELETE", path)
    deletions = school.app.state.services.store.deletions
    monkeypatch.setattr(deletions, "now", lambda: datetime.now(UTC) + timedelta(hours=2))
    refused(teacher.call("POST", f"{path}/restore"), 404, "can be restored for 1 h")
    refused(teacher.call("POST", "/tournaments/none/restore"), 404, "no tournament 'none'")


def test_what_stands_in_the_way_of_an_undo_is_told(
    school: Contest, monkeypatch: pytest.MonkeyPatch
) -> None:
    teacher = school.teacher
    body = {"name": "Rex", "robot": {"preset": "dog", "femur_m": 0.0933}}
    rex = teacher.call("POST", "/robots", json=body).json()["id"]
    tournament = school.open(rules={"gait": "trot", "robots": [{"id": rex}]})
    path = f"/tournaments/{tournament['id']}"
    teacher.call("DELETE", path)
    assert teacher.call("DELETE", f"/robots/{rex}").status_code == 200, "nothing uses it now"
    refused(teacher.call("POST", f"{path}/restore"), 404, "was deleted: restore it first")
    teacher.call("POST", f"/robots/{rex}/restore")
    with monkeypatch.context() as full:
        full.setattr(tournaments, "MAX_OPEN", 0)
        refused(teacher.call("POST", f"{path}/restore"), 429, "end one, and restore this one again")
    assert teacher.call("POST", f"{path}/restore").json()["state"] == "open"
    teacher.call("DELETE", path)
    teacher.call("DELETE", f"/robots/{rex}")


def test_events_tell_of_it_on_the_common_stage_and_the_rooms(school: Contest) -> None:
    services: Services = school.app.state.services
    code = school.room()
    of_room = services.of(RoomStages).of(code)
    assert of_room is not None
    channels = (services.stages[0].channel, of_room.channel)
    streams = [stream.subscribe(names={"tournament"}) for stream in channels]
    tournament = school.open(code)
    entered(school.teacher, tournament, agent="greedy")
    school.ended(tournament)
    for stream in streams:
        newest = stream.drain()[-1]  # those before it were superseded
        event = TypeAdapter(TournamentEvent).validate_json(newest.data)
        assert (event.id, event.state) == (tournament["id"], "ended")
        assert (event.entries, event.judged, event.of) == (1, 20, 20)
    school.teacher.call("DELETE", f"/tournaments/{tournament['id']}")
    for stream in streams:
        (deleted,) = stream.drain()
        assert TypeAdapter(TournamentEvent).validate_json(deleted.data).state == "deleted"
        stream.close()


def test_its_page_and_its_address(school: Contest) -> None:
    tournament = school.open()
    client = school.pupil().client
    address = f"/t/{tournament['id']}"
    assert tournament["address"].endswith(address)
    assert tournament["qr_code"] is None, "phones cannot come to a loopback address"
    page = client.get(address, headers={"Accept": "text/html"})
    assert (page.status_code, page.headers["content-type"]) == (200, "text/html; charset=utf-8")
    assert client.get("/t/none", headers={"Accept": "text/html"}).status_code == 404
    refused(client.get("/t/none"), 404, "no tournament 'none'")
