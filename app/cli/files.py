"""Read and atomically write files that users name, with clear errors."""

import tempfile
from pathlib import Path

from hexapods.domain.errors import InvalidInput
from hexapods.files import write_atomically


def check_writable(path: str) -> None:
    """Check that a file can be written, before the work whose result it stores.

    Raises:
        InvalidInput: if it cannot.
    """
    folder = Path(path).absolute().parent
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InvalidInput(
            f"cannot write {path}: {error.strerror}; choose a folder that can be written"
        ) from error
    if Path(path).is_dir():
        raise InvalidInput(f"cannot write {path}: it is a folder; name a file")


def read_bounded(path: str, most_bytes: int) -> bytes:
    """Return the content of a file, or of a larger one as much as shows that it is too large.

    Args:
        path: of the file.
        most_bytes: that are read; of a larger file one more.

    Raises:
        InvalidInput: if it cannot be read.
    """
    try:
        with Path(path).open("rb") as file:
            return file.read(most_bytes + 1)
    except OSError as error:
        raise InvalidInput(f"cannot read {path}: {error.strerror}") from error


def write_whole(path: str, data: bytes) -> None:
    """Write a file atomically; raise `InvalidInput` if it cannot be written."""
    try:
        write_atomically(Path(path).absolute(), data)
    except OSError as error:
        raise InvalidInput(f"cannot write {path}: {error.strerror}") from error


def size_text(size: int) -> str:
    """Return the size of a file for people."""
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.0f} kB"
