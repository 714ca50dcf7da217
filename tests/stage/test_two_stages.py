"""Two stages in one process, each at a path of its own: neither touches the other.

By a server with races of MuJoCo, and a viser of each stage.
"""

import asyncio
import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

import httpx2
import pytest

from app.limits.client_slots import ClientSlots
from app.stage.roles import Roles
from app.viewer.shared_stage import SharedStage
from hexapods.drawing.viser_internals import stream
from tests.stage.stage_parts import StageParts
from tests.stage.two_stages import SECOND, TOKENS, two_stages
from tests.timeouts import LONG_S, ProgressTimeout
from tests.viewer.serving import Viewer


class Client:
    """A client of one stage, which it names by its path."""

    def __init__(self, port: int, path: str) -> None:
        self.path, self.socket = path, f"ws://127.0.0.1:{port}{path}/viewer/"
        self.http = httpx2.Client(
            base_url=f"http://127.0.0.1:{port}{path}",
            timeout=LONG_S,
            trust_env=False,
            verify=False,
            headers={"Authorization": f"Bearer {TOKENS[path]}"},
        )

    def stage(self) -> dict[str, Any]:
        state: dict[str, Any] = self.http.get("/api/v1/stage").json()
        return state

    def put(self, **changes: Any) -> None:
        assert self.http.put("/api/v1/stage", json=changes).status_code == 200

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.http.close()

    def race(self, *agents: str) -> str:
        """Compute a race, and return its id."""
        lanes = [{"agent": agent} for agent in agents]
        body = {"gait": "left-right-origin", "simulator": "mujoco", "steps": 8, "lanes": lanes}
        response = self.http.post("/api/v1/races", json=body)
        assert response.status_code == 202, response.text
        location, stall_check = response.headers["location"], ProgressTimeout()
        assert location.startswith(f"{self.path}/api/v1/races/")
        while (run := self.http.get(location.removeprefix(self.path)).json())[
            "state"
        ] != "finished":
            stall_check.check(run)
        return str(run["id"])

    @contextmanager
    def events(self) -> Iterator["Events"]:
        with self.http.stream("GET", "/api/v1/events") as response:
            yield Events(response.iter_lines())


class Events:
    """A stream of events."""

    def __init__(self, lines: Iterator[str]) -> None:
        self._lines = lines

    def until(self, wanted: str, **fields: Any) -> list[tuple[str, Any]]:
        """Return the events up to the first of this name whose data has these fields."""
        events: list[tuple[str, Any]] = []
        name = ""
        for line in self._lines:
            field, _, value = line.partition(": ")
            if field == "event":
                name = value
            elif field == "data":
                events.append((name, json.loads(value)))
                if name == wanted and fields.items() <= events[-1][1].items():
                    return events
        raise AssertionError(events)


class Lanes:
    """The lanes that a viewer sees."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer, self.names = viewer, set[str]()

    def see(self, count: int) -> None:
        """Read frames until there are so many lanes, with their robots."""
        self.read()
        while len(self.names) != count:
            self.read()

    def read(self, timeout_s: float = LONG_S) -> None:
        """Read a frame.

        Raises:
            TimeoutError: if none comes.
        """
        frame = stream.parse(self.viewer.socket.recv(timeout_s, decode=False))
        for message in frame.messages:
            name = str(message.get("name", ""))
            if message["type"] == "RemoveSceneNodeMessage":
                self.names.discard(name)
            elif message["type"] == "LabelMessage" and name.startswith("/world/run/lane"):
                self.names.add(name)

    def rest(self) -> None:
        """Read all frames until none comes for half a second."""
        with suppress(TimeoutError):
            while True:
                self.read(0.5)


class TwoStages(NamedTuple):
    """Clients of both stages of an app, and the races that they show, of two lanes and of one."""

    first: Client
    second: Client
    duel: str
    solo: str


@pytest.fixture(scope="module")
def stages(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TwoStages]:
    data = tmp_path_factory.mktemp("data")
    with two_stages(data) as port, Client(port, "") as first, Client(port, SECOND) as second:
        yield TwoStages(first, second, first.race("greedy", "two-step"), second.race("greedy"))


def test_each_stage_has_its_show_its_pause_its_events_and_its_viewers(stages: TwoStages) -> None:
    first, second, duel, solo = stages
    with first.events() as stream, second.events() as other_stream:
        assert stream.until("snapshot")[0][1]["role"] == "operator"
        other_stream.until("snapshot")
        first.put(run_id=duel, speed=0.25, time_s=0.0)
        second.put(run_id=solo, speed=0.5, time_s=0.0)
        with Viewer(first.socket) as viewer, Viewer(second.socket) as other_viewer:
            lanes, other_lanes = Lanes(viewer), Lanes(other_viewer)
            lanes.see(2)
            other_lanes.see(1)

            second.put(playing=False)
            other_lanes.rest()
            paused, playing = second.stage(), first.stage()
            for _ in range(20):
                lanes.read()
            assert (paused["run_id"], paused["playing"]) == (solo, False)
            assert (playing["run_id"], playing["playing"], playing["speed"]) == (duel, True, 0.25)
            assert second.stage()["time_s"] == paused["time_s"]
            assert first.stage()["time_s"] > playing["time_s"]
            assert (len(lanes.names), len(other_lanes.names)) == (2, 1)
        first.put(speed=4)
        second.put(speed=2)
        events = stream.until("stage", speed=4)
        other_events = other_stream.until("stage", speed=2)

    for events_of_one, run_id in ((events, duel), (other_events, solo)):
        shown = [
            (name, data["run_id"]) for name, data in events_of_one if name in ("stage", "scene")
        ]
        # A frame of the run before may be published after the command.
        started = shown.index(("scene", run_id))
        assert {scene_run for _, scene_run in shown[started:]} == {run_id}
        assert max(data["count"] for name, data in events_of_one if name == "viewers") == 1
    assert all(data["playing"] for name, data in events if name == "stage")
    assert not all(data["playing"] for name, data in other_events if name == "stage")


def test_events_of_a_run_reach_both_stages(stages: TwoStages) -> None:
    with stages.first.events() as stream, stages.second.events() as other_stream:
        stream.until("snapshot")
        other_stream.until("snapshot")
        stages.first.http.patch(f"/api/v1/runs/{stages.duel}", json={"name": "a duel"})
        stream.until("run", name="a duel")
        other_stream.until("run", name="a duel")


def test_each_stage_has_its_roles(stages: TwoStages) -> None:
    change: dict[str, Any] = {"json": {"speed": 1}}
    for client, stranger in (stages.first, stages.second), (stages.second, stages.first):
        token = stranger.http.headers["authorization"]
        refused = client.http.put("/api/v1/stage", headers={"Authorization": token}, **change)
        assert refused.status_code == 401
        read = client.http.get("/api/v1/stage", headers={"Authorization": ""})
        assert read.status_code == 200


def test_one_browser_has_a_session_of_each_stage(stages: TwoStages) -> None:
    server = str(stages.first.http.base_url).rstrip("/")
    with httpx2.Client(base_url=server, trust_env=False, verify=False) as browser:
        for path, token in TOKENS.items():
            opened = browser.get(f"{path}/?token={token}")
            assert (opened.status_code, opened.headers["location"]) == (303, "./")
        for path in TOKENS:
            assert browser.put(f"{path}/api/v1/stage", json={"speed": 1}).status_code == 200


def test_page_and_its_files_are_below_the_path_of_each_stage(stages: TwoStages) -> None:
    for client in stages.first, stages.second:
        for path in ("/", "/static/favicon.svg", "/viewer/", "/api/v1/options", "/healthz"):
            assert client.http.get(path).status_code == 200, (client.path, path)
    assert stages.first.http.get(f"{SECOND}s/api/v1/stage").status_code == 404


def test_stage_that_is_closed_ends_its_events_and_leaves_the_other(parts: StageParts) -> None:
    def shared(path: str) -> SharedStage:
        return SharedStage(
            parts.store,
            parts.recordings,
            parts.bus,
            roles=Roles(None),
            viewer_slots=ClientSlots(9, 9),
            path=path,
        )

    async def test() -> None:
        async with shared("") as first, shared(SECOND) as second:
            subscribed, ended = first.channel.subscribe(), second.channel.subscribe()
            await second.close()
            first.stage.set(playing=False)
            second.stage.set(playing=False)
            for subscription in ended, second.channel.subscribe():
                assert {event.event async for event in subscription} <= {"scene"}
            async for event in subscribed:
                if event.event == "stage":
                    break

    asyncio.run(asyncio.wait_for(test(), LONG_S))
