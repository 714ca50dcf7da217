"""How a process behaves that works for the server."""

import ctypes
import os
import signal
import sys
from contextlib import suppress

NICENESS = 15
_PR_SET_PDEATHSIG = 1


def be_modest(niceness: int = NICENESS) -> None:
    """Let the server go first, and end with it: with the thread that started this process."""
    with suppress(OSError):
        os.nice(niceness)
    # Ctrl-C reaches every process of a terminal; the server says what becomes of its own.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
