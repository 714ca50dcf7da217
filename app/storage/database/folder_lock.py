"""File lock on a data folder, so that one server at a time uses it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.domain.errors import InvalidInput
from app.files import lock_file

LOCK_FILE = "server.lock"


class FolderInUse(InvalidInput):
    """Another process holds the lock of the data folder."""


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Hold an exclusive file lock; the operating system releases it when the process ends.

    Raises:
        FolderInUse: if another process holds the lock.
    """
    # The file is never deleted: another process may have opened it, and would lock a dead inode.
    with (folder / LOCK_FILE).open("ab") as file:
        try:
            lock_file(file)
        except OSError as error:
            raise FolderInUse(
                f"another server uses the data folder {folder}; stop it, or choose another "
                "folder with --data or HEXAPODS_DATA"
            ) from error
        yield
