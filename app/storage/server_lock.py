"""One server per data folder: the file lock that it holds, and the file with its address."""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hexapods.domain.errors import InvalidInput
from hexapods.files import lock_file

ADDRESS_FILE = "server.address"
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
    # Only its owner may open it: whoever can, for reading too, can hold the lock.
    opened = os.open(folder / LOCK_FILE, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    with os.fdopen(opened, "ab") as file:
        try:
            lock_file(file)
        except OSError as error:
            raise FolderInUse(
                f"another server uses the data folder {folder}; stop it, or choose another "
                "folder with --data or HEXAPODS_DATA"
            ) from error
        yield


def write_address_file(folder: Path, address: str) -> None:
    """Write the server's URL; it is valid only while the server holds the folder's lock.

    Errors are ignored, because only commands on this machine need the file, and a full disk must
    not stop the server.
    """
    with suppress(OSError):
        (folder / ADDRESS_FILE).write_text(json.dumps({"address": address}), "utf-8")


def remove_address_file(folder: Path) -> None:
    """Remove the URL of the folder's last server; call it while holding the folder's lock."""
    with suppress(OSError):
        (folder / ADDRESS_FILE).unlink(missing_ok=True)


def read_address_file(folder: Path) -> str | None:
    """Return the URL that the folder's last server wrote; None if missing or invalid."""
    try:
        content = json.loads((folder / ADDRESS_FILE).read_text("utf-8"))
        address = content["address"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return address if isinstance(address, str) and address.startswith("http://") else None
