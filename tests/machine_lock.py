"""Readers-writer lock between test processes: tests share the machine, or one has it alone.

Works in one process as in the several of `make test`, and between runs in one checkout.
"""

import fcntl
from pathlib import Path

_FOLDER = Path(__file__).parent


class MachineLock:
    """Lock on two files of the checkout, which the system releases when a process dies.

    A process that waits for its turn holds `_queue`: so a test that waits for all others to end
    is not overtaken by the next ones.
    """

    def __init__(self) -> None:
        self._queue = (_FOLDER / "conftest.py").open("rb")
        self._machine = (_FOLDER / "machine_lock.py").open("rb")
        self._is_held = False

    def acquire(self, *, alone: bool) -> None:
        """Wait until a test may run; return at once if the lock was not released after the last."""
        if self._is_held:
            return
        fcntl.flock(self._queue, fcntl.LOCK_EX)
        fcntl.flock(self._machine, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
        fcntl.flock(self._queue, fcntl.LOCK_UN)
        self._is_held = True

    def release(self) -> None:
        """Let tests of other processes run."""
        fcntl.flock(self._machine, fcntl.LOCK_UN)
        self._is_held = False

    def close(self) -> None:
        """Close both files, which releases the lock."""
        self._queue.close()
        self._machine.close()
