"""Where the server of a data folder listens, for commands on the same machine."""

import json
from contextlib import suppress
from pathlib import Path

ADDRESS_FILE = "server.address"


def write_address_file(folder: Path, address: str) -> None:
    """Write down where this folder's server is; it counts only while that has the folder."""
    # Who does not find it is told to ask for a server, so that a full disk is no reason to end.
    with suppress(OSError):
        (folder / ADDRESS_FILE).write_text(json.dumps({"address": address}), "utf-8")


def read_address_file(folder: Path) -> str | None:
    """Where the last server of this folder was; None if it did not say."""
    try:
        noted = json.loads((folder / ADDRESS_FILE).read_text("utf-8"))
        address = noted["address"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return address if isinstance(address, str) and address.startswith("http://") else None
