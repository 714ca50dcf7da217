"""Promise 32: every write is all or nothing.

Promised: `kill -9` and a full disk at each write of start, import, finish and delete: no partial
run is visible, and an orphaned file lasts until the next start at most. Here one in 48 of the
writes, chosen at random, and a kill of a server that imports runs; all of them, and 30 kills, by
`make soak`.
"""

import json
import random
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.storage.disk_space import MB
from app.storage.run import TABLE
from hexapods.domain import robot_documents
from hexapods.domain.robot import as_mapping, document_of, robot
from tests.features.archives.exported import export_run
from tests.promises.breaking_writes import OPERATIONS
from tests.promises.length import at_length
from tests.promises.processes import start_script
from tests.served import Served
from tests.storage.ended_runs import ended_training
from tests.storage.stores import opened

SHARE = at_length(1 / 48, 1.0)
KILLS = at_length(1, 30)
QUOTA_MB = 10


@pytest.mark.timeout(at_length(300, 1800))
def test_an_operation_interrupted_at_any_write_is_all_or_nothing(tmp_path: Path) -> None:
    process = start_script("tests.promises.breaking_writes", str(tmp_path), str(SHARE))
    out, _ = process.communicate()
    assert process.returncode == 0
    whole: dict[str, Any] = {}
    attempts = 0
    for report in map(json.loads, out.splitlines()):
        assert "broke" not in report, report["broke"]
        operation = report["operation"]
        if report["how"] == "none":
            assert report["refused"] is None
            whole[operation] = report
        attempts += report["how"] != "none"
        check(report, whole[operation])
    assert set(whole) == set(OPERATIONS)
    assert all(report["writes"] > 3 for report in whole.values())
    assert attempts >= SHARE * 100


def check(report: dict[str, Any], whole: dict[str, Any]) -> None:
    after = report["after"]
    assert after["missing_files"] == after["files_of_nobody"] == 0, report
    if report["how"] == "kill":
        assert report["killed"], report
        # A completed operation is durable.
        assert report["at"] <= whole["writes"] or after == whole["after"], report
    if report["how"] == "full":
        assert report["at_once"]["files_of_nobody"] == 0, report
        assert report["refused"] or after == whole["after"], report
    if report["operation"] == "finish":
        check_finish(after, whole["after"])
    elif after != whole["after"]:
        assert [run["name"] for run in after["runs"]] == ["Kept"], report
        assert after["key_is_of"] is None


def check_finish(after: dict[str, Any], whole: dict[str, Any]) -> None:
    [stored, learned] = after["runs"]
    [kept_whole, learned_whole] = whole["runs"]
    assert stored == kept_whole
    if learned["state"] == "finished":
        assert learned == learned_whole
    else:
        # It can be resumed, and has neither a result nor a table yet.
        assert (learned["state"], learned["has_result"]) == ("interrupted", False)
        assert not learned["has_table"]
        assert learned["recorded"] <= learned["evaluations"]


@pytest.fixture
def files(tmp_path: Path) -> dict[str, bytes]:
    """A file to import, by the import's path."""
    with opened(tmp_path / "source", None) as store:
        ended_training(store, "00000000000m1", "Moved", steps=120)
        return {
            "/api/v1/import": export_run(store, "00000000000m1"),
            "/api/v1/trainings/import": store.artifact("00000000000m1", TABLE) or b"",
        }


def folder_bytes(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def test_an_import_over_quota_leaves_nothing(
    files: dict[str, bytes], launch: Callable[..., Served], tmp_path: Path
) -> None:
    server = launch(HEXAPODS_QUOTA_MB=str(QUOTA_MB))
    filler = tmp_path / "filler"
    for path, data in files.items():
        headers = {"Idempotency-Key": path}
        # Leave space for half of the file.
        filler.write_bytes(bytes(QUOTA_MB * MB - folder_bytes(tmp_path) - len(data) // 2))
        names = {file.name for file in tmp_path.glob("artifacts/*/*")}
        for _ in range(3):
            answer = server.client.post(path, content=data, headers=headers)
            assert answer.status_code == 507, answer.text
            assert server.client.get("/api/v1/trainings").json()["items"] == []
            assert {file.name for file in tmp_path.glob("artifacts/*/*")} == names
        filler.unlink()
        runs = {
            server.client.post(path, content=data, headers=headers).json()["id"] for _ in range(3)
        }
        assert len(runs) == 1
        assert server.client.delete(f"/api/v1/trainings/{runs.pop()}").status_code == 204
        assert server.client.post(path, content=data, headers=headers).status_code == 410


@pytest.mark.timeout(60 + 30 * KILLS)
def test_a_server_that_is_killed_leaves_no_half_run(
    files: dict[str, bytes], launch: Callable[..., Served], tmp_path: Path
) -> None:
    chance = random.Random(32)
    acknowledged: list[str] = []
    unlimited = {"HEXAPODS_STARTS_PER_MINUTE": "1000000"}
    server = launch(**unlimited)
    for kill in range(KILLS):
        importers = [
            threading.Thread(
                target=import_repeatedly, args=(server.address, path, data, acknowledged)
            )
            for path, data in files.items()
        ]
        for importer in importers:
            importer.start()
        time.sleep(chance.uniform(0.3, at_length(0.8, 2)))
        while kill == KILLS - 1 and not acknowledged:
            time.sleep(0.05)  # on a busy machine none may have been in all rounds
        server.process.send_signal(signal.SIGKILL)
        for importer in importers:
            importer.join()
        server.end(signal.SIGKILL)
        server = launch(**unlimited)
        ids = all_ids(server)
        assert set(acknowledged) <= set(ids)
        for run_id in ids[-20:] + ids[:20]:
            look = server.client.get(f"/api/v1/trainings/{run_id}").json()
            assert look["state"] == "finished"
            table = server.client.get(f"/api/v1/trainings/{run_id}/q-table?format=npz")
            assert table.status_code == 200, table.text
    assert acknowledged


@pytest.mark.timeout(60 + 30 * KILLS)
def test_a_server_that_is_killed_leaves_no_half_robot(
    launch: Callable[..., Served], tmp_path: Path
) -> None:
    chance = random.Random(32)
    unlimited = {"HEXAPODS_STARTS_PER_MINUTE": "1000000"}
    server, robots = launch(**unlimited), AnnouncedRobots()
    for _ in range(KILLS):
        thread = threading.Thread(target=store_repeatedly, args=(server.address, robots))
        seen = len(robots.stored)
        thread.start()
        while len(robots.stored) < seen + 5:
            time.sleep(0.01)
        time.sleep(chance.uniform(0, 0.3))
        server.process.send_signal(signal.SIGKILL)
        thread.join()
        server.end(signal.SIGKILL)
        server = launch(**unlimited)
        ids = [
            stored_robot["id"]
            for stored_robot in server.client.get("/api/v1/robots?hidden=true").json()["items"]
        ]
        expected = robots.stored - robots.deleted
        assert expected - {robots.last} <= set(ids) <= expected | {robots.last}
        for robot_id in ids:
            document = server.client.get(f"/api/v1/robots/{robot_id}/file").content
            assert robot_documents.id_of(document) == robot_id
        # What was deleted can be restored for an hour: its files stay as long.
        files = {path.name for path in tmp_path.glob("robots/*/*")}
        assert {f"{robot_id}.json" for robot_id in ids} <= files
        assert files <= {f"{robot_id}.json" for robot_id in {*ids, *robots.deleted, robots.last}}
        assert robots.deleted - set(ids) - {robots.last} <= {
            name.removesuffix(".json") for name in files
        }


@dataclass
class AnnouncedRobots:
    """Ids of robots that a server confirmed to have stored and deleted; the last one requested."""

    stored: set[str] = field(default_factory=set)
    deleted: set[str] = field(default_factory=set)
    last: str = ""


def store_repeatedly(address: str, robots: AnnouncedRobots) -> None:
    """Store robots, and delete every other one, until the server is gone."""
    with httpx2.Client(base_url=address, timeout=60, trust_env=False) as client:
        while True:
            new_robot = robot({"preset": "dog", "femur_m": 0.07 + 1e-6 * len(robots.stored)})
            robots.last = robot_documents.id_of(document_of(new_robot))
            try:
                answer = client.post("/api/v1/robots", json={"robot": as_mapping(new_robot)})
                assert answer.status_code in (200, 201), answer.text
                robots.stored.add(robots.last)
                if len(robots.stored) % 4:
                    client.delete(f"/api/v1/robots/{robots.last}").raise_for_status()
                    robots.deleted.add(robots.last)
            except httpx2.TransportError:
                return


def all_ids(server: Served) -> list[str]:
    page = server.client.get("/api/v1/trainings?limit=100").json()
    ids = [run["id"] for run in page["items"]]
    while page["next_cursor"] is not None:
        where = f"/api/v1/trainings?limit=100&cursor={page['next_cursor']}"
        page = server.client.get(where).json()
        ids += [run["id"] for run in page["items"]]
    return ids


def import_repeatedly(address: str, path: str, data: bytes, acknowledged: list[str]) -> None:
    """Import a file repeatedly, until the server is gone."""
    with httpx2.Client(base_url=address, timeout=60, trust_env=False) as client:
        while True:
            try:
                answer = client.post(path, content=data)
            except httpx2.TransportError:
                return
            assert answer.status_code == 201, answer.text
            acknowledged.append(answer.json()["id"])
