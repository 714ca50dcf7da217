"""Write files by atomic rename or in chunks, and lock them between processes."""

import errno
import io
import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from hexapods.domain.errors import InvalidInput

_DISK_FULL_ERRNOS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


def path_of(value: object, what: str) -> Path:
    """Return a path that a user gave as text or as a `PathLike`.

    Args:
        value: the path.
        what: kind of file, to begin an error message: `a table`.

    Raises:
        InvalidInput: if it is none, or cannot be the path of anything.
    """
    text = os.fspath(value) if isinstance(value, str | os.PathLike) else None
    if not isinstance(text, str) or not text or "\0" in text:
        raise InvalidInput(f"{what} is given by its path, a text or a Path, not by {value!r}")
    return Path(text)


def write_atomically(path: Path, data: bytes | memoryview | Iterable[bytes | memoryview]) -> None:
    """Write a file that is durable (fsync) on return; after a crash it is the old or the new one.

    The data, whole or in chunks, is written to `.{name}.part` beside the file, then renamed; a
    crash may leave that.

    Raises:
        OSError: if it cannot be written; no partial file is left.
    """
    partial = path.with_name(f".{path.name}.part")
    try:
        with partial.open("wb") as file:
            file.writelines([data] if isinstance(data, bytes | memoryview) else data)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
        sync_folder(path.parent)
    except BaseException:
        with suppress(OSError):
            partial.unlink()
        raise


def sync_folder(folder: Path) -> None:
    """Sync a folder, so that renames in it are durable; does nothing on Windows."""
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def is_disk_full(error: OSError) -> bool:
    """Whether a write failed because the disk, a quota or the allowed file size is used up."""
    return error.errno in _DISK_FULL_ERRNOS


class DrainedBuffer(io.RawIOBase):
    """Unseekable output of a writer of files, drained after each chunk that it wrote."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, data: Any) -> int:
        """Append bytes, and return their number."""
        self._parts.append(bytes(data))
        return len(data)

    def drain(self) -> bytes:
        """Return the bytes written since the last call, and clear the buffer."""
        data = b"".join(self._parts)
        self._parts.clear()
        return data


if sys.platform == "win32":
    import msvcrt

    def lock_file(file: IO[bytes]) -> None:
        """Lock an open file exclusively, until it is closed.

        Raises:
            OSError: if another process has locked it.
        """
        position = file.tell()
        file.seek(2**40)  # a mandatory lock on a byte range, so beyond all data
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        file.seek(position)

else:
    import fcntl

    def lock_file(file: IO[bytes]) -> None:
        """Lock an open file exclusively, until it is closed.

        Raises:
            OSError: if another process has locked it.
        """
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
