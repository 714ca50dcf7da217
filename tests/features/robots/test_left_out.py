"""A server without the feature: stored robots walk, and nothing stores, changes or deletes them."""

import json
from functools import partial
from pathlib import Path

import pytest

from app.features.robots.robot_import import import_robot
from app.settings import Settings
from app.storage.database.opening import open_store
from tests.api.calls import WALK, refused
from tests.api.conftest import running
from tests.cli.running import in_process, output, refusal

BODY = {"preset": "dog", "femur_m": 0.0912}


@pytest.fixture
def rex_id(tmp_path: Path) -> str:
    """The id of a robot that is stored in the folder `data`."""
    settings = Settings(data=tmp_path / "data")
    settings.prepare_data()
    with open_store(settings) as store:
        stored, _ = import_robot(store, json.dumps({"robot": BODY}).encode(), "Rex")
    return stored.id


def test_a_stored_robot_is_offered_previewed_and_trained(tmp_path: Path, rex_id: str) -> None:
    settings = Settings(data=tmp_path / "data", job_niceness=0, without=("robots",))
    with running(settings) as api:
        options = api.get("/options")
        assert options["robots"][-1]["title"] == "Rex"
        assert "leg_fields" not in options
        walk = {**WALK, "gait": "trot", "robot": {"id": rex_id}}
        preview = api.call("POST", "/robots/preview", json={"gait": "trot", "robot": walk["robot"]})
        assert preview.json()["tips"] is False
        run = api.finished(api.train(**walk))
        assert run["config"]["robot"] == {"id": rex_id, "name": "Rex"}
        refused(api.call("POST", "/robots", json={"robot": BODY}), 404)
        refused(api.call("DELETE", f"/robots/{rex_id}"), 404)
        assert api.get("/options")["robots"][-1]["id"] == rex_id


def test_commands_take_a_stored_robot_by_its_name(tmp_path: Path, rex_id: str) -> None:
    run = partial(in_process, HEXAPODS_WITHOUT="robots")
    error = refusal("robots", "list", folder=tmp_path, run=run)
    assert "robots is a command of the feature robots, which HEXAPODS_WITHOUT leaves out" in error
    walk = ("--robot", "rex", "--gait", "trot", "--simulator", "kinematic", "--steps", "3")
    trained = output("train", *walk, folder=tmp_path, run=run)
    assert trained["config"]["robot"]["id"] == rex_id
