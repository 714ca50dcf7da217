"""Set-up shared by all worker processes: priority, SIGINT, death with the parent thread."""

import ctypes
import os
import signal
import sys
from contextlib import suppress

_PR_SET_PDEATHSIG = 1


def set_up_process(niceness: int) -> None:
    """Lower this process's priority, ignore SIGINT, and die with the thread that started it.

    Args:
        niceness: added to the nice value.
    """
    with suppress(OSError):
        os.nice(niceness)
    # Ctrl-C goes to the terminal's whole process group; the server shuts its workers down itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
