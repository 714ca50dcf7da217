"""Address file: the URL of a data folder's server, for commands on the same machine."""

import json
from contextlib import suppress
from pathlib import Path

ADDRESS_FILE = "server.address"


def write_address_file(folder: Path, address: str) -> None:
    """Write the server's URL; it is valid only while the server holds the folder's lock.

    Errors are ignored, because only commands on this machine need the file, and a full disk must
    not stop the server.
    """
    with suppress(OSError):
        (folder / ADDRESS_FILE).write_text(json.dumps({"address": address}), "utf-8")


def read_address_file(folder: Path) -> str | None:
    """Return the URL that the folder's last server wrote; None if missing or invalid."""
    try:
        content = json.loads((folder / ADDRESS_FILE).read_text("utf-8"))
        address = content["address"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return address if isinstance(address, str) and address.startswith("http://") else None
