"""Imported by the fork server: deletes its socket and folder when the process that made them died.

That process deletes them itself when it exits, but not after SIGKILL. The fork server outlives it
until the last process that was forked has ended.
"""

import atexit
import os
from contextlib import suppress
from multiprocessing import forkserver
from pathlib import Path

_MADE_BY = os.getppid()


def _delete() -> None:
    if os.getppid() == _MADE_BY:
        return  # it lives, and may have files of its own there
    # No public attribute has it.
    address = vars(forkserver._forkserver)["_forkserver_address"]  # noqa: SLF001
    if isinstance(address, str) and address.startswith("/"):
        with suppress(OSError):
            Path(address).unlink()
            Path(address).parent.rmdir()


atexit.register(_delete)
