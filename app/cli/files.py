"""Files that users name: read with a clear error, written whole or not at all."""

import tempfile
from pathlib import Path

from app.domain.errors import InvalidInput
from app.files import write_atomically
from app.runs.tables import Checkpoint, from_bytes


def read_table(path: str) -> Checkpoint:
    """A Q-table from a file.

    Raises:
        InvalidInput: if there is no such file.
        DamagedFile: if it is not a whole table.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InvalidInput(f"cannot read the table {path}: {error.strerror}") from error
    return from_bytes(data, path)


def check_writable(path: str) -> None:
    """Raise `InvalidInput` now rather than after the work is done."""
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


def write_whole(path: str, data: bytes) -> None:
    """Write a file atomically; raise `InvalidInput` if it cannot be written."""
    try:
        write_atomically(Path(path).absolute(), data)
    except OSError as error:
        raise InvalidInput(f"cannot write {path}: {error.strerror}") from error
