"""How a process behaves that works for the server."""

import ctypes
import os
import signal
import sys
from contextlib import suppress

_PR_SET_PDEATHSIG = 1


def set_up_process(niceness: int) -> None:
    """Lower this process's priority, ignore SIGINT, and die with the thread that started it."""
    with suppress(OSError):
        os.nice(niceness)
    # Ctrl-C reaches every process of a terminal; the server says what becomes of its own.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
