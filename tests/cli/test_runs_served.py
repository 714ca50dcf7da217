"""`hexapods runs` beside a server, which makes the changes."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.running import hexapods, in_process, output, refusal
from tests.served import Served
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened, training

TRAINING, RACED, TOKEN = "00000000000t1", "00000000000r1", "a-token-for-tests"


def filled(folder: Path) -> Path:
    """Fill a data folder with a finished training and race."""
    with opened(folder, None) as store:
        ended_training(store, TRAINING)
        ended_race(store, RACED, TRAINING)
    return folder


@pytest.fixture
def data(tmp_path: Path) -> Path:
    return filled(tmp_path / "data")


@pytest.fixture
def server(data: Path) -> Iterator[Served]:
    served = Served(data, HEXAPODS_TOKEN=TOKEN)
    yield served
    served.end()


@pytest.fixture(scope="module")
def unchanged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, Path]]:
    """A server and its data folder, for the tests that are refused every change."""
    folder = filled(tmp_path_factory.mktemp("unchanged"))
    served = Served(folder, HEXAPODS_TOKEN=TOKEN)
    yield served, folder
    served.end()


def test_changes_are_made_by_the_running_server(server: Served, data: Path, tmp_path: Path) -> None:
    data_option = ("--data", str(data))
    with server.client.stream("GET", "/api/v1/events") as events:
        lines = events.iter_lines()
        done = hexapods(
            "runs", "delete", RACED, *data_option, folder=tmp_path, HEXAPODS_TOKEN=TOKEN
        )
        assert done.stdout == f"Deleted race {RACED}.\n", done.stderr
        assert any(line == "event: run-deleted" for line in lines), "the page was told"
    assert server.client.get(f"/api/v1/races/{RACED}").status_code == 404


def test_refusals_of_the_server_are_reported(
    unchanged: tuple[Served, Path], tmp_path: Path
) -> None:
    server, data = unchanged
    data_option = ("--data", str(data))
    for token in ("", "another-token-for-tests"):
        delete = ("runs", "delete", RACED, *data_option)
        said = refusal(*delete, folder=tmp_path, run=in_process, HEXAPODS_TOKEN=token)
        assert "needs its token: set HEXAPODS_TOKEN" in said
        assert server.address in said
    listed = output("runs", "list", *data_option, folder=tmp_path, run=in_process)
    assert [run["id"] for run in listed["items"]] == [TRAINING, RACED]


def test_full_quota_refuses_starts(data: Path) -> None:
    (data / "big").write_bytes(bytes(9_000_000))
    server = Served(data, HEXAPODS_QUOTA_MB="10")
    try:
        ready = server.client.get("/readyz")
        assert ready.status_code == 503
        assert "raise HEXAPODS_QUOTA_MB" in ready.json()["detail"]
        body = {"gait": "left-right-origin"}
        refused = server.client.post("/api/v1/trainings", json=body)
        assert refused.status_code == 507
        assert "delete runs" in refused.json()["detail"]
        assert server.client.get(f"/api/v1/trainings/{TRAINING}").json()["state"] == "finished"
        (data / "big").unlink()
        assert server.client.get("/readyz").status_code == 200
        assert server.client.post("/api/v1/trainings", json=body).status_code == 202
    finally:
        server.end()


def test_runs_can_be_deleted_after_a_crash_of_the_server(data: Path, tmp_path: Path) -> None:
    server = Served(data)
    server.end(by=9)
    data_option = ("--data", str(data))
    assert len(output("runs", "list", *data_option, folder=tmp_path)["items"]) == 2
    assert output("runs", "delete", RACED, *data_option, folder=tmp_path) == {"deleted": RACED}
    with opened(data, None) as store:
        store.create(training("zz", state="running"))
    # No server holds the lock, so the run is interrupted and can be deleted.
    done = hexapods("runs", "delete", "zz", *data_option, folder=tmp_path)
    assert (done.returncode, done.stdout) == (0, "Deleted training zz.\n")
    assert "The last server died: 1 runs are interrupted" in done.stderr
    assert "no run 'zz'" in refusal("runs", "show", "zz", *data_option, folder=tmp_path)
