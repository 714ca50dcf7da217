"""Chunked reading of artifact files, so that memory use does not depend on their size.

Concurrent readers of one file share a file descriptor, which is closed with the last reader.
"""

import io
import threading
from collections.abc import Callable, Iterable, Iterator
from typing import BinaryIO, TypeVar

T = TypeVar("T")
CHUNK_BYTES = 32 << 10
"""Chunk size: the bytes held in memory for each client while it receives them."""


class SharedFile:
    """Reference-counted file descriptor, shared by all concurrent readers of one file.

    Sharing bounds the number of open descriptors when many clients download the same file.

    Attributes:
        size: length of the file [bytes].
    """

    def __init__(self, file: BinaryIO, size: int) -> None:
        """Take ownership of an open file, which is closed with its last reader."""
        self.size = size
        self._file = file
        self._readers = 0
        # Reentrant: the garbage collector may close a reader on a thread that is in `read_at`.
        self._lock = threading.RLock()

    def reader(self, on_last_close: Callable[[], None]) -> "ArtifactFile | None":
        """Return a further reader; None if the last one was closed, and the file with it.

        Args:
            on_last_close: called after the last reader and the file were closed.
        """
        with self._lock:
            return None if self._file.closed else self.first_reader(on_last_close)

    def first_reader(self, on_last_close: Callable[[], None]) -> "ArtifactFile":
        """Return the first reader of a file that was just opened; see `reader`."""
        with self._lock:
            self._readers += 1
        return ArtifactFile(self, on_last_close)

    def read_at(self, offset: int, length: int) -> bytes:
        """Read `length` bytes from an offset on; fewer only at the end of the file."""
        with self._lock:
            self._file.seek(offset)
            return self._file.read(length)

    def release(self) -> bool:
        """Decrement the reference count; close the file and return True at zero."""
        with self._lock:
            self._readers -= 1
            if self._readers == 0:
                self._file.close()
            return self._readers == 0


class ArtifactFile:
    """An open, immutable artifact file: one reader of a `SharedFile`. Thread-safe."""

    def __init__(self, shared: SharedFile, on_last_close: Callable[[], None]) -> None:
        self._shared: SharedFile | None = shared
        self._on_last_close = on_last_close
        self._size = shared.size

    @property
    def size(self) -> int:
        """Length of the file [bytes]."""
        return self._size

    def read_at(self, offset: int, length: int) -> bytes:
        """Read `length` bytes from an offset on; fewer only at the end of the file."""
        if self._shared is None:
            raise ValueError("the file is closed")
        return self._shared.read_at(offset, length)

    def close(self) -> None:
        """Close this reader; the last one closes the file."""
        shared, self._shared = self._shared, None
        if shared is not None and shared.release():
            self._on_last_close()

    def __del__(self) -> None:
        # The generator of a response that was never started does not run its `finally`.
        self.close()


def chunks(file: ArtifactFile) -> Iterator[bytes]:
    """Iterate over a file in chunks; it is closed at the end, or with the iterator."""
    offsets = range(0, file.size, CHUNK_BYTES)
    return closing_after(file, (file.read_at(offset, CHUNK_BYTES) for offset in offsets))


def closing_after(file: ArtifactFile, parts: Iterable[T]) -> Iterator[T]:
    """Iterate over parts derived from a file, closing it at the end, or with the iterator."""
    try:
        yield from parts
    finally:
        file.close()


class ReadableArtifact(io.RawIOBase):
    """Adapter from `ArtifactFile` to a readable, seekable binary file object."""

    def __init__(self, file: ArtifactFile) -> None:
        super().__init__()
        self._artifact, self._offset = file, 0

    def readable(self) -> bool:
        """Return True."""
        return True

    def seekable(self) -> bool:
        """Return True."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Set the read position, and return it."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._offset, io.SEEK_END: self._artifact.size}
        self._offset = max(0, base[whence] + offset)
        return self._offset

    def tell(self) -> int:
        """Return the read position."""
        return self._offset

    def readinto(self, buffer: "bytearray | memoryview") -> int:  # type: ignore[override]
        """Read into a buffer, and return the number of bytes read; 0 at the end."""
        data = self._artifact.read_at(self._offset, len(buffer))
        buffer[: len(data)] = data
        self._offset += len(data)
        return len(data)
