"""Worker processes: name, priority, SIGINT, groups, death with the parent, whether stopped."""

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path

STALLED_S = 8.0
"""A worker process stopped by a signal (SIGSTOP) for longer is killed: it would never be done."""
_PR_SET_PDEATHSIG, _PR_SET_NAME = 1, 15
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_RETURNED_BYTES = 1 << 20


def set_up_process(niceness: int) -> None:
    """Name this process, lower its priority, ignore SIGINT, and die with the parent.

    It leads a group of its own, so that it can be killed with the processes that it starts.

    Args:
        niceness: added to the nice value.
    """
    set_process_name(multiprocessing.current_process().name)
    with suppress(OSError):
        os.nice(niceness)
    # Ctrl-C goes to the terminal's whole process group; the server shuts its workers down itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()
    os.setpgrp()


def kill_group(pid: int) -> None:
    """Kill the processes of a group that still run (SIGKILL), if it exists.

    Args:
        pid: id of the process that leads or led it.
    """
    # There is none any more, or none that may be killed, as macOS says of zombies.
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def is_stopped(pid: int) -> bool:
    """Whether a signal such as SIGSTOP has stopped a process; Linux only, else False."""
    try:
        status = Path(f"/proc/{pid}/stat").read_bytes()
    except OSError:  # it has exited, or this is not Linux
        return False
    # The state follows the name, which is in parentheses and may contain any.
    return status.rpartition(b") ")[2][:1] == b"T"


def die_with_parent() -> None:
    """Let the kernel kill this process when the thread that started it ends; Linux only."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def end_with_parent() -> None:
    """Let this worker of a pool end when the process that uses the pool does, however that ends."""
    die_with_parent()

    def watch() -> None:
        # PR_SET_PDEATHSIG misses a process that died before the call, and is of Linux.
        parent = multiprocessing.parent_process()
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def worker_processes(pool: ProcessPoolExecutor) -> list[BaseProcess]:
    """Return the processes of a pool that run."""
    # Private, since a pool offers no way to kill its processes before Python 3.14.
    found: list[BaseProcess] = list((pool._processes or {}).values())  # noqa: SLF001
    return [process for process in found if process.is_alive()]


def kill_workers(pool: ProcessPoolExecutor) -> None:
    """Kill the processes of a pool (SIGKILL), and those of their groups."""
    for process in worker_processes(pool):
        if process.pid is not None:
            kill_group(process.pid)
        process.kill()  # it may have no group of its own


def memory_used_bytes(pid: int) -> int:
    """Return the resident memory of a process; Linux only, else 0."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_bytes().split()[1])
    except OSError:  # it has exited, or this is not Linux
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def return_freed_memory() -> None:
    """Let the allocator return large buffers to the system as soon as they are freed; glibc only.

    By itself it keeps up to 64 MB for the next ones, once it has seen some of 32 MB.
    """
    if sys.platform == "linux":
        # Other C libraries have no such options, and keep less.
        with suppress(AttributeError):
            libc = ctypes.CDLL(None)
            libc.mallopt(_M_MMAP_THRESHOLD, _RETURNED_BYTES)
            libc.mallopt(_M_TRIM_THRESHOLD, _RETURNED_BYTES)


def set_process_name(name: str) -> None:
    """Set the name that `top` and `ps -o comm` show, of which Linux keeps 15 bytes."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NAME, name.encode())
