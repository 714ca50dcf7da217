"""Tests in several processes: the order in which they are handed out, and those that run alone."""

import fcntl
from itertools import groupby
from pathlib import Path

from xdist.scheduler import LoadScopeScheduling

_FOLDER = Path(__file__).parent


class FileByFile(LoadScopeScheduling):  # type: ignore[misc]  # without types, as all of xdist
    """Hands out consecutive tests of one file together, and all in the order of the list.

    The tests of a file so share its fixtures. As one process gets no test that stands before the
    ones that it has had, those that stand last in the list come last in each process.
    """

    def schedule(self) -> None:
        """Split the list of tests, which all processes have in common, and hand out the first."""
        self.config.option.loadscopereorder = False
        tests = next(iter(self.registered_collections.values()))
        self._parts = {
            test: f"{number} {file}"
            for number, (file, together) in enumerate(groupby(tests, key=_file))
            for test in together
        }
        super().schedule()

    def _split_scope(self, nodeid: str) -> str:
        return self._parts[nodeid]


def _file(nodeid: str) -> str:
    return nodeid.partition("::")[0]


class MachineLock:
    """Readers-writer lock between processes: their tests share the machine, or one has it alone.

    It consists of locks on two files of the checkout, which the system releases when a process
    dies. A process that waits for its turn holds `_queue`: so a test that waits for all others to
    end is not overtaken by the next ones.
    """

    def __init__(self) -> None:
        self._queue = (_FOLDER / "conftest.py").open("rb")
        self._machine = (_FOLDER / "in_parallel.py").open("rb")
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
