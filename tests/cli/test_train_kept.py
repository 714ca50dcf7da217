"""`hexapods train --keep`: what is kept is equal to a training of the page."""

import sqlite3
from pathlib import Path
from typing import Any

import pytest

import hexapods as hx
from app.storage.database.opening import DATABASE_FILE
from app.storage.recordings import Recordings
from app.storage.run import TABLE
from hexapods.runs.tables import digest_of, from_bytes
from tests.cli.keeping import interrupted
from tests.cli.running import in_process, output, refusal
from tests.served import Served
from tests.storage.stores import opened

TRAIN = ("train", "--simulator", "kinematic", "--steps", "120", "--seed", "5", "--keep")
BODY = {"simulator": "kinematic", "steps": 120, "seed": 5}
ENDLESS = ("train", "--simulator", "kinematic", "--steps", "10000000", "--evaluate-every", "0")


def data_of(server: Served, run_id: str, what: str) -> Any:
    return server.client.get(f"/api/v1/trainings/{run_id}/{what}")


def test_a_kept_training_is_equal_to_one_that_the_page_started(tmp_path: Path) -> None:
    data = tmp_path / "data"
    kept = output(*TRAIN, "--name", "Alone", "--out", "q.npz", folder=tmp_path)
    assert not (data / "server.address").exists()
    server = Served(data)
    try:
        by_server = output(*TRAIN, "--name", "Served", folder=tmp_path)
        started = server.in_state(server.start(BODY), "finished")
        alone, served, of_page = (
            server.look({"kind": "training", "id": run["id"]}) for run in (kept, by_server, started)
        )
        assert (alone["name"], served["name"]) == ("Alone", "Served")
        for run in (alone, served):
            for member in ("config", "result", "progress", "greedy_distance_m", "state"):
                assert run[member] == of_page[member], member
            for what in ("curve", "q-table?format=npz"):
                assert data_of(server, run["id"], what).content == (
                    data_of(server, started["id"], what).content
                )
    finally:
        server.end()
    direct = hx.train(simulator="kinematic", steps=120, seed=5)
    assert kept["result"]["q_table_sha256"] == direct.q_table_sha256
    assert kept["curve"] == [point._asdict() for point in direct.curve]
    assert hx.Training.load(tmp_path / "q.npz").curve == direct.curve
    with opened(data, None) as store:
        recordings = [Recordings(store).training(run["id"]) for run in (alone, of_page)]
        steps = [recording.steps for recording in recordings if recording is not None]
        assert len(steps) == 2
        assert [step.action for step in steps[0]] == [step.action for step in steps[1]]
        tables = [store.artifact(run["id"], TABLE) for run in (alone, served, of_page)]
        assert tables[0] is not None
        assert tables[0] == tables[1] == tables[2]


def test_a_table_of_a_file_is_continued_and_kept_too(tmp_path: Path) -> None:
    output("train", *TRAIN[1:-1], "--out", "q.npz", folder=tmp_path, run=in_process)
    more = ("train", "--simulator", "kinematic", "--steps", "60", "--from", "q.npz")
    direct = output(*more, folder=tmp_path, run=in_process)
    kept = output(*more, "--keep", folder=tmp_path)
    assert kept["result"] == direct["result"]
    with opened(tmp_path / "data", None) as store:
        run = store.get(kept["id"])
        assert run.continued_from is not None
        assert store.get(run.continued_from).state == "finished"


@pytest.mark.parametrize("is_served", [False, True])
def test_ctrl_c_stops_it_and_keeps_what_is_done(tmp_path: Path, is_served: bool) -> None:
    data = tmp_path / "data"
    server = Served(data) if is_served else None
    sentence = interrupted(*ENDLESS, "--keep", data=data, once="done > 0")
    if server is not None:
        server.end()
    with opened(data, None) as store:
        (run,) = store.list().runs
        assert (run.state, run.result is None) == ("stopped", False)
        table = store.artifact(run.id, TABLE)
        assert table is not None
        assert digest_of(from_bytes(table, "the table").arrays)
    said = f"Stopped after {run.done:,} of 10,000,000 steps; they are kept as training {run.id}"
    assert said in sentence


def test_refusals_name_what_is_valid(tmp_path: Path) -> None:
    data, newer = tmp_path / "data", tmp_path / "newer"
    for options, said in (
        (("--name", "A"), "add --keep"),
        (("--keep", "--agent", "my.module:Agent"), "agents that every server"),
        (("--keep", "--resume", "q.checkpoint.npz"), "leave --keep out"),
        (("--keep", "--from", "q.npz", "--seed", "2"), "leave --seed out"),
        (("--keep", "--data", "/proc/none"), "choose one that can be written"),
        (("--keep", "--agent", "greedy"), "does not learn"),
    ):
        assert said in refusal("train", *options, folder=tmp_path, run=in_process)
    with opened(newer, None):
        pass
    with sqlite3.connect(newer / DATABASE_FILE) as database:
        database.execute("UPDATE alembic_version SET version_num = '9999'")
    sentence = refusal(*TRAIN, "--data", str(newer), folder=tmp_path, run=in_process)
    assert "newer version" in sentence
    assert "MB" in refusal(*TRAIN, folder=tmp_path, run=in_process, HEXAPODS_QUOTA_MB="5")
    with opened(data, None):
        sentence = refusal(*TRAIN, folder=tmp_path, run=in_process)
    assert "does not say where it listens" in sentence
    full = data.parent / "full"
    full.mkdir()
    (full / "big").write_bytes(bytes(11_000_000))
    sentence = refusal(
        *TRAIN, "--data", str(full), folder=tmp_path, run=in_process, HEXAPODS_QUOTA_MB="10"
    )
    assert "HEXAPODS_QUOTA_MB" in sentence
