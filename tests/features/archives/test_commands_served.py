"""`hexapods export` and `import` beside a server, which makes the changes."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import hexapods, output, refusal
from tests.served import Served
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

TRAINING, RACED, TOKEN = "00000000000t1", "00000000000r1", "a-token-for-tests"


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with a finished training and race."""
    folder = tmp_path_factory.mktemp("data")
    with opened(folder, None) as store:
        ended_training(store, TRAINING)
        ended_race(store, RACED, TRAINING)
    return folder


@pytest.fixture(scope="module")
def server(data: Path) -> Iterator[Served]:
    served = Served(data, HEXAPODS_TOKEN=TOKEN)
    yield served
    served.end()


def test_runs_are_imported_by_the_running_server(
    server: Served, data: Path, tmp_path: Path
) -> None:
    data_option = ("--data", str(data))
    output("export", RACED, "--out", "run.zip", *data_option, folder=tmp_path)
    exported = server.client.get(f"/api/v1/races/{RACED}/export")
    assert exported.content == (tmp_path / "run.zip").read_bytes()
    assert "race-" in exported.headers["content-disposition"]
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    assert server.client.delete(f"/api/v1/races/{RACED}", headers=bearer).status_code == 204
    done = hexapods(
        "import", "run.zip", "--json", *data_option, folder=tmp_path, HEXAPODS_TOKEN=TOKEN
    )
    assert json.loads(done.stdout)["id"] == RACED, done.stderr
    shown = server.client.get(f"/api/v1/races/{RACED}").json()
    assert shown["result"]["lanes"][1]["agent"] == "greedy"
    assert server.client.get(f"/api/v1/races/{RACED}/recording").status_code == 200


def test_refusals_of_the_server_are_reported(server: Served, data: Path, tmp_path: Path) -> None:
    (tmp_path / "junk.zip").write_bytes(b"milk")
    data_option = ("--data", str(data))
    said = refusal("import", "junk.zip", *data_option, folder=tmp_path, HEXAPODS_TOKEN=TOKEN)
    assert "is no archive of a run" in said
    assert server.address in said


def test_import_route_checks_token_archive_and_size(server: Served) -> None:
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    post: Any = server.client.post
    assert post("/api/v1/import", content=b"x").status_code == 401
    assert post("/api/v1/import", content=b"", headers=bearer).status_code == 422
    assert post("/api/v1/import", content=b"PK\5\6" * 9, headers=bearer).status_code == 422
    large = post("/api/v1/import", content=bytes((64 << 20) + 1), headers=bearer)
    assert large.status_code == 413
    assert server.client.get("/api/v1/trainings/import/export").status_code == 404
