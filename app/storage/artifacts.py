"""Artifact files of runs: written atomically, immutable, verified by SHA-256 on every read.

A file is written to a `.part` file, synced and renamed to a random name (see `hexapods.files`); the
database maps runs and artifact names to these files. Replacing an artifact therefore writes the
new file before the old one is deleted, and a crash leaves at most orphaned files.
"""

import hashlib
import os
import re
import secrets
import threading
from collections.abc import Collection, Iterable, Iterator, Sized
from contextlib import closing, suppress
from pathlib import Path
from typing import NamedTuple

from app.storage.artifact_file import ArtifactFile, SharedFile
from app.storage.disk_space import DiskSpace
from app.storage.errors import StorageFailed, StorageFull
from hexapods.domain.errors import DamagedFile
from hexapods.files import is_disk_full, write_atomically

_HASH_CHUNK_BYTES = 1 << 20
_ARTIFACT_NAME = re.compile(r"\.?[0-9a-f]{32}(\.part)?")


class StoredFile(NamedTuple):
    """An artifact file as recorded in the database.

    Attributes:
        file: its random name in the artifacts folder.
        size: its length [bytes].
        sha256: of its content, hexadecimal.
    """

    file: str
    size: int
    sha256: str


class ArtifactFiles:
    """Folder with the artifact files of one database. Thread-safe."""

    def __init__(self, folder: Path, disk_space: DiskSpace) -> None:
        """Read and write artifact files in a folder.

        Args:
            folder: for the artifact files alone; must exist before the first write.
            disk_space: quota and free space to check before each write.
        """
        self._folder, self._disk_space = folder, disk_space
        self._open: dict[str, SharedFile] = {}
        self._open_lock = threading.RLock()

    def write(
        self, data: bytes | memoryview | Iterable[bytes], size: int | None = None
    ) -> StoredFile:
        """Write data to a new file by atomic rename; it is durable (fsync) on return.

        Args:
            data: all of it, or chunks.
            size: of chunks, about [bytes]; so much space is needed.

        Raises:
            StorageFull: if the quota or the disk is full; nothing is left behind then.
            StorageFailed: if it cannot be written for another reason.
        """
        chunks = [data] if isinstance(data, bytes | memoryview) else data
        self._disk_space.check(size or (len(data) if isinstance(data, Sized) else 0))
        name, digest, length = secrets.token_hex(16), hashlib.sha256(), 0

        def counted() -> Iterator[bytes | memoryview]:
            nonlocal length
            for chunk in chunks:
                digest.update(chunk)
                length += len(chunk)
                yield chunk

        try:
            write_atomically(self._folder / name, counted())
        except OSError as error:
            self.remove(name)
            if is_disk_full(error):
                raise StorageFull(
                    "the disk of the data folder is full; delete runs, or make room there"
                ) from error
            raise StorageFailed(
                f"a file cannot be written to the data folder ({error.strerror})"
            ) from error
        return StoredFile(name, length, digest.hexdigest())

    def check_disk_space(self, size: int) -> None:
        """Check that `size` more bytes fit into the quota and onto the disk.

        Raises:
            StorageFull: if they do not.
        """
        self._disk_space.check(size)

    def read(self, stored: StoredFile, label: str) -> bytes:
        """Read a file and verify its size and SHA-256; arguments and errors as for `open`."""
        with closing(self._open_unverified(stored, label)) as reader:
            return b"".join(_verified_chunks(reader, stored, label))

    def open(self, stored: StoredFile, label: str) -> ArtifactFile:
        """Open a file for reading in chunks, after verifying its size and SHA-256.

        Args:
            stored: record of the file in the database.
            label: name of the file for error messages.

        Raises:
            FileNotFoundError: if the file does not exist.
            DamagedFile: if its content is not what was written.
            StorageFailed: if it cannot be read.
        """
        reader = self._open_unverified(stored, label)
        try:
            for _ in _verified_chunks(reader, stored, label):
                pass
        except BaseException:
            reader.close()
            raise
        return reader

    def _open_unverified(self, stored: StoredFile, label: str) -> ArtifactFile:
        """Open a file without verifying it; arguments and errors as for `open`.

        All readers of a file share one descriptor.
        """
        name = stored.file
        if not _is_artifact_name(name):
            raise DamagedFile(f"{label} is damaged: the database names no file of ours")

        def on_last_close() -> None:
            with self._open_lock:
                if self._open.get(name) is shared:
                    del self._open[name]

        with self._open_lock:
            shared = self._open.get(name)
            reader = None if shared is None else shared.reader(on_last_close)
            if reader is not None:
                return reader
            try:
                file = (self._folder / name).open("rb", buffering=0)
            except FileNotFoundError:
                raise
            except OSError as error:
                raise StorageFailed(f"{label} cannot be read ({error.strerror})") from error
            shared = self._open[name] = SharedFile(file, os.fstat(file.fileno()).st_size)
            return shared.first_reader(on_last_close)

    def remove(self, *names: str) -> None:
        """Delete files, ignoring those that do not exist or cannot be deleted."""
        for name in filter(_is_artifact_name, names):
            # A file that cannot be deleted now is an orphan, which the next start deletes.
            with suppress(OSError):
                (self._folder / name).unlink()

    def delete_orphans(self, referenced: Collection[str]) -> int:
        """Delete the files of interrupted writes and deletes: all that no run references.

        Args:
            referenced: names of the files that the database references.

        Returns:
            the number of orphaned files.
        """
        existing = [path.name for path in self._folder.iterdir() if _is_artifact_name(path.name)]
        orphans = set(existing) - set(referenced)
        self.remove(*orphans)
        return len(orphans)


def _verified_chunks(file: ArtifactFile, stored: StoredFile, label: str) -> Iterator[bytes]:
    """Iterate over a whole file; raise at the end if its size or SHA-256 is not as stored."""
    digest = hashlib.sha256()
    try:
        for offset in range(0, file.size, _HASH_CHUNK_BYTES):
            chunk = file.read_at(offset, _HASH_CHUNK_BYTES)
            digest.update(chunk)
            yield chunk
    except OSError as error:
        raise StorageFailed(f"{label} cannot be read ({error.strerror})") from error
    if file.size != stored.size or digest.hexdigest() != stored.sha256:
        raise DamagedFile(f"{label} is damaged: it is not what was written")


def _is_artifact_name(name: object) -> bool:
    """Whether a name has the form that `write` creates, and so cannot escape the folder."""
    return isinstance(name, str) and _ARTIFACT_NAME.fullmatch(name) is not None
