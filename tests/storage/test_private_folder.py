"""The data folder is closed to other users, and nothing that is not the server's is changed."""

import logging
import os
from pathlib import Path

import pytest

from app.settings import Settings
from app.storage.database.opening import ARTIFACTS_FOLDER, DATABASE_FILE, ENTRIES, open_store
from app.storage.private_folder import exposed_paths, make_private
from app.storage.server_lock import LOCK_FILE
from tests.storage.stores import training


def modes(folder: Path) -> dict[str, int]:
    """Return the permissions of a folder and of its entries, by name."""
    return {path.name: path.stat().st_mode & 0o777 for path in (folder, *folder.iterdir())}


def open_to_all(folder: Path) -> None:
    """Give everyone the permissions that a start of version 0.1 left."""
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)


def test_a_new_folder_is_closed_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        with open_store(Settings(data=tmp_path / "above" / "data")) as store:
            store.create(training("t1"))
            modes_in_folder = modes(tmp_path / "above" / "data")
            names = (DATABASE_FILE, f"{DATABASE_FILE}-wal", f"{DATABASE_FILE}-shm", LOCK_FILE)
            assert {modes_in_folder[name] for name in names} == {0o600}
            assert modes_in_folder["data"] == modes_in_folder[ARTIFACTS_FOLDER] == 0o700
    finally:
        os.umask(before)
    # Folders above are no business of the server.
    assert modes(tmp_path)["above"] == 0o777


def test_an_existing_folder_is_closed_and_its_runs_stay(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with open_store(Settings(data=tmp_path)) as store:
        store.create(training("t1", state="finished"))
    open_to_all(tmp_path)
    assert set(exposed_paths(tmp_path, ENTRIES)) == {tmp_path, *tmp_path.iterdir()}
    with caplog.at_level(logging.INFO), open_store(Settings(data=tmp_path)) as store:
        assert store.get("t1").state == "finished"
        assert exposed_paths(tmp_path, ENTRIES) == []
        assert all(mode & 0o077 == 0 for mode in modes(tmp_path).values())
    assert f"can no longer open {tmp_path}, {tmp_path / DATABASE_FILE}" in caplog.text


def test_a_folder_with_other_things_stays_as_it_is(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with open_store(Settings(data=tmp_path)):
        pass
    (tmp_path / "site").mkdir()
    open_to_all(tmp_path)
    make_private(tmp_path, ENTRIES)
    modes_in_folder = modes(tmp_path)
    assert (modes_in_folder.pop(tmp_path.name), modes_in_folder.pop("site")) == (0o755, 0o755)
    assert all(mode & 0o077 == 0 for mode in modes_in_folder.values())
    assert exposed_paths(tmp_path, ENTRIES) == [tmp_path]
    assert f"can open {tmp_path};" in caplog.text


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    data, elsewhere = tmp_path / "data", tmp_path / "elsewhere"
    data.mkdir()
    elsewhere.mkdir(mode=0o755)
    (data / ARTIFACTS_FOLDER).symlink_to(elsewhere)
    make_private(data, ENTRIES)
    assert elsewhere.stat().st_mode & 0o777 == 0o755
    assert data.stat().st_mode & 0o777 == 0o700
