"""A data folder belongs to one server at a time."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from app.domain.errors import InvalidInput

LOCK_FILE = "server.lock"


class FolderInUse(InvalidInput):
    """Another process has the data folder."""


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keep others out. The system lets go of the lock when the process ends, however it ends.

    Raises:
        FolderInUse: if another process has the folder.
    """
    # Never removed: another process may have opened it already, and would lock nothing.
    with (folder / LOCK_FILE).open("ab") as file:
        try:
            _lock(file)
        except OSError as error:
            raise FolderInUse(
                f"another server uses the data folder {folder}; stop it, or choose another "
                "folder with --data or HEXAPODS_DATA"
            ) from error
        yield


if sys.platform == "win32":
    import msvcrt

    def _lock(file: IO[bytes]) -> None:
        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[bytes]) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
