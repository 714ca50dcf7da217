"""A class over a network: `python benchmarks/classroom.py http://10.77.0.1:8000 --token …`.

Opens rooms, and lets pupils do what the page of a room does: load it with its files, join, follow
the events, answer, start, replay the own robot, and look at the results; and watch the room's
stage beside it. Every pupil loses all connections once a minute. `poor_network.py` makes a network
with losses and delays.

Prints one JSON object: what was lost, which is promised to be nothing; the frames of the stage a
second that each pupil gets while a run is in the spotlight, which are promised to be 25 or more;
how long each deed took [s]; and with `--server PID` the cores and the memory of the server's
processes. With `--limits` it tells instead what is refused: the 17th room, the 49th join at once,
and the 65th participant.
"""

import argparse
import asyncio
import json
import os
import random
import re
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Awaitable, Callable, Coroutine
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import urljoin, urlsplit

import httpx2

_LESSON, _CARD = "one-run-proves-nothing", 2
_FILE = re.compile(r'(?:href|src)="([^"]+\.(?:js|css|svg))"')
_AT_ONCE = 6
"""Connections of a browser to a server."""
_TIMEOUT_S = 60.0
_ARRIVE_WITHIN_S = 10.0
_PATIENCE_S = 900.0
_REPLAY_LEVEL, _SEGMENTS = 1, 6
_EVENT_RETRY_S, _AGAIN_S = 1.0, 1.0
_HEADERS = {"X-Requested-With": "hexapods", "Accept-Encoding": "gzip"}


class Phone:
    """A browser that repeats what it gets no answer to, and is offline now and then.

    Attributes:
        took_s: how long each deed took, by its name.
        frames: times at which frames of the stage came, and how many.
        size_bytes: of the events with them.
        drops: how often all connections were lost.
    """

    def __init__(self, address: str, room: str, number: int) -> None:
        """Create it for a room, by its code."""
        self._address, self._room = address, room
        self._chance = random.Random(number)
        self._cookies = httpx2.Cookies()
        self._client = self._new_client()
        self._ongoing: set[asyncio.Task[Any]] = set()
        self._is_online = asyncio.Event()
        self._is_online.set()
        self._changed = asyncio.Event()
        self._texts: dict[str, str] = {}
        self.took_s: defaultdict[str, list[float]] = defaultdict(list)
        self.frames: list[tuple[float, int]] = []
        self.size_bytes = 0
        self.drops = 0

    def _new_client(self) -> httpx2.AsyncClient:
        limits = httpx2.Limits(max_connections=_AT_ONCE + 2)
        return httpx2.AsyncClient(
            base_url=self._address, cookies=self._cookies, limits=limits, timeout=_TIMEOUT_S,
            headers=_HEADERS, trust_env=False,
        )  # fmt: skip

    async def attend(self, until: asyncio.Event, dropped_every_s: float) -> dict[str, Any]:
        """Go through the card; return what of it was still there at the end."""
        path = f"/api/v1/rooms/{self._room}"
        await asyncio.sleep(self._chance.uniform(0, _ARRIVE_WITHIN_S))
        following = [asyncio.create_task(self._be_dropped(dropped_every_s))]
        try:
            await self._timed("load the page", self._load_page())
            key = f"{self._chance.getrandbits(128):032x}"
            who = await self.call("join", "POST", f"{path}/participants", {}, key)
            following += [
                asyncio.create_task(self._follow_events(f"{path}/events")),
                asyncio.create_task(self._watch_stage()),
            ]
            await self.call("see the room", "GET", path)
            await self._timed("load the picture", self._get(f"/r/{self._room}/viewer/"))
            value = round(self._chance.uniform(0, 0.6), 2)
            answer = {"card": _CARD, "value": value}
            stored_answer = await self.call("answer", "POST", f"{path}/predictions", answer)
            began_s = time.monotonic()
            run = await self.call("start", "POST", f"{path}/runs", {"settings": {}, "card": _CARD})
            await self._finished(path)
            self.took_s["run"].append(time.monotonic() - began_s)
            await self._timed("replay", self._replay(run["id"]))
            await until.wait()
            results = await self.call("results", "GET", f"{path}/results?card={_CARD}")
            view = await self.call("see the room", "GET", path)
        finally:
            for task in following:
                task.cancel()
            await asyncio.gather(*following, return_exceptions=True)
            await self._client.aclose()
        own_entry = next(
            (entry for entry in results["cards"][0]["entries"] if entry["is_own"]), None
        )
        me = view["me"]
        is_refused = "detail" in stored_answer and "already" not in stored_answer["detail"]
        return {
            "seed": me is not None and (me["seed"], me["name"]) == (who["seed"], who["name"]),
            "answer": not is_refused and me is not None and me["predictions"] == [answer],
            "run": own_entry is not None and own_entry["run"] is not None
            and own_entry["run"]["id"] == run["id"]
            and own_entry["run"]["distance_m"] is not None,
        }  # fmt: skip

    async def call(
        self, deed: str, method: str, path: str, body: Any = None, key: str = ""
    ) -> dict[str, Any]:
        """Send a request until an answer comes; return its JSON."""
        headers = {"Idempotency-Key": key} if key else {}
        response = await self._timed(deed, self._send(method, path, body, headers))
        answer: dict[str, Any] = response.json()
        return answer

    async def _get(self, path: str) -> httpx2.Response:
        return await self._send("GET", path, None, {})

    async def _send(
        self, method: str, path: str, body: Any, headers: dict[str, str]
    ) -> httpx2.Response:
        while True:
            response = await self._tried(
                lambda: self._client.request(method, path, json=body, headers=headers)
            )
            if response is not None and response.status_code not in (429, 503):
                self._cookies.update(response.cookies)
                return response
            await asyncio.sleep(_AGAIN_S)

    async def _tried(
        self, send: Callable[[], Coroutine[Any, Any, httpx2.Response]]
    ) -> httpx2.Response | None:
        """Return the answer to a request; None if the connection was lost."""
        await self._is_online.wait()
        task = asyncio.create_task(send())
        self._ongoing.add(task)
        try:
            await asyncio.wait([task])
        finally:
            task.cancel()
            self._ongoing.discard(task)
        if task.cancelled() or isinstance(task.exception(), httpx2.TransportError):
            return None
        return task.result()

    async def _timed(self, deed: str, work: Awaitable[Any]) -> Any:
        began_s = time.monotonic()
        result = await work
        self.took_s[deed].append(time.monotonic() - began_s)
        return result

    async def _load_page(self) -> None:
        address = f"/r/{self._room}"
        page = await self._get(address)
        files = dict.fromkeys(urljoin(address, file) for file in _FILE.findall(page.text))
        await asyncio.gather(*map(self._get, files), self._get("/api/v1/options"))

    async def _finished(self, path: str) -> None:
        """Ask for the own result whenever an event tells of a change, until it is there."""
        while True:
            answer = await self.call("results", "GET", f"{path}/results?card={_CARD}")
            own_entry = next(
                (entry for entry in answer["cards"][0]["entries"] if entry["is_own"]), None
            )
            if (
                own_entry is not None
                and own_entry["run"] is not None
                and own_entry["run"]["state"] == "finished"
            ):
                return
            self._changed.clear()
            with suppress(TimeoutError):
                await asyncio.wait_for(self._changed.wait(), 30)

    async def _replay(self, run_id: str) -> None:
        path = f"/api/v1/runs/{run_id}/replay"
        await asyncio.gather(self._get(path), self._get(f"{path}/scene"))
        for number in range(_SEGMENTS):
            await self._get(f"{path}/segments/{_REPLAY_LEVEL}/{number}")

    async def _follow_events(self, path: str) -> None:
        while True:
            with suppress(httpx2.HTTPError, RuntimeError):
                await self._is_online.wait()
                async with self._client.stream("GET", path, timeout=None) as stream:
                    async for line in stream.aiter_lines():
                        if '"finished"' in line:
                            self._changed.set()
            await asyncio.sleep(_EVENT_RETRY_S)

    async def _watch_stage(self) -> None:
        path = f"/r/{self._room}/api/v1/events?picture=true"
        while True:
            with suppress(httpx2.HTTPError, RuntimeError):
                await self._is_online.wait()
                async with self._client.stream("GET", path, timeout=None) as stream:
                    event = ""
                    async for line in stream.aiter_lines():
                        field, _, value = line.partition(": ")
                        if field == "event":
                            event = value
                        elif field == "data" and event == "piece":
                            self.size_bytes += len(line)
                            self.frames.append((time.monotonic(), json.loads(value)["count"]))
            await asyncio.sleep(_EVENT_RETRY_S)

    async def _be_dropped(self, every_s: float) -> None:
        """Lose all connections every so often, for one to three seconds."""
        await asyncio.sleep(self._chance.uniform(0.2, 1.0) * every_s)
        while True:
            self.drops += 1
            self._is_online.clear()
            for task in self._ongoing:
                task.cancel()
            client, self._client = self._client, self._new_client()
            await client.aclose()
            await asyncio.sleep(self._chance.uniform(1.0, 3.0))
            self._is_online.set()
            await asyncio.sleep(every_s)


class Teacher:
    """The operator, whose requests are lost as those of others are."""

    def __init__(self, address: str, token: str) -> None:
        """Create it."""
        headers = {**_HEADERS, "Authorization": f"Bearer {token}"}
        self._client = httpx2.AsyncClient(
            base_url=address, headers=headers, timeout=_TIMEOUT_S, trust_env=False
        )

    async def call(self, method: str, path: str, body: Any = None) -> Any:
        """Send a request, and return the JSON of its answer.

        Raises:
            httpx2.HTTPStatusError: if it was refused.
        """
        while True:
            # As the page does where a connection was closed in between.
            with suppress(httpx2.TransportError):
                answer = await self._client.request(method, path, json=body)
                break
        answer.raise_for_status()
        return answer.json()

    async def keep_in_motion(self, code: str) -> None:
        """Play the run in the spotlight in real time, from its beginning again and again."""
        await self.call("PUT", f"/r/{code}/api/v1/stage", {"time_s": 0, "speed": 1})
        while True:
            with suppress(httpx2.HTTPError):
                stage = await self.call("GET", f"/r/{code}/api/v1/stage")
                if stage["ended"] or not stage["playing"]:
                    body = {"time_s": 0, "playing": True, "speed": 1}
                    await self.call("PUT", f"/r/{code}/api/v1/stage", body)
            await asyncio.sleep(1.0)


async def measure(options: argparse.Namespace) -> dict[str, Any]:
    """Teach the rooms, and return what is reported."""
    teacher = Teacher(options.address, options.token)
    codes = []
    for _ in range(options.rooms):
        code = (await teacher.call("POST", "/api/v1/rooms", {"lesson": _LESSON}))["code"]
        await teacher.call("PUT", f"/api/v1/rooms/{code}/card", {"card": _CARD})
        codes.append(code)
    until, meter = asyncio.Event(), Meter(options.server)
    phones = [Phone(options.address, codes[n % len(codes)], n) for n in range(options.pupils)]
    attending = [
        asyncio.create_task(phone.attend(until, options.dropped_every)) for phone in phones
    ]
    began_s, began_cpu_s = time.monotonic(), meter.cpu_s()
    await _all_finished(phones)
    lesson_s, lesson_cpu_s = time.monotonic() - began_s, meter.cpu_s() - began_cpu_s
    showing = []
    for code in codes:
        (card,) = (await teacher.call("GET", f"/api/v1/rooms/{code}/results?card={_CARD}"))["cards"]
        run_id = next(entry["run"]["id"] for entry in card["entries"] if entry["run"])
        await teacher.call("PUT", f"/api/v1/rooms/{code}/spotlight", {"run_id": run_id})
        showing.append(asyncio.create_task(teacher.keep_in_motion(code)))
    await asyncio.sleep(5.0)
    lit_s, lit_cpu_s = time.monotonic(), meter.cpu_s()
    bytes_before = sum(phone.size_bytes for phone in phones)
    await asyncio.sleep(options.watch)
    watched_s, watched_cpu_s = time.monotonic() - lit_s, meter.cpu_s() - lit_cpu_s
    size_bytes = sum(phone.size_bytes for phone in phones) - bytes_before
    for task in showing:
        task.cancel()
    for code in codes:
        await teacher.call("POST", f"/api/v1/rooms/{code}/reveal", {"card": _CARD})
    until.set()
    card = await asyncio.gather(*attending)
    for code in codes:
        await teacher.call("POST", f"/api/v1/rooms/{code}/end")
    rates = [
        sum(count for at_s, count in phone.frames if lit_s <= at_s < lit_s + watched_s) / watched_s
        for phone in phones
    ]
    took: defaultdict[str, list[float]] = defaultdict(list)
    for phone in phones:
        for deed, each in phone.took_s.items():
            took[deed] += each
    return {
        "pupils": len(phones),
        "rooms": len(codes),
        "drops": sum(phone.drops for phone in phones),
        **{
            f"{what}s_lost": sum(not observation[what] for observation in card)
            for what in ("seed", "answer", "run")
        },
        "frames_per_s": {
            "median": round(statistics.median(rates), 1),
            "lowest": round(min(rates), 1),
            "below_25": sum(rate < 25 for rate in rates),
        },
        "kB_per_s_each": round(size_bytes / watched_s / len(phones) / 1e3, 1),
        "seconds": {
            deed: {"median": round(statistics.median(each), 2), "most": round(max(each), 2)}
            for deed, each in took.items()
        },
        "server": {
            "lesson_s": round(lesson_s, 1),
            "lesson_cores": round(lesson_cpu_s / lesson_s, 2),
            "watching_cores": round(watched_cpu_s / watched_s, 2),
            "memory_MB": round(meter.memory_bytes() / 1e6),
        },
    }


async def _all_finished(phones: list[Phone]) -> None:
    began_s = time.monotonic()
    while any(not phone.took_s["replay"] for phone in phones):
        if time.monotonic() - began_s > _PATIENCE_S:
            raise RuntimeError("not all runs have finished")
        await asyncio.sleep(0.5)


async def limits(options: argparse.Namespace) -> dict[str, Any]:
    """Return the status and the words by which more than the limits is refused."""
    teacher, refused = Teacher(options.address, options.token), {}
    codes: list[str] = []
    try:
        while True:
            codes.append((await teacher.call("POST", "/api/v1/rooms", {}))["code"])
    except httpx2.HTTPStatusError as error:
        refused[f"room {len(codes) + 1}"] = _refusal(error.response)
    join = f"/api/v1/rooms/{codes[0]}/participants"
    joined, last_wait_s = 0, 0
    while True:
        async with httpx2.AsyncClient(base_url=options.address, trust_env=False) as stranger:
            answer = await stranger.post(join, json={}, headers=_HEADERS)
        if answer.status_code == httpx2.codes.CREATED:
            joined += 1
            continue
        if len(refused) == 1:
            refused[f"join {joined + 1} at once"] = _refusal(answer)
        if "which is the most" in answer.text:
            refused[f"participant {joined + 1}"] = _refusal(answer)
            break
        last_wait_s = int(answer.headers["Retry-After"])
        await asyncio.sleep(last_wait_s)
    for code in codes:
        await teacher.call("POST", f"/api/v1/rooms/{code}/end")
    return refused


def _refusal(answer: httpx2.Response) -> str:
    wait = answer.headers.get("Retry-After")
    return f"{answer.status_code}, Retry-After {wait}: {answer.json()['detail']}"


class Meter:
    """Measures a server's processes on this machine: the one with an id, and its children."""

    def __init__(self, pid: int | None) -> None:
        """Create it; without an id it measures nothing."""
        self._pid = pid

    def cpu_s(self) -> float:
        """Return the time that they, and their children that have ended, had of all cores [s]."""
        ticks = sum(sum(map(int, fields[11:15])) for fields in self._stats())
        return ticks / os.sysconf("SC_CLK_TCK")

    def memory_bytes(self) -> int:
        """Return the resident memory of all, in which what they share counts once [B]."""
        total = 0
        for pid in self._pids():
            with suppress(OSError):
                match = re.search(
                    r"^Pss:\s+(\d+)", Path(f"/proc/{pid}/smaps_rollup").read_text(), re.MULTILINE
                )
                total += 1024 * int(match[1]) if match else 0
        return total

    def _stats(self) -> list[list[str]]:
        stats = []
        for pid in self._pids():
            with suppress(OSError):
                stats.append(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split())
        return stats

    def _pids(self) -> list[int]:
        pids = [] if self._pid is None else [self._pid]
        for pid in pids:
            for task in Path(f"/proc/{pid}/task").glob("*/children"):
                with suppress(OSError):
                    pids += map(int, task.read_text().split())
        return pids


def main() -> None:
    """Run the benchmark by its options."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("address")
    parser.add_argument("--token", default="")
    parser.add_argument("--pupils", type=int, default=40)
    parser.add_argument("--rooms", type=int, default=2)
    parser.add_argument("--dropped-every", type=float, default=60.0, help="[s]")
    parser.add_argument("--watch", type=float, default=65.0, help="for how long [s]")
    parser.add_argument("--server", type=int, help="id of the server's process, on this machine")
    parser.add_argument("--limits", action="store_true", help="try what is more than the limits")
    options = parser.parse_args()
    options.address = options.address.rstrip("/")
    if not urlsplit(options.address).hostname:
        sys.exit("the address must look like http://127.0.0.1:8000")
    json.dump(asyncio.run((limits if options.limits else measure)(options)), sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
