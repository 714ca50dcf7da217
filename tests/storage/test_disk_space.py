"""New runs are refused before the quota or the disk is full; other operations go through."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.jobs.submissions import TrainingStart
from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.disk_space import MB, MIN_FREE_BYTES, START_BYTES, DiskSpace
from app.storage.errors import StorageFull
from app.storage.recordings import Recordings
from app.storage.run import QUEUED, TABLE
from hexapods.runs.config import training_config
from tests.storage.stores import training

QUOTA_MB = 12
START = TrainingStart(training_config(gait="left-right-origin", simulator="kinematic"))


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    with open_store(Settings(data=tmp_path, quota_mb=QUOTA_MB)) as opened_store:
        yield opened_store


def test_start_is_refused_if_the_quota_leaves_too_little(store: RunStore) -> None:
    jobs = Jobs(store, Recordings(store), EventBus())  # not opened, so that all runs stay queued
    store.create(training("0old"))
    store.put_artifact("0old", TABLE, bytes(6 * MB))
    with pytest.raises(StorageFull, match="raise HEXAPODS_QUOTA_MB"):
        jobs.start(START)
    with pytest.raises(StorageFull, match="delete runs"):
        store.check_disk_space()
    assert [run.id for run in store.list().items] == ["0old"]
    # Existing runs may use the remaining space, and everything can be read.
    store.put_artifact("0old", "race.npz", bytes(1 * MB))
    assert store.artifact("0old", TABLE) == bytes(6 * MB)
    store.change("0old", QUEUED, "stopped")
    store.delete("0old")
    assert jobs.start(START).state == "queued"


def test_start_is_refused_if_the_disk_leaves_too_little(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Usage(NamedTuple):
        free: int

    disk_space, needed = DiskSpace(tmp_path), START_BYTES + MIN_FREE_BYTES
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: Usage(needed))
    disk_space.check(START_BYTES)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: Usage(needed - 1))
    with pytest.raises(StorageFull, match="the disk of the data folder has"):
        disk_space.check(START_BYTES)
