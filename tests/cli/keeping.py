"""Commands with `--keep` that Ctrl-C interrupts."""

import os
import signal
import sqlite3
import tempfile
import time
from pathlib import Path

from app.storage.database.opening import DATABASE_FILE
from tests.forked import start_hexapods
from tests.timeouts import LONG_S, ProgressTimeout


def interrupted(*arguments: str, data: Path, once: str) -> str:
    """Send a command SIGINT once its run is so far, and return what it says on standard error.

    The exit code must be 130.

    Args:
        arguments: the command and its options.
        data: its data folder.
        once: condition of SQL on the row of the run.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8") as errors:
        env = {"PATH": "/usr/bin:/bin", "HEXAPODS_DATA": str(data)}
        process = start_hexapods(arguments, env, errors)
        stall_check = ProgressTimeout()
        while not _has_run(data, once):
            stall_check.check(None)
            time.sleep(0.1)
        os.kill(process.pid, signal.SIGINT)
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(LONG_S) == 130
        errors.seek(0)
        return errors.read()


def _has_run(data: Path, condition: str) -> bool:
    """Return whether there is such a run, as another process may read it."""
    if not (data / DATABASE_FILE).exists():
        return False
    with sqlite3.connect(f"file:{data / DATABASE_FILE}?mode=ro", uri=True) as database:
        try:
            rows = database.execute(f"SELECT id FROM runs WHERE {condition}").fetchall()
        except sqlite3.OperationalError:  # it is being made
            return False
    return bool(rows)
