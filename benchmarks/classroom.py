"""Load by a class: `python benchmarks/classroom.py http://127.0.0.1:8000 --token … --pupils 40`.

Opens rooms of a server that runs on this machine, and lets pupils join, follow the events, load the
room, answer and start, over a poor network: of a share of requests the answer is lost, so that it
is sent again, and streams are dropped. Prints one JSON object: how long each deed took [s], and
what was lost at the end, which is promised to be nothing.
"""

import argparse
import http.client
import json
import random
import statistics
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

_TIMEOUT_S = 120.0
_DROPPED_AFTER_S = (5.0, 15.0)
_LESSON, _CARD = "one-run-proves-nothing", 1
_PATIENCE_S = 600.0


class Client:
    """A client that repeats what it got no answer to.

    Attributes:
        cookie: of the room, once it has joined.
        lost: how many answers were lost.
    """

    def __init__(self, address: str, token: str = "", loss: float = 0.0, seed: int = 0) -> None:
        """Create it; `loss` is the share of answers that are lost."""
        self._address, self._token = urlsplit(address), token
        self._loss, self._chance = loss, random.Random(seed)
        self.cookie, self.lost = "", 0
        self.took_s: defaultdict[str, list[float]] = defaultdict(list)

    def call(self, deed: str, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """Send a request until there is an answer to it; return its status and its body."""
        began_s = time.perf_counter()
        while True:
            connection = http.client.HTTPConnection(self._address.netloc, timeout=_TIMEOUT_S)
            try:
                connection.request(method, f"/api/v1{path}", *self._content(body))
                if self._chance.random() < self._loss:
                    self.lost += 1
                    time.sleep(0.3)
                    continue
                answer = connection.getresponse()
                cookie, content = answer.getheader("Set-Cookie"), answer.read()
            finally:
                connection.close()
            if cookie:
                self.cookie = cookie.partition(";")[0]
            self.took_s[deed].append(time.perf_counter() - began_s)
            return answer.status, json.loads(content) if content else None

    def follow(self, path: str, until: threading.Event) -> int:
        """Follow a stream of events, which is dropped again and again; return how often it was."""
        drops = 0
        while not until.is_set():
            connection = http.client.HTTPConnection(self._address.netloc, timeout=_TIMEOUT_S)
            connection.request("GET", f"/api/v1{path}", headers=self._headers())
            stream, drop_s = connection.getresponse(), self._chance.uniform(*_DROPPED_AFTER_S)
            until_s = time.perf_counter() + drop_s
            while time.perf_counter() < until_s and not until.is_set():
                if not stream.readline():
                    break
            connection.close()
            drops += 1
        return drops

    def _headers(self) -> dict[str, str]:
        headers = {"X-Requested-With": "benchmark"}
        if self._token:
            headers["Authorization"] = f"Bearer {self._token}"
        return headers | ({"Cookie": self.cookie} if self.cookie else {})

    def _content(self, body: Any) -> tuple[bytes | None, dict[str, str]]:
        if body is None:
            return None, self._headers()
        return json.dumps(body).encode(), {**self._headers(), "Content-Type": "application/json"}


def attend(pupil: Client, room: str, number: int, until: threading.Event) -> dict[str, Any]:
    """Go through a card as a pupil; return what was acknowledged, and what was there at the end."""
    _, who = pupil.call("join", "POST", f"{room}/participants", {})
    drops: list[int] = []
    follower = threading.Thread(target=lambda: drops.append(pupil.follow(f"{room}/events", until)))
    follower.start()
    pupil.call("load", "GET", room)
    value = round(number / 100, 2)
    pupil.call("answer", "POST", f"{room}/predictions", {"card": _CARD, "value": value})
    began_s = time.perf_counter()
    _, run = pupil.call("start", "POST", f"{room}/runs", {})
    state = ""
    while state != "finished" and time.perf_counter() - began_s < _PATIENCE_S:
        time.sleep(1.0)
        _, results = pupil.call("results", "GET", f"{room}/results?card={_CARD}")
        own = next(one for one in results["cards"][0]["entries"] if one["is_own"])
        state = own["run"]["state"] if own["run"] else ""
    pupil.took_s["run"].append(time.perf_counter() - began_s)
    until.wait()
    follower.join()
    _, view = pupil.call("load", "GET", room)
    return {
        "seed": view["me"] is not None and view["me"]["seed"] == who["seed"],
        "answer": view["me"]["predictions"] == [{"card": _CARD, "value": value}],
        "run": state == "finished" and view["me"]["runs"][0]["run_id"] == run["id"],
        "drops": sum(drops),
    }


def main() -> None:
    """Run the benchmark by its options."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("address")
    parser.add_argument("--token", default="")
    parser.add_argument("--pupils", type=int, default=40)
    parser.add_argument("--rooms", type=int, default=2)
    parser.add_argument("--loss", type=float, default=0.05)
    options = parser.parse_args()
    teacher, rooms = Client(options.address, options.token), []
    for _ in range(options.rooms):
        _, room = teacher.call("open", "POST", "/rooms", {"lesson": _LESSON})
        rooms.append(f"/rooms/{room['code']}")
        teacher.call("show", "PUT", f"{rooms[-1]}/card", {"card": _CARD})
    until, found = threading.Event(), list[dict[str, Any]]()
    pupils = [Client(options.address, "", options.loss, n) for n in range(options.pupils)]
    attending: list[Callable[[], None]] = [
        lambda n=n, pupil=pupil: found.append(attend(pupil, rooms[n % len(rooms)], n, until))
        for n, pupil in enumerate(pupils)
    ]
    threads = [threading.Thread(target=one) for one in attending]
    began_s = time.perf_counter()
    for thread in threads:
        thread.start()
    while sum(len(pupil.took_s["run"]) for pupil in pupils) < len(pupils):
        time.sleep(0.5)
        if time.perf_counter() - began_s > _PATIENCE_S:
            break
    for room in rooms:
        teacher.call("reveal", "POST", f"{room}/reveal", {"card": _CARD})
    until.set()
    for thread in threads:
        thread.join()
    for room in rooms:
        teacher.call("end", "POST", f"{room}/end", {})
    took: defaultdict[str, list[float]] = defaultdict(list)
    for client in (*pupils, teacher):
        for deed, each in client.took_s.items():
            took[deed] += each
    print(
        json.dumps(
            {
                "pupils": len(pupils),
                "rooms": len(rooms),
                "answers_lost_on_the_way": sum(pupil.lost for pupil in pupils),
                "streams_dropped": sum(one["drops"] for one in found),
                **{
                    f"{what}s_lost": len(pupils) - sum(bool(one[what]) for one in found)
                    for what in ("seed", "answer", "run")
                },
                "seconds": {
                    deed: {"median": round(statistics.median(each), 3), "most": round(max(each), 3)}
                    for deed, each in took.items()
                },
            }
        )
    )


if __name__ == "__main__":
    main()
