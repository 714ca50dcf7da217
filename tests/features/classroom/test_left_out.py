"""A server without the classroom hides the runs of participants, and tournaments of rooms."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from app.features.classroom.room_rows import RoomRows, RoomRun
from app.settings import Settings
from tests.api.conftest import running
from tests.features.needing import needs
from tests.storage.stores import training

TOKEN = "a-token-for-tests"
BEARER = {"authorization": f"Bearer {TOKEN}"}
PATHS_OF_HIDDEN = (
    "/runs/hidden",
    "/trainings/hidden",
    "/runs/export?id=hidden",
    "/events?run_id=hidden",
)


@pytest.fixture
def with_hidden_run(tmp_path: Path) -> Path:
    """A data folder with a run of a participant before the reveal, and one that is shown."""
    with running(Settings(data=tmp_path, token=TOKEN)) as api:
        code = api.call("POST", "/rooms", json={}, headers=BEARER).json()["code"]
        app: Any = api.client.app
        store = app.state.services.store
        run = RoomRun("hidden", code, 0, 0, {}, True, False, datetime.now(UTC))
        RoomRows(store.database).add_runs([run])
        store.create(training("hidden", state="finished"))
        store.create(training("shown", state="finished"))
    return tmp_path


@pytest.mark.parametrize("without", [(), ("classroom",)], ids=["classroom", "left out"])
def test_a_hidden_run_stays_hidden_where_its_feature_is_left_out(
    without: tuple[str, ...], with_hidden_run: Path
) -> None:
    settings = Settings(data=with_hidden_run, token=TOKEN, without=without)
    with running(settings) as api:
        for path in ("/runs", "/trainings"):
            assert [run["id"] for run in api.get(path)["items"]] == ["shown"], path
        for path in PATHS_OF_HIDDEN:
            assert api.client.head(f"/api/v1{path}").status_code == 403, path
        assert api.call("GET", "/runs/hidden", headers=BEARER).status_code == 200
        assert len(api.call("GET", "/runs", headers=BEARER).json()["items"]) == 2


def test_the_picture_of_a_hidden_run_is_seen_while_an_operator_shows_it_to_all(
    with_hidden_run: Path,
) -> None:
    picture = "/api/v1/runs/hidden/replay/scene"
    with running(Settings(data=with_hidden_run, token=TOKEN)) as api:
        assert api.client.get(picture).status_code == 403
        api.call("PUT", "/stage", json={"run_id": "hidden"}, headers=BEARER)
        assert api.client.get(picture).status_code == 200
        for path in PATHS_OF_HIDDEN:
            assert api.client.head(f"/api/v1{path}").status_code == 403, path
        ghost = "/api/v1/runs/shown/replay/scene?ghost=hidden"
        assert api.client.get(ghost).status_code != 200
        api.call("PUT", "/stage", json={"run_id": "shown"}, headers=BEARER)
        assert api.client.get(picture).status_code == 403


@needs("tournaments")
def test_tournaments_of_open_rooms_stay_closed_without_the_classroom(tmp_path: Path) -> None:
    with running(Settings(data=tmp_path, token=TOKEN)) as api:
        code = api.call("POST", "/rooms", json={}, headers=BEARER).json()["code"]
        body = {"room": code, "rules": {"gait": "tripod"}}
        opened = api.call("POST", "/tournaments", json=body, headers=BEARER).json()["id"]
        assert api.call("GET", f"/tournaments/{opened}").status_code == 403
    with running(Settings(data=tmp_path, token=TOKEN, without=("classroom",))) as api:
        assert api.call("GET", f"/tournaments/{opened}").status_code == 403
        assert api.call("GET", f"/tournaments/{opened}", headers=BEARER).status_code == 200
