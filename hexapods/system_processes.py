"""What operating systems do differently with processes: priority, group, kill, times, states.

All else about processes is in `hexapods.processes`, and the same everywhere. Calls about a process
that has ended do nothing, or return zero.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from typing import TypeVar

import psutil

from hexapods.clean_start import clean_start

T = TypeVar("T")
_IDLE_NICENESS = 10
"""Niceness from which Windows has a process compute only when no other wants to."""
_PR_SET_PDEATHSIG, _PR_SET_NAME = 1, 15
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_RETURNED_BYTES = 1 << 20


def lower_priority(niceness: int) -> None:
    """Lower the priority of this process.

    Args:
        niceness: increment of the nice value; on Windows it selects a priority class.
    """
    if sys.platform != "win32":
        with suppress(OSError):
            os.nice(niceness)
    elif niceness > 0:
        is_idle = niceness >= _IDLE_NICENESS
        with suppress(psutil.Error):
            psutil.Process().nice(
                psutil.IDLE_PRIORITY_CLASS if is_idle else psutil.BELOW_NORMAL_PRIORITY_CLASS
            )


def lead_group() -> None:
    """Let this process lead a process group of its own; Windows has none."""
    if sys.platform != "win32":
        os.setpgrp()


def kill_group(pid: int) -> None:
    """Kill the processes of a group that still run (SIGKILL), if it exists.

    On Windows these are the descendants of a process that still runs.

    Args:
        pid: id of the process that leads or led it.
    """
    if sys.platform != "win32":
        # The group has ended, or consists of zombies, which macOS does not allow to kill.
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL)
    else:
        with suppress(psutil.Error):
            for descendant in psutil.Process(pid).children(recursive=True):
                with suppress(psutil.Error):
                    descendant.kill()


def memory_bytes(pid: int) -> int:
    """Return the resident memory of a process [bytes]."""
    return _asked(pid, lambda process: int(process.memory_info().rss), 0)


def processor_s(pid: int) -> float:
    """Return the time that processors have spent on a process [s]."""

    def spent_s(process: psutil.Process) -> float:
        times = process.cpu_times()
        return times.user + times.system

    return _asked(pid, spent_s, 0.0)


def is_stopped(pid: int) -> bool:
    """Whether a signal such as SIGSTOP, or a debugger, has stopped a process."""
    return _asked(pid, lambda process: process.status() == psutil.STATUS_STOPPED, False)


def continue_process(pid: int) -> None:
    """Let a stopped process go on (SIGCONT)."""
    with suppress(psutil.Error):
        psutil.Process(pid).resume()


def _asked(pid: int, question: Callable[[psutil.Process], T], otherwise: T) -> T:
    """Return what a process answers; another value if it has ended, or the system forbids it."""
    try:
        return question(psutil.Process(pid))
    except psutil.Error:
        return otherwise


@contextmanager
def sigint_blocked() -> Iterator[None]:
    """Let processes started meanwhile not be ended by Ctrl-C before they are set up.

    A process inherits the signal mask of the thread that starts it; Windows has none.
    """
    if sys.platform == "win32":
        yield
        return
    # Starting the resource tracker unblocks SIGINT, so that it must be running beforehand.
    with clean_start(imports_main=False):
        resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def die_with_parent() -> None:
    """Let the kernel kill this process when the thread that started it ends; Linux only."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


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
    """Set the name that `top` and `ps -o comm` show, of which Linux keeps 15 bytes; Linux only."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_NAME, name.encode())
