"""Two stages in one process, each at a path of its own: neither touches the other.

By a server with races of MuJoCo.
"""

import asyncio
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from typing import Any, NamedTuple

import httpx2
import pytest

from app.stage.playback import Replays
from app.stage.roles import Roles
from app.viewer.replay_frames import ReplayFrames
from app.viewer.shared_stage import SharedStage
from tests.event_streams import EventStream, open_stream
from tests.stage.stage_parts import StageParts
from tests.stage.two_stages import SECOND, TOKENS, two_stages
from tests.timeouts import LONG_S, ProgressTimeout


class Client:
    """A client of one stage, which it names by its path."""

    def __init__(self, port: int, path: str) -> None:
        self.path = path
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

    def events(self) -> AbstractContextManager[EventStream]:
        """Watch the stage."""
        return open_stream(self.http)


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
        for snapshot in stream.next(), other_stream.next():
            assert (snapshot.name, snapshot.data["role"]) == ("snapshot", "operator")
            assert snapshot.data["viewers"] == 1
        first.put(run_id=duel, speed=0.25, time_s=0.0)
        second.put(run_id=solo, speed=0.5, time_s=0.0)
        assert set(stream.frames(run_id=duel)[0]["follow"]) == {"leader", "1", "2"}
        assert set(other_stream.frames(run_id=solo)[0]["follow"]) == {"leader", "1"}

        second.put(playing=False)
        paused, playing = second.stage(), first.stage()
        time.sleep(0.3)
        assert (paused["run_id"], paused["playing"]) == (solo, False)
        assert (playing["run_id"], playing["playing"], playing["speed"]) == (duel, True, 0.25)
        assert second.stage()["time_s"] == paused["time_s"]
        assert first.stage()["time_s"] > playing["time_s"]
        first.put(speed=4)
        second.put(speed=2)
        events = stream.until("stage", speed=4)
        other_events = other_stream.until("stage", speed=2)

    for events_of_stage, run_id in ((events, duel), (other_events, solo)):
        shown = {data["run_id"] for name, data, _ in events_of_stage if name in ("stage", "piece")}
        assert shown == {run_id}
    assert all(data["playing"] for name, data, _ in events if name == "stage")
    assert not all(data["playing"] for name, data, _ in other_events if name == "stage")


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
            frames=ReplayFrames(Replays(parts.store, parts.recordings)),
            roles=Roles(None),
            path=path,
        )

    async def test() -> None:
        async with shared("") as first, shared(SECOND) as second:
            subscribed, ended = first.channel.subscribe(), second.channel.subscribe()
            await second.close()
            first.stage.set(playing=False)
            second.stage.set(playing=False)
            for subscription in ended, second.channel.subscribe():
                assert [event.event async for event in subscription] == []
            async for event in subscribed:
                if event.event == "stage":
                    break

    asyncio.run(asyncio.wait_for(test(), LONG_S))
