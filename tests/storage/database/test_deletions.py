"""What is deleted comes back for an hour, takes its room until then, and is gone after it."""

from datetime import datetime, timedelta
from pathlib import Path

import pytest

from app.settings import Settings
from app.storage.database.deletions import RESTORABLE
from app.storage.database.opening import open_store
from app.storage.database.schema import RUNS
from app.storage.database.store import RunStore
from app.storage.disk_space import MB, DiskSpace
from app.storage.errors import NotFound, StorageFull
from tests.storage import stores

QUOTA_MB = 12
SECOND = timedelta(seconds=1)


def put(store: RunStore, run_id: str, size: int = 10) -> None:
    """Store a training that has ended, with a file."""
    store.create(stores.training(run_id, state="finished"))
    store.put_artifact(run_id, "q-table.npz", bytes(size))


def set_clock(store: RunStore, time: datetime) -> None:
    store.deletions.now = lambda: time


def test_a_row_comes_back_within_the_hour_with_all_that_it_had(store: RunStore) -> None:
    put(store, "a")
    deleted_at = store.deletions.now()
    set_clock(store, deleted_at)
    before = store.get("a")
    assert store.trash("a") == deleted_at + RESTORABLE
    with pytest.raises(NotFound):
        store.get("a")
    set_clock(store, deleted_at + RESTORABLE)
    assert store.deletions.purge() == 0
    assert store.restore("a") == before
    assert store.restore("a") == before, "it is there already"
    assert store.artifact("a", "q-table.npz") == bytes(10)


def test_an_hour_later_it_is_gone_with_its_files(store: RunStore, tmp_path: Path) -> None:
    put(store, "a")
    put(store, "b")
    deleted_at = store.deletions.now()
    set_clock(store, deleted_at)
    store.trash("a")
    set_clock(store, deleted_at + RESTORABLE + SECOND)
    # Whether it was purged already or not.
    for _ in range(2):
        with pytest.raises(NotFound, match=r"no run 'a'.*what was deleted can be restored for 1 h"):
            store.restore("a")
        store.deletions.purge()
    assert store.deletions.purge() == 0
    assert len(list((tmp_path / "artifacts").glob("*/*"))) == 1
    assert store.artifact("b", "q-table.npz") == bytes(10)


def test_what_was_deleted_takes_its_room_until_the_disk_is_full(tmp_path: Path) -> None:
    stores.copy_new_database(tmp_path)
    with open_store(Settings(data=tmp_path, quota_mb=QUOTA_MB)) as store:
        put(store, "a", MB)
        put(store, "b", MB)
        disk_space = DiskSpace(tmp_path)
        used = disk_space.used_bytes()
        assert store.trash("a") is not None
        assert disk_space.used_bytes() >= used
        put(store, "c", 4 * MB)
        with pytest.raises(StorageFull, match="12 MB"):
            store.check_disk_space()
        # All that was deleted makes room, this one too.
        assert store.trash("b") is None
        store.check_disk_space()
        for run_id in "ab":
            with pytest.raises(NotFound):
                store.restore(run_id)


def test_those_that_were_deleted_first_give_way_to_new_rows(store: RunStore) -> None:
    deleted_at = store.deletions.now()
    for seconds, run_id in enumerate("bcad"):
        put(store, run_id)
        set_clock(store, deleted_at + seconds * SECOND)
        if run_id != "d":
            store.trash(run_id)
    store.deletions.make_room(RUNS, most=4, new=2)
    assert store.restore("a").id == "a"
    for run_id in "bc":
        with pytest.raises(NotFound):
            store.restore(run_id)
    # Those that are there never do.
    store.deletions.make_room(RUNS, most=1)
    assert [run.id for run in store.list().items] == ["d", "a"]
