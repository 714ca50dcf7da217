"""Artifact files: atomic writes, detection of damage, quota and reserve."""

import errno
import os
from pathlib import Path
from typing import Any

import pytest

from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.database.store import RunStore
from app.storage.disk_space import MB, RESERVE_BYTES, DiskSpace
from app.storage.errors import NotFound, StorageFailed, StorageFull
from hexapods.domain.errors import DamagedFile
from tests.storage.stores import opened, training


@pytest.fixture
def files(tmp_path: Path) -> ArtifactFiles:
    (tmp_path / "files").mkdir()
    return ArtifactFiles(tmp_path / "files", DiskSpace(tmp_path))


def names(tmp_path: Path) -> list[str]:
    return [path.name for path in (tmp_path / "files").iterdir()]


def test_failed_write_leaves_nothing_behind(
    files: ArtifactFiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(handle: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    stored = files.write(b"old")
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(StorageFull, match="make room"):
            files.write(b"new")
    assert names(tmp_path) == [stored.file]
    assert files.read(stored, "it") == b"old"


def test_missing_folder_is_reported(files: ArtifactFiles, tmp_path: Path) -> None:
    (tmp_path / "files").rmdir()
    with pytest.raises(StorageFailed, match="No such file"):
        files.write(b"new")


@pytest.mark.parametrize("damaged", [b"", b"wholf", b"whol", b"wholes", bytes(5)])
def test_damaged_file_is_named_in_the_error(
    files: ArtifactFiles, tmp_path: Path, damaged: bytes
) -> None:
    stored = files.write(b"whole")
    (tmp_path / "files" / stored.file).write_bytes(damaged)
    with pytest.raises(DamagedFile, match="the table of Ben is damaged"):
        files.read(stored, "the table of Ben")


def test_missing_file_is_named_in_the_error(tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        store.create(training("a"))
        store.put_artifact("a", "q-table.npz", b"data")
        for path in (tmp_path / "artifacts").glob("*/*"):
            path.unlink()
        with pytest.raises(DamagedFile, match=r"q-table\.npz of run a is missing"):
            store.artifact("a", "q-table.npz")
        store.put_artifact("a", "q-table.npz", b"again")
        assert store.artifact("a", "q-table.npz") == b"again"


def test_artifact_of_a_deleted_run_is_not_stored(tmp_path: Path) -> None:
    class Slow(ArtifactFiles):
        def write(self, *arguments: Any) -> StoredFile:
            stored = super().write(*arguments)
            store.delete("a")
            return stored

    with opened(tmp_path, None) as opened_store:
        folder = tmp_path / "slow"
        folder.mkdir()
        files = Slow(folder, DiskSpace(tmp_path))
        database, robots, deletions, kinds = (
            getattr(opened_store, name) for name in ("database", "robots", "deletions", "kinds")
        )
        store = RunStore(database, files, robots, deletions, kinds)
        store.create(training("a", state="finished"))
        with pytest.raises(NotFound, match="no run 'a'"):
            store.put_artifact("a", "q-table.npz", b"late")
        assert list(folder.iterdir()) == []


def test_quota_is_enforced(tmp_path: Path) -> None:
    disk_space = DiskSpace(tmp_path, quota_mb=10)
    (tmp_path / "files").mkdir()
    files = ArtifactFiles(tmp_path / "files", disk_space)
    stored = [files.write(bytes(3 * MB)) for _ in range(3)]
    with pytest.raises(StorageFull, match=r"10 MB.*3\.0 MB more.*HEXAPODS_QUOTA_MB"):
        files.write(bytes(3 * MB))
    assert len(names(tmp_path)) == 3
    files.remove(stored[0].file)
    files.write(bytes(3 * MB))


def test_reserve_is_released_once_and_recreated(tmp_path: Path) -> None:
    disk_space = DiskSpace(tmp_path)
    disk_space.reserve()
    assert disk_space.used_bytes() == RESERVE_BYTES
    disk_space.reserve()
    assert disk_space.release()
    assert disk_space.used_bytes() == 0
    assert not disk_space.release()
    disk_space.check(1)
    assert disk_space.used_bytes() == RESERVE_BYTES
