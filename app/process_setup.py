"""Set-up shared by worker processes: name, priority, SIGINT, death with the parent."""

import ctypes
import multiprocessing
import os
import signal
import sys
from contextlib import suppress

_PR_SET_PDEATHSIG, _PR_SET_NAME = 1, 15


def set_up_process(niceness: int) -> None:
    """Name this process, lower its priority, ignore SIGINT, and die with the parent.

    Args:
        niceness: added to the nice value.
    """
    set_process_name(multiprocessing.current_process().name)
    with suppress(OSError):
        os.nice(niceness)
    # Ctrl-C goes to the terminal's whole process group; the server shuts its workers down itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()


def die_with_parent() -> None:
    """Let the kernel kill this process when the thread that started it ends; Linux only."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def set_process_name(name: str) -> None:
    """Set the name that `top` and `ps -o comm` show, of which Linux keeps 15 bytes."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NAME, name.encode())
