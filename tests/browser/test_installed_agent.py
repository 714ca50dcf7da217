"""An agent of an installed package: its settings appear everywhere, with no other change."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import pytest
from playwright.sync_api import expect

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving
from tests.promises.length import only_whole

AGENT = """
from typing import Annotated

from annotated_types import Ge, Le

from hexapods.agents.q_learning import QLearning
from hexapods.domain.settings import Setting

Optimism = Annotated[
    float, Ge(0), Le(5), Setting(title="Optimism", symbol="ω", help="First guess of a value.")
]
Patience = Annotated[
    float, Ge(0), Le(1), Setting(title="Patience", help="How long it waits.", live=True)
]


class Wanderer(QLearning):
    title = "Wanderer"

    def __init__(self, *args, optimism: Optimism = 0.5, patience: Patience = 0.25, **settings):
        super().__init__(*args, **settings)
        self.optimism, self.patience = optimism, patience

    def tune(self, *, patience: Patience | None = None, **changes):
        super().tune(**changes)
        self.patience = self.patience if patience is None else patience

    def state(self):
        import numpy as np

        return super().state() | {"own": np.array([self.optimism, self.patience])}

    def load(self, state):
        super().load(state)
        self.optimism, self.patience = state["own"].tolist()
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A package in the environment of servers and commands that offers the agent."""
    folder = tmp_path_factory.mktemp("site")
    about = folder / "wandering-1.0.dist-info"
    about.mkdir()
    (folder / "wandering.py").write_text(AGENT)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: wandering\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[hexapods.agents]\nwanderer = wandering:Wanderer\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", f"{Path.cwd()}{os.pathsep}{folder}")
        yield


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def served(installed: None, data: Path) -> Iterator[Serving]:
    """A server that found the agent when it started."""
    server = Serving(data)
    yield server
    server.stop()


@pytest.fixture
def client(served: Serving) -> Iterator[httpx2.Client]:
    with httpx2.Client(base_url=served.address, timeout=60, trust_env=False) as client:
        yield client


def test_openapi_describes_its_settings(client: httpx2.Client) -> None:
    schemas = client.get("/openapi.json").json()["components"]["schemas"]
    fields = schemas["WandererTraining"]["properties"]
    settings = schemas["WandererSettings"]["properties"]
    assert (settings["optimism"]["minimum"], settings["optimism"]["maximum"]) == (0, 5)
    assert settings["optimism"]["default"] == 0.5
    assert "First guess of a value." in settings["optimism"]["description"]
    assert fields["agent"]["const"] == "wanderer"
    assert "patience" in schemas["LiveSettings"]["properties"]
    assert "optimism" in schemas["SettingLists"]["properties"]


def test_options_list_its_settings(client: httpx2.Client) -> None:
    agents = client.get("/api/v1/options").json()["agents"]
    (agent,) = [agent for agent in agents if agent["name"] == "wanderer"]
    assert (agent["title"], agent["learns"]) == ("Wanderer", True)
    assert list(agent["settings"])[-2:] == ["optimism", "patience"]
    assert "patience" in agent["live_settings"]
    assert "optimism" not in agent["live_settings"]


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize("command", ["train", pytest.param("sweep", marks=only_whole)])
def test_the_command_line_has_options_for_its_settings(command: str) -> None:
    said = subprocess.run(
        [sys.executable, "-m", "app.cli", command, "--agent", "wanderer", "--help"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "COLUMNS": "200"},
    ).stdout
    assert "--patience" in said
    assert "How long it waits. [from 0 to 1; default 0.25]" in said


def test_a_value_out_of_its_limits_is_refused(client: httpx2.Client) -> None:
    answer = client.post("/api/v1/trainings", json=_body(settings={"optimism": 6}))
    assert answer.status_code == 422
    assert answer.json()["errors"] == [
        {"field": "settings.optimism", "detail": "settings.optimism must be a number from 0 to 5."}
    ]


@only_whole
def test_a_sweep_tries_its_values(client: httpx2.Client) -> None:
    body = {
        "experiment": "sweep",
        "agents": ["wanderer"],
        "settings": {"optimism": [0, 1]},
        "seeds": 1,
        "steps": 20,
        "workers": 1,
        "simulator": "kinematic",
        "gaits": ["left-right-origin"],
    }
    run = client.post("/api/v1/experiments", json=body).json()
    assert run["config"]["settings"]["optimism"] == [0, 1]
    _until(client, run, "finished")
    summary = client.get(f"/api/v1/experiments/{run['id']}/summary").json()
    tried = [
        setting["optimism"] for setting in summary["settings"] if setting["agent"] == "wanderer"
    ]
    assert tried == [0, 1]


def test_the_page_changes_it_during_a_training(
    dashboard: Dashboard, served: Serving, client: httpx2.Client
) -> None:
    form = {"agent": "wanderer", "simulator": "kinematic", "steps": 100_000, "pace": 4}
    dashboard.open(served.link(**form, depth="study", tab="train"))
    page = dashboard.page
    dashboard.unfold("More settings")
    expect(page.get_by_label("Optimism")).to_have_value("0.5")
    dashboard.button("Train, don’t race").click()
    expect(page.get_by_role("slider", name="Exploration now ε")).to_be_visible()
    page.get_by_role("slider", name="Patience").fill("0.75")

    def changed() -> bool:
        (run, *_) = client.get("/api/v1/trainings").json()["items"]
        return run["config"]["agent"] == "wanderer" and any(
            change.get("settings", {}).get("patience") == 0.75 for change in run["changes"]
        )

    dashboard.eventually(changed, "the change is in the training")
    (run, *_) = client.get("/api/v1/trainings").json()["items"]
    client.post(f"/api/v1/trainings/{run['id']}/stop")


@pytest.mark.usefixtures("installed")
def test_a_checkpoint_keeps_its_settings_over_a_kill(tmp_path: Path) -> None:
    first = Serving(tmp_path)
    with httpx2.Client(base_url=first.address, timeout=60, trust_env=False) as client:
        settings = {"optimism": 3, "patience": 0.5}
        body = _body(settings=settings, steps=5000, pace=20, evaluate_every=0)
        run = client.post("/api/v1/trainings", json=body).json()
        _until(client, run, "running")
        path = f"/api/v1/trainings/{run['id']}"
        client.patch(path, json={"settings": {"patience": 0.75}})
        at = client.get(path).json()["progress"]["done"]
        while client.get(path).json()["progress"]["done"] < at + 100:
            time.sleep(0.1)
    first.kill()
    second = Serving(tmp_path)
    try:
        with httpx2.Client(base_url=second.address, timeout=60, trust_env=False) as client:
            client.post(f"{path}/resume")
            _until(client, run, "running")
            client.patch(path, json={"pace": "max"})
            ended = _until(client, run, "finished")
            table = client.get(f"{path}/q-table?format=npz").content
    finally:
        second.stop()
    assert ended["config"]["settings"]["optimism"] == 3
    assert [c["settings"]["patience"] for c in ended["changes"] if "settings" in c] == [0.75]
    (tmp_path / "q.npz").write_bytes(table)
    with np.load(tmp_path / "q.npz") as arrays:
        assert arrays["agent.own"].tolist() == [3, 0.75]
        assert json.loads(str(arrays["meta"]))["config"]["settings"]["optimism"] == 3


def _body(**fields: Any) -> dict[str, Any]:
    gait = {"gait": "left-right-origin", "simulator": "kinematic"}
    return {**gait, "agent": "wanderer", "steps": 50, **fields}


def _until(client: httpx2.Client, run: dict[str, Any], state: str) -> dict[str, Any]:
    """The run once it is in a state."""
    path = f"/api/v1/{run['kind']}s/{run['id']}"
    for _ in range(1200):
        run_now: dict[str, Any] = client.get(path).json()
        if run_now["state"] == state:
            return run_now
        time.sleep(0.1)
        assert run_now["state"] in ("queued", "running", "interrupted"), run_now
    raise AssertionError(f"it is {run_now['state']}")
