"""A server that is killed in the middle of a lesson goes on with it: nothing that counted is lost.

Ten kills at random moments, 2 in the gate: while pupils join, answer, start and wait, and while the
teacher turns pages. Each client repeats what was not acknowledged, as a page does.
"""

import random
import signal
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import httpx2
import pytest

from app.features.classroom.access import ROOM_NAME
from tests.promises.length import at_length
from tests.served import Served
from tests.timeouts import LONG_S, ProgressTimeout

KILLS = at_length(2, 10)
PUPILS = 3
COMPARED = at_length(1, PUPILS)
"""Number of pupils whose runs are compared with unbroken ones."""
STEPS = at_length(60, 150)
FORM = {
    "gait": "left-right-origin",
    "simulator": "mujoco",
    "steps": STEPS,
    "evaluate_every": STEPS // 3,
}
LESSON: dict[str, Any] = {
    "title": "Killed",
    "cards": [
        {"text": "Look."},
        {
            "text": "Guess.",
            "state": {"form": FORM},
            "ask": {"kind": "number", "text": "How far?"},
            "go": "training",
        },
    ],
}


class Client:
    """A client that keeps its cookie, and repeats what was not acknowledged.

    The name of the cookie has the port of the server, which is another one after each kill here.
    """

    def __init__(self, school: "School") -> None:
        self._school = school
        self._cookie = ("", "")

    def call(self, method: str, path: str, body: Any = None) -> httpx2.Response:
        """Send a request until a server has answered it."""
        while True:
            served = self._school.served
            try:
                with httpx2.Client(
                    base_url=f"{served.address}/api/v1",
                    headers={"Cookie": self._cookie_of(served)},
                    timeout=LONG_S,
                    trust_env=False,
                    verify=False,
                ) as client:
                    answer = client.request(method, path, json=body)
                    for name, value in client.cookies.items():
                        self._cookie = (name.rpartition("_")[2], value)
            except httpx2.TransportError:
                self._school.start_again(served)
                continue
            if answer.status_code != 503:
                return answer

    def _cookie_of(self, served: Served) -> str:
        port, (code, key) = served.address.rpartition(":")[2], self._cookie
        return f"{ROOM_NAME}_{port}_{code}={key}" if key else "x=y"

    def get(self, path: str) -> Any:
        answer = self.call("GET", path)
        assert answer.status_code == 200, answer.text
        return answer.json()


class School:
    """Servers one after another on the same data and port."""

    def __init__(self, launch: Callable[..., Served]) -> None:
        self._launch = launch
        self.served = launch()
        self.kills = 0

    def start_again(self, dead: Served) -> None:
        """Start another server after the end of one."""
        dead.process.wait(LONG_S)
        if self.served is dead:
            dead.end(signal.SIGKILL)
            self.served = self._launch()

    def killed_during(self, deed: Callable[[], None], after_s: float) -> None:
        """Do something while the server is killed."""
        served = self.served
        timer = threading.Timer(after_s, served.process.send_signal, [signal.SIGKILL])
        timer.start()
        deed()
        timer.join()
        self.start_again(served)
        self.kills += 1


class Class:
    """A room, its teacher and pupils, and all that was acknowledged.

    Attributes:
        joined: name and seed of each pupil who has joined.
        runs: id of each pupil's run.
        facts: what the room says of itself.
    """

    def __init__(self, school: School) -> None:
        self.school, self.teacher = school, Client(school)
        code = self.teacher.call("POST", "/rooms", {"lesson": LESSON}).json()["code"]
        self.room = f"/rooms/{code}"
        self.pupils = [Client(school) for _ in range(PUPILS)]
        self.joined: dict[int, dict[str, Any]] = {}
        self.runs: dict[int, str] = {}
        self.facts: dict[str, Any] = {"card": 0, "state": "open", "revealed": []}

    def join(self, number: int) -> None:
        answer = self.pupils[number].call("POST", f"{self.room}/participants", {})
        assert answer.status_code in (200, 201), answer.text
        self.joined[number] = answer.json()

    def predict(self, number: int) -> None:
        body = {"card": 1, "value": number / 10}
        answer = self.pupils[number].call("POST", f"{self.room}/predictions", body)
        # 409: the answer was kept, and its acknowledgement lost.
        assert answer.status_code in (201, 409), answer.text

    def start(self, number: int) -> None:
        answer = self.pupils[number].call("POST", f"{self.room}/runs", {})
        assert answer.status_code == 202, answer.text
        self.runs[number] = answer.json()["id"]

    def teach(self, method: str, path: str, body: Any, **changes: Any) -> None:
        answer = self.teacher.call(method, self.room + path, body)
        assert answer.status_code == 200, answer.text
        self.facts.update(changes)

    def check(self) -> None:
        """Check that nothing that was acknowledged is lost."""
        view = self.teacher.get(self.room)
        assert {name: view[name] for name in self.facts} == self.facts
        for number, who in self.joined.items():
            view_of_pupil = self.pupils[number].get(self.room)
            assert view_of_pupil["role"] == "participant"
            assert (view_of_pupil["me"]["name"], view_of_pupil["me"]["seed"]) == (
                who["name"],
                who["seed"],
            )
            if number in self.runs:
                assert [run["run_id"] for run in view_of_pupil["me"]["runs"]] == [self.runs[number]]
                assert view_of_pupil["me"]["predictions"] == [{"card": 1, "value": number / 10}]

    def deeds(self) -> list[Callable[[], None]]:
        """Return a lesson, deed by deed."""
        numbers = range(PUPILS)
        return [
            *(partial(self.join, number) for number in numbers),
            partial(self.teach, "PUT", "/card", {"card": 1}, card=1),
            *(partial(self.predict, number) for number in numbers),
            *(partial(self.start, number) for number in numbers),
            partial(time.sleep, 0.5),
            partial(self.teach, "POST", "/freeze", {}, state="frozen"),
            partial(self.teach, "POST", "/freeze", {"frozen": False}, state="open"),
            partial(self.teach, "POST", "/reveal", {}, revealed=[1]),
        ]

    def results(self) -> dict[int, dict[str, Any]]:
        """Return the results of all pupils by seed, once their runs have finished."""
        stall_check, path = ProgressTimeout(), f"{self.room}/results?card=1"
        while (result := self.teacher.get(path)["cards"][0])["finished"] < PUPILS:
            stall_check.check(result)
            time.sleep(0.2)
        return {entry["seed"]: entry for entry in result["entries"] if entry["run"] is not None}


@pytest.mark.timeout(60 * KILLS + 300)
def test_a_lesson_goes_on_after_kills(launch: Callable[..., Served]) -> None:
    chance = random.Random(41)
    school = School(launch)
    taught = Class(school)
    deeds = taught.deeds()
    moments = set(chance.sample(range(len(deeds)), KILLS))
    for moment, deed in enumerate(deeds):
        if moment in moments:
            school.killed_during(deed, chance.uniform(0, 0.1))
        else:
            deed()
        taught.check()
    assert school.kills == KILLS
    results = taught.results()
    assert len(results) == PUPILS
    for number, who in taught.joined.items():
        entry = results[who["seed"]]
        assert (entry["prediction"], entry["run"]["id"]) == (number / 10, taught.runs[number])
        if number >= COMPARED:
            continue
        # As if nothing had happened.
        unbroken = taught.teacher.call("POST", "/trainings", {**FORM, "seed": who["seed"]}).json()
        ended = school.served.in_state(unbroken, "finished")
        assert ended["result"]["distance_m"] == entry["run"]["distance_m"]
