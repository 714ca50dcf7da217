"""Files of runs on disk: whole or not there, checked when they are read.

Each is written once, under a name made of chance, and never changed; which run it belongs to is
the database's to say. So a file that takes another's place is there before the other goes.
"""

import errno
import hashlib
import os
import re
import secrets
import sys
import threading
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from app.domain.errors import DamagedFile
from app.storage.artifact_file import ArtifactFile, SharedFile
from app.storage.disk_space import DiskSpace
from app.storage.errors import StorageFailed, StorageFull

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_HASHED_AT_ONCE = 1 << 20
_OURS = re.compile(r"[0-9a-f]{32}(\.part)?")


class Stored(NamedTuple):
    """A file as the database remembers it."""

    file: str
    size: int
    sha256: str


class ArtifactFiles:
    """The files of one database, in a folder of their own."""

    def __init__(self, folder: Path, room: DiskSpace) -> None:
        """Use a folder, which is made if it is not there."""
        folder.mkdir(parents=True, exist_ok=True)
        sync_folder(folder.parent)
        self._folder, self._room = folder, room
        self._open: dict[str, SharedFile] = {}
        self._opening = threading.RLock()

    def write(self, data: bytes) -> Stored:
        """Keep data in a new file. When this returns, it lasts.

        Raises:
            StorageFull: if there is no room; nothing is left behind then.
            StorageFailed: if it cannot be written for another reason.
        """
        self._room.check(len(data))
        name = secrets.token_hex(16)
        part = self._folder / f"{name}.part"
        try:
            with part.open("xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            part.rename(self._folder / name)
            sync_folder(self._folder)
        except OSError as error:
            self.remove(name, part.name)
            if error.errno in _FULL:
                raise StorageFull(
                    "the disk of the data folder is full; delete runs, or make room there"
                ) from error
            raise StorageFailed(
                f"a file cannot be written to the data folder ({error.strerror})"
            ) from error
        return Stored(name, len(data), hashlib.sha256(data).hexdigest())

    def check_room(self, size: int) -> None:
        """Make sure that there is room for so much more.

        Raises:
            StorageFull: if there is not.
        """
        self._room.check(size)

    def read(self, stored: Stored, said: str) -> bytes:
        """What was written.

        Args:
            stored: what is known of the file.
            said: what to call it in messages.

        Raises:
            FileNotFoundError: if it is not there.
            DamagedFile: if it is not what was written.
            StorageFailed: if it cannot be read.
        """
        if not _is_ours(stored.file):
            raise DamagedFile(f"{said} is damaged: the database names no file of ours")
        try:
            data = (self._folder / stored.file).read_bytes()
        except FileNotFoundError:
            raise
        except OSError as error:
            raise StorageFailed(f"{said} cannot be read ({error.strerror})") from error
        if len(data) != stored.size or hashlib.sha256(data).hexdigest() != stored.sha256:
            raise DamagedFile(f"{said} is damaged: it is not what was written")
        return data

    def open(self, stored: Stored, said: str) -> ArtifactFile:
        """Open a file, once it is found to be what was written.

        Args:
            stored: what is known of the file.
            said: what to call it in messages.

        Raises:
            FileNotFoundError: if it is not there.
            DamagedFile: if it is not what was written.
            StorageFailed: if it cannot be read.
        """
        reader = self._reader(stored, said)
        try:
            digest = hashlib.sha256()
            for offset in range(0, reader.size, _HASHED_AT_ONCE):
                digest.update(reader.read_at(offset, _HASHED_AT_ONCE))
        except OSError as error:
            reader.close()
            raise StorageFailed(f"{said} cannot be read ({error.strerror})") from error
        if reader.size != stored.size or digest.hexdigest() != stored.sha256:
            reader.close()
            raise DamagedFile(f"{said} is damaged: it is not what was written")
        return reader

    def _reader(self, stored: Stored, said: str) -> ArtifactFile:
        name = stored.file

        def forget() -> None:
            with self._opening:
                if self._open.get(name) is shared:
                    del self._open[name]

        with self._opening:
            shared = self._open.get(name)
            reader = None if shared is None else shared.reader(forget)
            if reader is not None:
                return reader
            try:
                file = (self._folder / name).open("rb", buffering=0)
            except FileNotFoundError:
                raise
            except OSError as error:
                raise StorageFailed(f"{said} cannot be read ({error.strerror})") from error
            shared = self._open[name] = SharedFile(file, os.fstat(file.fileno()).st_size)
            return shared.first_reader(forget)

    def remove(self, *names: str) -> None:
        """Take files away; those that are not there do not matter."""
        for name in filter(_is_ours, names):
            # One that stays for now is swept up at the next start.
            with suppress(OSError):
                (self._folder / name).unlink()

    def sweep(self, known: Collection[str]) -> int:
        """Remove what an interrupted write or delete left behind: all that is not known.

        Returns:
            how many files that were.
        """
        found = [path.name for path in self._folder.iterdir() if _is_ours(path.name)]
        left_behind = set(found) - set(known)
        self.remove(*left_behind)
        return len(left_behind)


def _is_ours(name: object) -> bool:
    """Whether a name is one of those that are made here, and so no path out of the folder."""
    return isinstance(name, str) and _OURS.fullmatch(name) is not None


def sync_folder(folder: Path) -> None:
    """Let names in a folder last, where a system leaves that open."""
    if sys.platform == "win32":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
