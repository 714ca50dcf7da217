"""`hexapods race --keep`: what is kept is equal to a race of the page."""

import sqlite3
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from app.storage.database.opening import DATABASE_FILE
from app.storage.recordings import Recordings
from tests.cli.keeping import interrupted
from tests.cli.running import EXAMPLES, hexapods, in_process, output, refusal
from tests.served import Served
from tests.storage.stores import opened

KINEMATIC = ("--simulator", "kinematic")
LANES = (
    "q-learning=q.npz",
    "sarsa,keep_learning=true,observation=planned,alpha=0.5",
    "greedy,plans_with=nominal",
)
RACE = (
    "race",
    *KINEMATIC,
    *(word for lane in LANES for word in ("--lane", lane)),
    *("--steps", "30", "--seed", "7", "--reward", "track"),
)
ENDLESS = ("race", "--lane", "two-step", "--lane", "two-step", "--steps", "10000")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a working folder with a table."""
    folder = tmp_path_factory.mktemp("races")
    hx.train(simulator="kinematic", steps=60, seed=1).save(folder / "q.npz")
    return folder


def without_times(result: dict[str, Any]) -> list[dict[str, Any]]:
    """Return lanes of a race's result without ids and what depends on the times of decisions."""
    measured = ("decision_s", "clocks", "training_id")
    return [
        {
            **{name: value for name, value in lane.items() if name not in measured},
            "paper": lane["clocks"]["paper"],
        }
        for lane in result["lanes"]
    ]


def body_of_page(server: Served, table: Path) -> dict[str, Any]:
    """Return the request of a page that starts the same race, with the table as a training."""
    path, headers = "/api/v1/trainings/import", {"content-type": "application/octet-stream"}
    training = server.client.post(path, content=table.read_bytes(), headers=headers).json()
    lanes = [
        {"agent": "q-learning", "training_id": training["id"]},
        {
            "agent": "sarsa",
            "keep_learning": True,
            "observation": "planned",
            "settings": {"alpha": 0.5},
        },
        {"agent": "greedy", "plans_with": "nominal"},
    ]
    return {"simulator": "kinematic", "steps": 30, "seed": 7, "reward": "track", "lanes": lanes}


def test_a_kept_race_is_equal_to_one_that_the_page_started(folder: Path) -> None:
    direct = output(*RACE, folder=folder, run=in_process)
    kept = output(*RACE, "--keep", "--name", "Alone", folder=folder)
    data = folder / "data"
    assert not (data / "server.address").exists()
    server = Served(data)
    try:
        by_server = output(*RACE, "--keep", folder=folder)
        started = server.start(body_of_page(server, folder / "q.npz"), "/races")
        of_page = server.in_state(started, "finished")
        alone, served = (
            server.look({"kind": "race", "id": run["id"]}) for run in (kept, by_server)
        )
        assert (alone["name"], served["name"]) == ("Alone", of_page["name"])
        assert (alone["is_named"], served["is_named"]) == (True, False)
        for run in (alone, served, of_page):
            for lane in run["config"]["lanes"]:
                lane["training_id"] = lane["training_id"] is not None
        for run in (alone, served):
            for member in ("config", "progress", "state", "best_known_m"):
                assert run[member] == of_page[member], member
            assert without_times(run["result"]) == without_times(of_page["result"])
    finally:
        server.end()
    digest = of_page["result"]["recording_sha256"]
    for printed in (direct, kept, by_server):
        assert printed["recording_sha256"] == digest
        assert printed["gait"] == direct["gait"]
        assert printed["config"] == direct["config"]
    with opened(data, None) as store:
        recordings = [Recordings(store).race(run["id"]) for run in (alone, served, of_page)]
    for recorded in zip(*(recording or [] for recording in recordings), strict=True):
        actions = [[step.action for step in lane.steps] for lane in recorded]
        assert actions[0]
        assert actions[0] == actions[1] == actions[2]


def test_a_table_of_two_lanes_is_kept_once(folder: Path) -> None:
    lanes = ("--lane", "q-learning=q.npz", "--lane", "q-learning=q.npz,keep_learning=true")
    data = folder / "once"
    done = hexapods(
        "race", *KINEMATIC, *lanes, "--steps", "5", "--keep", "--data", str(data), folder=folder
    )
    assert done.returncode == 0, done.stderr
    with opened(data, None) as store:
        training, race = sorted(store.list().runs, key=lambda run: run.kind, reverse=True)
        assert race.lane_training_ids == (training.id, training.id)
    assert f"It is kept as race {race.id}, {race.name!r}; `hexapods serve` shows it." in done.stdout


@pytest.mark.parametrize("is_served", [False, True])
def test_ctrl_c_stops_it_and_keeps_what_is_done(tmp_path: Path, is_served: bool) -> None:
    data = tmp_path / "data"
    server = Served(data) if is_served else None
    sentence = interrupted(*ENDLESS, "--keep", data=data, once="state = 'running'")
    if server is not None:
        server.end()
    with opened(data, None) as store:
        (run,) = store.list().runs
        assert run.state == "stopped"
        recording = Recordings(store).race(run.id) or []
        assert sum(len(lane.steps) for lane in recording) == run.done  # whole numbers
    assert f"Stopped after {run.done:,} of 20,000 steps" in sentence
    assert f"they are kept as race {run.id}" in sentence
    assert "Resume on the page goes on" in sentence


def test_refusals_name_what_is_valid(folder: Path, tmp_path: Path) -> None:
    race = ("race", *KINEMATIC, "--lane", "greedy", "--steps", "5")
    newer = tmp_path / "newer"
    (folder / "my_agent.py").write_bytes((EXAMPLES / "my_agent.py").read_bytes())
    for options, said in (
        (("--name", "A"), "add --keep"),
        (("--keep", "--lane", "my_agent:Agent,keep_learning=true"), "agents that every server"),
        (("--keep", "--data", "/proc/none"), "choose one that can be written"),
        (("--keep", "--steps", "0"), "must be a whole number from 1 to 20,000"),
        (("--keep", "--lane", "q-learning"), "a q-learning lane needs its table"),
    ):
        assert said in refusal(*race, *options, folder=folder, run=in_process), options
    with opened(newer, None):
        pass
    with sqlite3.connect(newer / DATABASE_FILE) as database:
        database.execute("UPDATE alembic_version SET version_num = '9999'")
    sentence = refusal(*race, "--keep", "--data", str(newer), folder=folder, run=in_process)
    assert "newer version" in sentence
    data = tmp_path / "held"
    with opened(data, None):
        sentence = refusal(*race, "--keep", "--data", str(data), folder=folder, run=in_process)
    assert "does not say where it listens" in sentence
    full = tmp_path / "full"
    full.mkdir()
    (full / "big").write_bytes(bytes(11_000_000))
    sentence = refusal(
        *race, "--keep", "--data", str(full), folder=folder, run=in_process, HEXAPODS_QUOTA_MB="10"
    )
    assert "HEXAPODS_QUOTA_MB" in sentence
