"""Locks of a classroom: every route as a participant, against every card.

The matrix is generated: routes from the app, cards from the built-in lessons. A participant changes
nothing but by the routes of their own room that the card allows, and by entering its tournaments,
reads no lesson, and sees nothing of another participant's run before the reveal. What a lesson
reveals, and its later cards, nobody reads while a room teaches it, with a cookie or without one.
"""

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

import httpx2
import pytest

from app.features.classroom.access import ParticipantAccess
from app.features.classroom.lesson import Card
from app.features.classroom.lessons import built_in
from app.features.tournaments.access import ENTER_TOURNAMENT
from tests.browser.serving import Serving, serving
from tests.promises.length import at_length
from tests.promises.raw import Route, accesses, every_route, request_lines, send, status_of
from tests.timeouts import LONG_S

TOKEN = "a-token-for-tests"
OPERATOR = f"Authorization: Bearer {TOKEN}"
READS = {"GET", "HEAD"}
CARDS = [
    (lesson_id, number, card)
    for lesson_id, lesson in built_in().items()
    for number, card in enumerate(lesson.deck)
]
DIFFERENT = list({(card[2].ask is None, card[2].go): card for card in CARDS}.values())
"""One card of each kind."""
TRIED = at_length(DIFFERENT, CARDS)
ROOM = "/api/v1/rooms/{code}"
NEEDS = {f"{ROOM}/predictions": "ask", f"{ROOM}/runs": "go", f"{ROOM}/presses": "teach"}
"""By path that is sent to, the field of a card that opens it."""
ENTRIES = "/api/v1/tournaments/{tournament_id}/entries"
ALWAYS = {("POST", f"{ROOM}/participants"), ("DELETE", f"{ROOM}/me"), ("POST", ENTRIES)}
LESSONS = "/api/v1/lessons"


class Desk(NamedTuple):
    """A room with two participants.

    Attributes:
        code: of the room.
        cookie: header of a participant.
        other_run: id of a run of the other one, which is not shown.
        tournament: id of a tournament of the room.
    """

    server: Serving
    code: str
    cookie: str
    other_run: str
    tournament: str

    def call(self, method: str, path: str, *headers: str, body: Any = None) -> bytes:
        """Send a request, and return the answer."""
        content = b"" if body is None else json.dumps(body).encode()
        lines = request_lines(Route(method, path), f"127.0.0.1:{self.server.port}")
        lines = [line for line in lines if not line.startswith("Content-Length")]
        if method not in READS:
            lines += ["Content-Type: application/json", f"Content-Length: {len(content)}"]
        return send(self.server.port, *lines, *headers, body=content)

    def status(self, method: str, path: str, *headers: str, body: Any = None) -> int:
        """Return the status of an answer."""
        return status_of(self.call(method, path, *headers, body=body))

    def teach(self, method: str, path: str, body: Any) -> Any:
        """Send a request of the teacher, and return the body of the answer."""
        answer = self.call(method, path, OPERATOR, body=body)
        assert status_of(answer) < 300, answer
        return json.loads(answer.partition(b"\r\n\r\n")[2])

    def snapshot(self, path: str, header: str) -> str:
        """Return the first event of a stream, a snapshot with the newest runs."""
        name, _, value = header.partition(": ")
        with (
            httpx2.Client(base_url=self.server.address, trust_env=False, verify=False) as client,
            client.stream("GET", path, headers={name: value}) as answer,
        ):
            if answer.status_code == 403:
                return ""
            assert answer.status_code == 200
            return next(line for line in answer.iter_lines() if line.startswith("data: "))

    def own_path(self, path: str) -> str:
        """Return a path with this room, and the other participant's run, in place of parameters."""
        filled = path.replace("{code}", self.code).replace("{run_id}", self.other_run)
        filled = filled.replace("{tournament_id}", self.tournament)
        return filled.replace("{seed}", "0").replace("{lesson_id}", "one-run-proves-nothing")

    def people(self) -> list[dict[str, Any]]:
        """Return all that a participant could change, as the teacher sees it."""
        people = self.teach("GET", f"/api/v1/rooms/{self.code}", None)["people"]
        # The run goes on by itself.
        return [{k: v for k, v in person.items() if k != "run_state"} for person in people]

    def join(self) -> str:
        """Join the room, and return the header of the cookie."""
        answer = self.call("POST", f"/api/v1/rooms/{self.code}/participants", body={})
        assert status_of(answer) == 201
        head = answer.partition(b"\r\n\r\n")[0].decode().split("\r\n")
        cookie = next(line for line in head if line.lower().startswith("set-cookie"))
        return f"Cookie: {cookie.partition(': ')[2].partition(';')[0]}"


def room_of(server: Serving, lesson: Any) -> Desk:
    """Open a room with two participants, of whom the other has run something."""
    desk = Desk(server, "", "", "", "")
    code = desk.teach("POST", "/api/v1/rooms", {"lesson": lesson})["code"]
    desk = desk._replace(code=code)
    other = desk.join()
    cards = built_in()[lesson].deck
    runs = [n for n, card in enumerate(cards) if card.go in ("training", "race")]
    desk.teach("PUT", f"/api/v1/rooms/{code}/card", {"card": runs[0]})
    answer = desk.call("POST", f"/api/v1/rooms/{code}/runs", other, body={})
    assert status_of(answer) == 202, answer
    run = json.loads(answer.partition(b"\r\n\r\n")[2])["id"]
    rules = {"gait": "left-right-origin", "simulator": "kinematic", "draws": 5, "steps": 10}
    opened = desk.teach("POST", "/api/v1/tournaments", {"room": code, "rules": rules})
    return desk._replace(cookie=desk.join(), other_run=run, tournament=opened["id"])


@pytest.fixture(scope="module", params=["public", "token"])
def server(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Serving]:
    """A server where spectators need no token, and one where they do."""
    data = tmp_path_factory.mktemp(request.param)
    with serving(data, token=TOKEN, spectators=request.param) as server:
        yield server


@pytest.fixture(scope="module")
def desks(server: Serving) -> dict[str, Desk]:
    """A room of each lesson whose cards are tried."""
    lessons = dict.fromkeys(lesson_id for lesson_id, _, _ in TRIED)
    return {lesson_id: room_of(server, lesson_id) for lesson_id in lessons}


def may_change(route: Route, card: Card) -> bool:
    """Whether a participant may send to a route while a card is shown."""
    if (route.method, route.path) in ALWAYS:
        return True
    field = NEEDS.get(route.path) if route.method == "POST" else None
    return field is not None and getattr(card, field) is not None


def test_policies_open_to_participants_what_is_listed_here() -> None:
    opened = {
        tuple(route)
        for route, access in accesses().items()
        if not access.is_read
        and (
            isinstance(access, ParticipantAccess)
            or access is ENTER_TOURNAMENT
            or access.spectators == "always"
        )
    }
    # Of runs of their own alone: those of others are hidden.
    watched = ("PUT", f"{ROOM}/runs/{{run_id}}/watched")
    assert opened == ALWAYS | {watched} | {("POST", path) for path in NEEDS}


def test_a_participant_may_do_what_the_card_allows_and_nothing_else(
    server: Serving, desks: dict[str, Desk]
) -> None:
    routes = [
        route for route in every_route() if route.method not in READS and route.path != f"{ROOM}/me"
    ]
    with httpx2.Client(base_url=server.address, trust_env=False, verify=False) as client:
        for lesson, number, card in TRIED:
            desk = desks[lesson]
            desk.teach("PUT", f"/api/v1/rooms/{desk.code}/card", {"card": number})
            before = desk.people()
            name, _, cookie = desk.cookie.partition(": ")
            for route in routes:
                # No valid body: what is allowed gets to the validation of it.
                answer = client.request(
                    route.method, desk.own_path(route.path), headers={name: cookie}, json=[]
                )
                if may_change(route, card):
                    assert answer.status_code in (200, 422), (lesson, number, route)
                else:
                    assert answer.status_code == 403, (lesson, number, route)
            assert desk.people() == before


def test_a_participant_reads_no_lesson_and_no_run_of_others(desks: dict[str, Desk]) -> None:
    for desk in desks.values():
        for route in every_route():
            if route.method not in READS:
                continue
            path = desk.own_path(route.path)
            status = desk.status(route.method, path, desk.cookie)
            if "{run_id}" in route.path or route.path.startswith(LESSONS):
                assert status == 403, route
        for query in (f"/api/v1/runs/curves?id={desk.other_run}", f"/?x={desk.other_run}"):
            assert desk.status("GET", query, desk.cookie) == 403
        for path in ("/api/v1/runs", "/api/v1/trainings", f"/api/v1/rooms/{desk.code}/results"):
            for prefix in ("", f"/r/{desk.code}"):
                answer = desk.call("GET", f"{prefix}{path}", desk.cookie)
                assert desk.other_run.encode() not in answer
        of_room = f"/api/v1/rooms/{desk.code}/events"
        for path in ("/api/v1/events", f"/r/{desk.code}/api/v1/events", of_room):
            assert desk.other_run not in desk.snapshot(path, desk.cookie)
            assert desk.other_run in desk.snapshot(path, OPERATOR)


SECRET = "what-nobody-may-know-yet"
TAUGHT: dict[str, Any] = {
    "title": "A lesson that is taught",
    "cards": [
        {"text": "First", "reveal": {"text": f"{SECRET}-0"}},
        {
            "text": "Second",
            "ask": {"kind": "choice", "text": "Which?", "choices": ["a", "b"]},
            "reveal": {"text": f"{SECRET}-1", "answer": "b"},
        },
        {"title": f"{SECRET}-2", "text": "Third", "ask": {"kind": "number", "text": f"{SECRET}-2"}},
    ],
}


def test_nobody_reads_reveals_and_later_cards_of_a_lesson_that_is_taught(server: Serving) -> None:
    """By no route, without a cookie or with that of a room: operators alone, until it ends."""
    desk = room_of(server, "one-run-proves-nothing")
    lesson_id = desk.teach("POST", LESSONS, TAUGHT)["id"]
    # One room teaches the stored lesson, another one the same document.
    codes = [
        desk.teach("POST", "/api/v1/rooms", {"lesson": lesson})["code"]
        for lesson in (lesson_id, TAUGHT)
    ]
    for code in codes:
        desk.teach("PUT", f"/api/v1/rooms/{code}/card", {"card": 1})
    taught = desk._replace(code=codes[0])
    readers = {"stranger": (), "of another room": (desk.cookie,), "of the room": (taught.join(),)}
    of_lesson = [f"/?lesson={lesson_id}", f"/api/v1/lessons/{lesson_id}?format=yaml"]
    of_lesson += [f"/api/v1/rooms/{codes[0]}/results?card={n}" for n in range(3)]
    for route in every_route():
        if route.method == "GET":
            of_lesson.append(
                taught.own_path(
                    route.path.replace("{lesson_id}", lesson_id).replace("{run_id}", "x")
                )
            )
    assert any(lesson_id in path for path in of_lesson)

    def leaks(*headers: str) -> list[str]:
        prefixes = "", f"/r/{codes[0]}"
        addresses = [f"{prefix}{path}" for path in of_lesson for prefix in prefixes]
        return [
            address
            for address in addresses
            if SECRET.encode() in desk.call("GET", address, *headers)
        ]

    for who, headers in readers.items():
        assert leaks(*headers) == [], who
    address = f"{LESSONS}/{lesson_id}"
    assert SECRET.encode() in desk.call("GET", address, OPERATOR)
    if desk.status("GET", address) == 200:
        shown = json.loads(desk.call("GET", address).partition(b"\r\n\r\n")[2])
        assert [card["text"] for card in shown["cards"]] == ["First", "Second"]
        assert (shown["is_taught"], len(shown["html"])) == (True, 2)
        # While one room of two goes on.
        desk.teach("POST", f"/api/v1/rooms/{codes[0]}/end", None)
        assert SECRET.encode() not in desk.call("GET", address)
        desk.teach("POST", f"/api/v1/rooms/{codes[1]}/end", None)
        assert SECRET.encode() in desk.call("GET", address)


def test_a_participant_reads_the_data_of_the_room(desks: dict[str, Desk]) -> None:
    for desk in desks.values():
        room = f"/r/{desk.code}"
        for path in ("/", "/static/favicon.svg", "/api/v1/stage", "/api/v1/options"):
            assert desk.status("GET", f"{room}{path}", desk.cookie) == 200, path
        for path in ("", "/results"):
            address = f"/api/v1/rooms/{desk.code}{path}"
            assert desk.status("GET", address, desk.cookie) == 200
            assert desk.status("GET", f"{room}{address}", desk.cookie) == 200
        for path in ("/viewer/", "/api/v1/events?picture=true", "/api/v1/events/snapshot"):
            assert desk.status("GET", f"{room}{path}", desk.cookie) == 200, path


def test_another_room_is_closed_to_a_participant(desks: dict[str, Desk]) -> None:
    desk, other_desk = list(desks.values())[:2]
    for path in ("predictions", "runs"):
        address = f"/api/v1/rooms/{other_desk.code}/{path}"
        assert desk.status("POST", address, desk.cookie, body={}) == 403
    address = f"/api/v1/rooms/{other_desk.code}/me"
    assert desk.status("DELETE", address, desk.cookie, body={}) == 403


def test_a_tournament_is_for_its_room_alone(desks: dict[str, Desk]) -> None:
    first, second = list(desks.values())[:2]
    path = f"/api/v1/tournaments/{first.tournament}"
    body = {"agent": "greedy"}
    for read in (path, f"/r/{first.code}{path}", f"/t/{first.tournament}", "/api/v1/tournaments"):
        assert first.status("GET", read, first.cookie) == 200, read
    assert first.status("POST", f"{path}/entries", first.cookie, body=body) == 202
    assert first.status("POST", f"{path}/entries", first.cookie, body=body) == 200
    assert second.status("GET", path, second.cookie) == 403
    assert second.status("POST", f"{path}/entries", second.cookie, body=body) == 403
    listed = second.call("GET", "/api/v1/tournaments", second.cookie)
    assert first.tournament.encode() not in listed
    for desk in (first, second):
        assert desk.status("POST", f"{path}/end", desk.cookie, body={}) == 403
        assert desk.status("DELETE", path, desk.cookie) == 403
    assert first.status("POST", f"{path}/entries", body=body) == 401
    view = first.teach("GET", path, None)
    assert (view["state"], len(view["entries"])) == ("open", 4)


def test_after_the_reveal_others_are_seen(server: Serving) -> None:
    lesson = next(iter(built_in()))
    desk = room_of(server, lesson)
    number = next(n for n, card in enumerate(built_in()[lesson].deck) if card.go == "training")
    path = f"/r/{desk.code}/api/v1/trainings/{desk.other_run}"
    assert desk.status("GET", path, desk.cookie) == 403
    desk.teach("POST", f"/api/v1/rooms/{desk.code}/reveal", {"card": number})
    assert desk.status("GET", path, desk.cookie) == 200
    results = desk.call("GET", f"/api/v1/rooms/{desk.code}/results?card={number}", desk.cookie)
    assert desk.other_run.encode() in results


def test_events_report_only_the_participants_own_runs(server: Serving) -> None:
    desk = room_of(server, "one-run-proves-nothing")
    other, path = desk.join(), f"/api/v1/rooms/{desk.code}/runs"

    def start(cookie: str) -> str:
        answer = desk.call("POST", path, cookie, body={})
        return str(json.loads(answer.partition(b"\r\n\r\n")[2])["id"])

    name, _, value = desk.cookie.partition(": ")
    with (
        httpx2.Client(
            base_url=server.address, trust_env=False, verify=False, timeout=LONG_S
        ) as client,
        client.stream("GET", f"/r/{desk.code}/api/v1/events", headers={name: value}) as answer,
    ):
        lines = answer.iter_lines()
        assert "snapshot" in next(lines)
        runs = start(other), start(desk.cookie)
        received = []
        for line in lines:
            received.append(line)
            data = json.loads(line.removeprefix("data: ")) if line.startswith("data: {") else {}
            if (data.get("id"), data.get("state")) == (runs[1], "finished"):
                break
    assert not [line for line in received if runs[0] in line]
    assert any(line == "event: room" for line in received)
