"""A file of a run, read piece by piece, so that no reader takes the memory of all of it."""

import io
import threading
from collections.abc import Callable, Iterable, Iterator
from typing import BinaryIO, Protocol, TypeVar

T = TypeVar("T")
PIECE_BYTES = 32 << 10
"""What is read at once for a client; it is held while the client takes it."""


class ArtifactFile(Protocol):
    """An open file, immutable as all artifacts. Safe to use from any thread; `with` closes it."""

    @property
    def size(self) -> int:
        """Its length in bytes."""

    def read_at(self, offset: int, length: int) -> bytes:
        """The bytes from an offset on; fewer than asked for at the end only."""

    def close(self) -> None:
        """Let go of it. May be called twice."""


class BytesFile:
    """Bytes in memory, read like a file."""

    def __init__(self, data: bytes) -> None:
        self._data = data

    @property
    def size(self) -> int:
        """Its length in bytes."""
        return len(self._data)

    def read_at(self, offset: int, length: int) -> bytes:
        """The bytes from an offset on."""
        return self._data[offset : offset + length]

    def close(self) -> None:
        """Do nothing."""


class SharedFile:
    """One descriptor for all who read a file at the same time: a crowd must not use them up.

    Attributes:
        size: in bytes.
    """

    def __init__(self, file: BinaryIO, size: int) -> None:
        """Own an open file, until its last reader is closed."""
        self.size = size
        self._file = file
        self._readers = 0
        # One that the garbage collector closes may be closed in the middle of another's read.
        self._lock = threading.RLock()

    def reader(self, on_last: Callable[[], None]) -> "SharedReader | None":
        """One more reader; None if the last one is gone, and the file is closed.

        Args:
            on_last: called when the last reader was closed, with the file.
        """
        with self._lock:
            return None if self._file.closed else self.first_reader(on_last)

    def first_reader(self, on_last: Callable[[], None]) -> "SharedReader":
        """The reader of a file that was just opened; see `reader`."""
        with self._lock:
            self._readers += 1
        return SharedReader(self, on_last)

    def read_at(self, offset: int, length: int) -> bytes:
        """The bytes from an offset on."""
        with self._lock:
            self._file.seek(offset)
            return self._file.read(length)

    def release(self) -> bool:
        """Count one reader less; whether it was the last one, and the file is closed now."""
        with self._lock:
            self._readers -= 1
            if self._readers == 0:
                self._file.close()
            return self._readers == 0


class SharedReader:
    """One reader's share in a file."""

    def __init__(self, shared: SharedFile, on_last: Callable[[], None]) -> None:
        self._shared: SharedFile | None = shared
        self._on_last = on_last
        self._size = shared.size

    @property
    def size(self) -> int:
        """Its length in bytes."""
        return self._size

    def read_at(self, offset: int, length: int) -> bytes:
        """The bytes from an offset on."""
        if self._shared is None:
            raise ValueError("the file is closed")
        return self._shared.read_at(offset, length)

    def close(self) -> None:
        """Let go of it; the last reader closes the file."""
        shared, self._shared = self._shared, None
        if shared is not None and shared.release():
            self._on_last()

    def __del__(self) -> None:
        # A response that was never begun has nobody else to close its file.
        self.close()


def pieces(file: ArtifactFile) -> Iterator[bytes]:
    """All of a file in pieces; it is closed at the end, or with the iterator."""
    offsets = range(0, file.size, PIECE_BYTES)
    return closing_after(file, (file.read_at(offset, PIECE_BYTES) for offset in offsets))


def closing_after(file: ArtifactFile, parts: Iterable[T]) -> Iterator[T]:
    """What is made of a file, which is closed at the end, or with the iterator."""
    try:
        yield from parts
    finally:
        file.close()


class ReadableArtifact(io.RawIOBase):
    """An artifact as a binary file object that can be read and sought in."""

    def __init__(self, file: ArtifactFile) -> None:
        super().__init__()
        self._artifact, self._offset = file, 0

    def readable(self) -> bool:
        """It is."""
        return True

    def seekable(self) -> bool:
        """It is."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to an offset."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._offset, io.SEEK_END: self._artifact.size}
        self._offset = max(0, base[whence] + offset)
        return self._offset

    def tell(self) -> int:
        """Where the next read begins."""
        return self._offset

    def readinto(self, buffer: "bytearray | memoryview") -> int:  # type: ignore[override]
        """Read into a buffer, as much as there is."""
        data = self._artifact.read_at(self._offset, len(buffer))
        buffer[: len(data)] = data
        self._offset += len(data)
        return len(data)
