"""A run that is over shows after a restart all that it showed before, and the stage replays it."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.served import BODY, Served
from tests.timeouts import LONG_S

LANES = [{"agent": "q-learning", "training": {"steps": 100}}, {"agent": "greedy"}]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def before(data: Path) -> dict[str, bytes]:
    """Return a server's answers about a race and its practice, by address."""
    server = Served(data)
    try:
        race = server.start({**BODY, "steps": 10, "lanes": LANES}, "/races")
        ended = server.in_state(race, "finished", "failed", "stopped")
        assert ended["state"] == "finished", ended
        practice = f"/api/v1/trainings/{race['waiting_for'][0]}"
        paths = [
            *(f"{practice}{rest}" for rest in ("", "/curve", "/curve?format=csv", "/q-table")),
            f"{practice}/q-table?format=npz",
            *(f"/api/v1/races/{race['id']}{rest}" for rest in ("", "/recording", "/timeline")),
            "/api/v1/races",
            "/api/v1/trainings",
        ]
        said = {}
        for path in paths:
            response = server.client.get(path)
            assert response.status_code == 200, response.text
            said[path] = response.content
        return said
    finally:
        server.end()


@pytest.fixture(scope="module")
def server(data: Path, before: dict[str, bytes]) -> Iterator[Served]:
    del before
    again = Served(data)
    yield again
    again.end()


def test_it_says_the_same(server: Served, before: dict[str, bytes]) -> None:
    for path, said in before.items():
        assert server.client.get(path).content == said, path


@pytest.mark.parametrize("kind", ["races", "trainings"])
def test_a_stored_run_is_played_after_a_restart(server: Served, kind: str) -> None:
    run = server.client.get(f"/api/v1/{kind}").json()["items"][0]
    shown = server.client.put("/api/v1/stage", json={"run_id": run["id"], "speed": 8})
    assert shown.status_code == 200, shown.text
    assert shown.json()["run_id"] == run["id"]
    wait_until_moving(server)


def wait_until_moving(server: Served) -> None:
    deadline = time.monotonic() + LONG_S
    while not any(lane["distance_m"] for lane in scene(server)["lanes"]):
        assert time.monotonic() < deadline, scene(server)
        time.sleep(0.1)


def scene(server: Served) -> dict[str, Any]:
    events = server.events()
    _, snapshot, _ = next(events)
    events.close()  # type: ignore[attr-defined]
    shown: dict[str, Any] = snapshot["scene"]
    return shown
