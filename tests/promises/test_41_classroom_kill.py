"""A server that is killed in the middle of a lesson goes on with it: nothing that counted is lost.

Ten kills at random moments, 3 in the gate: while pupils join, answer, start and wait, and while the
teacher turns pages. Each client repeats what was not acknowledged, as a page does.
"""

import random
import signal
import threading
import time
from collections.abc import Callable
from typing import Any

import httpx2
import pytest

from app.api.cookies import ROOM_NAME
from tests.promises.length import at_length
from tests.served import Served
from tests.timeouts import LONG_S, ProgressTimeout

KILLS = at_length(3, 10)
PUPILS = 3
FORM = {"gait": "left-right-origin", "simulator": "mujoco", "steps": 150, "evaluate_every": 50}
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


@pytest.mark.timeout(60 * KILLS + 300)
def test_a_lesson_goes_on_after_kills(launch: Callable[..., Served]) -> None:
    chance = random.Random(41)
    school = School(launch)
    teacher = Client(school)
    code = teacher.call("POST", "/rooms", {"lesson": LESSON}).json()["code"]
    room = f"/rooms/{code}"
    pupils = [Client(school) for _ in range(PUPILS)]
    known: dict[int, dict[str, Any]] = {}
    runs: dict[int, str] = {}
    facts: dict[str, Any] = {"card": 0, "state": "open", "revealed": []}

    def join(number: int) -> None:
        answer = pupils[number].call("POST", f"{room}/participants", {})
        assert answer.status_code in (200, 201), answer.text
        known[number] = answer.json()

    def predict(number: int) -> None:
        body = {"card": 1, "value": number / 10}
        answer = pupils[number].call("POST", f"{room}/predictions", body)
        # 409: the answer was kept, and its acknowledgement lost.
        assert answer.status_code in (201, 409), answer.text

    def start(number: int) -> None:
        answer = pupils[number].call("POST", f"{room}/runs", {})
        assert answer.status_code == 202, answer.text
        runs[number] = answer.json()["id"]

    def teach(method: str, path: str, body: Any, **changes: Any) -> None:
        answer = teacher.call(method, room + path, body)
        assert answer.status_code == 200, answer.text
        facts.update(changes)

    def check() -> None:
        view = teacher.get(room)
        assert {name: view[name] for name in facts} == facts
        for number, who in known.items():
            own = pupils[number].get(room)
            assert own["role"] == "participant"
            assert (own["me"]["name"], own["me"]["seed"]) == (who["name"], who["seed"])
            if number in runs:
                assert [one["run_id"] for one in own["me"]["runs"]] == [runs[number]]
                value = {"card": 1, "value": number / 10}
                assert own["me"]["predictions"] == [value]

    numbers = range(PUPILS)
    deeds: list[Callable[[], None]] = [
        *(lambda n=n: join(n) for n in numbers),
        lambda: teach("PUT", "/card", {"card": 1}, card=1),
        *(lambda n=n: predict(n) for n in numbers),
        *(lambda n=n: start(n) for n in numbers),
        lambda: time.sleep(0.5),
        lambda: teach("POST", "/freeze", {}, state="frozen"),
        lambda: teach("POST", "/freeze", {"frozen": False}, state="open"),
        lambda: teach("POST", "/reveal", {}, revealed=[1]),
    ]
    moments = set(chance.sample(range(len(deeds)), KILLS))
    for moment, deed in enumerate(deeds):
        if moment in moments:
            school.killed_during(deed, chance.uniform(0, 0.1))
        else:
            deed()
        check()
    assert school.kills == KILLS

    stall_check = ProgressTimeout()
    while (result := teacher.get(f"{room}/results?card=1")["cards"][0])["finished"] < PUPILS:
        stall_check.check(result)
        time.sleep(0.2)
    found = {entry["seed"]: entry for entry in result["entries"] if entry["run"] is not None}
    assert len(found) == PUPILS
    for number, who in known.items():
        entry = found[who["seed"]]
        assert (entry["prediction"], entry["run"]["id"]) == (number / 10, runs[number])
        # As if nothing had happened.
        body = {**FORM, "seed": who["seed"]}
        unbroken = teacher.call("POST", "/trainings", body).json()
        ended = school.served.in_state(unbroken, "finished")
        assert ended["result"]["distance_m"] == entry["run"]["distance_m"]
