"""Processes that compute for this one: start, set-up, supervision and kill of each.

On Linux they are forks of one process, the fork server of `multiprocessing`, which has imported
what they need: a fork starts in some hundredths of the time, and shares that memory. Elsewhere,
where the libraries that are used do not all survive a fork, each is started anew.
"""

import ctypes
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache
from multiprocessing import connection, forkserver, resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from pathlib import Path

from hexapods.clean_start import clean_start
from hexapods.domain.robot_library import LIBRARY, RobotLibrary

STALLED_S = 8.0
"""A process stopped by a signal (SIGSTOP) for longer is killed: it would never be done."""
LOST = 255
"""Exit code that `multiprocessing` gives a process when the fork server has ended, not it."""
_PRELOADED = "hexapods.fork_server_end"
"""Module that each fork server imports."""
_START_S = 5.0
"""Time in which a process starts although the fork server has just ended."""
_RETRY_S, _CONTINUED_EVERY_S = 0.1, 0.5
_FROZEN_S = 5.0
"""After a longer time between two looks this process was stopped itself."""
_END_S = 5.0
_PR_SET_PDEATHSIG, _PR_SET_NAME = 1, 15
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
_RETURNED_BYTES = 1 << 20


@dataclass(frozen=True, kw_only=True)
class SetUp:
    """Actions of a process before anything else.

    Attributes:
        name: name that `top` and `ps -o comm` show.
        niceness: increment of the nice value.
        leads_group: whether it leads a group of its own, so that it can be killed with the
            processes that it starts. One that does not is stopped and continued by the terminal.
        imports_main: whether it imports the program that starts it, as it needs classes of that.
        temporary: folder for its temporary files, which it deletes if the process that starts it
            dies; that deletes it otherwise.
        environment: variables that are set, since a fork server has those of its own start.
    """

    name: str
    niceness: int = 0
    leads_group: bool = True
    imports_main: bool = False
    temporary: str | None = None
    environment: Mapping[str, str] = field(default_factory=dict)

    def apply(self) -> None:
        """Set this process up; it ignores SIGINT, and ends with the process that started it."""
        set_process_name(self.name)
        with suppress(OSError):
            os.nice(self.niceness)
        # Ctrl-C goes to the terminal's whole process group; who starts processes ends them itself.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _end_with_parent(self.temporary)
        if self.leads_group:
            os.setpgrp()
        os.environ.update(self.environment)
        if self.temporary is not None:
            os.environ["TMPDIR"] = self.temporary
        tempfile.tempdir = None  # a fork server may have looked for the folder already


class Child:
    """A process that calls one function, and a pipe to it.

    Attributes:
        pipe: this end of the pipe, once it is started.
        pid: process id; None before the start and after the end.
        is_killed: whether `kill` was called.
    """

    pipe: Connection
    _process: BaseProcess

    def __init__(self, target: Callable[[Connection], None], set_up: SetUp) -> None:
        """Describe the process; `start` starts it.

        Args:
            target: function of a module, called in the process with its end of the pipe.
            set_up: set-up of the process, done before the call.
        """
        self._target, self._set_up = target, set_up
        self.is_killed = False
        self._looked_s = 0.0
        self._stopped_since_s: float | None = None
        self.pid: int | None = None

    def start(self) -> None:
        """Start the process.

        Raises:
            OSError: if the system cannot create another process.
        """
        deadline_s = time.monotonic() + _START_S
        with _sigint_blocked():
            while not self._has_started():
                if time.monotonic() > deadline_s:
                    raise OSError("the process that forks others has ended")
                time.sleep(_RETRY_S)
        self.pid = self._process.pid
        if self.is_killed:
            self.kill()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until the process has sent a message or has exited; False after the timeout.

        After an exit `pipe.poll()` says whether a message is left in the pipe.
        """
        return bool(connection.wait([self.pipe, self._process.sentinel], timeout_s))

    def stopped_s(self) -> float:
        """Return the time since which a signal such as SIGSTOP has stopped the process [s], else 0.

        Call it every few seconds: the time in which the caller itself was stopped is not counted.
        """
        now_s, looked_s = time.monotonic(), self._looked_s
        self._looked_s = now_s
        if self.pid is None or not _is_stopped(self.pid):
            self._stopped_since_s = None
            return 0.0
        if self._stopped_since_s is None or now_s - looked_s > _FROZEN_S:
            self._stopped_since_s = now_s
        return now_s - self._stopped_since_s

    def memory_bytes(self) -> int:
        """Return the resident memory of the process [bytes]; Linux only, else 0."""
        try:
            pages = int(Path(f"/proc/{self.pid}/statm").read_bytes().split()[1])
        except OSError:  # it has exited, or this is not Linux
            return 0
        return pages * os.sysconf("SC_PAGE_SIZE")

    def processor_s(self) -> float:
        """Return the time that processors have spent on the process [s]; Linux only, else 0."""
        try:
            fields = Path(f"/proc/{self.pid}/stat").read_text(encoding="ascii", errors="replace")
        except OSError:  # it has exited, or this is not Linux
            return 0.0
        # After the name, which is in brackets and may have blanks.
        user, system = fields.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")

    def kill(self) -> None:
        """Kill the process and its group by SIGKILL: at once, or as soon as it starts."""
        self.is_killed = True
        pid = self.pid  # another thread may end it meanwhile
        with suppress(ValueError):  # it has ended
            if pid is not None and self._process.is_alive():
                _kill_group(pid)
                self._process.kill()  # it may have no group yet

    def end(self) -> int | None:
        """Wait `_END_S` for the exit of the process, then kill it and the rest of its group.

        Returns:
            its exit code: negative after a signal, `LOST` if the fork server ended; None if it was
            not started.
        """
        if self.pid is None:
            return None
        self._process.join(_END_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        _kill_group(self.pid)  # what it started and did not end
        self.pid, code = None, self._process.exitcode
        self._process.close()
        return code

    def _has_started(self) -> bool:
        """Start the process; False if the fork server has ended, and a retry may start a new one.

        A retry does so once the fork server's exit can be seen by its process id, not only by its
        socket.
        """
        context = process_context()
        self.pipe, other_end = context.Pipe()
        arguments = self._target, self._set_up, LIBRARY, other_end
        self._process = context.Process(target=_run, args=arguments, name=self._set_up.name)
        try:
            with clean_start(imports_main=self._set_up.imports_main):
                self._process.start()
        except (EOFError, ConnectionError):
            self.pipe.close()  # the fork server may have forked before it ended
            return False
        finally:
            # The exit is then the end of the pipe, unless a process that it started holds that too.
            other_end.close()
        return True


def _run(
    target: Callable[[Connection], None],
    set_up: SetUp,
    robots: RobotLibrary,
    pipe: Connection,
) -> None:
    set_up.apply()
    LIBRARY.add_all(robots)
    target(pipe)


def process_context() -> ForkServerContext | SpawnContext:
    """Return the `multiprocessing` context that creates processes."""
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    # No public attribute has it.
    preloaded = vars(forkserver._forkserver)["_preload_modules"]  # noqa: SLF001
    if _PRELOADED not in preloaded:
        forkserver.set_forkserver_preload([*preloaded, _PRELOADED])
    _start_watch()
    return multiprocessing.get_context("forkserver")


def start_fork_server(preloaded: Sequence[str]) -> None:
    """Let the fork server begin to import modules, if it does not run yet; Linux only.

    Args:
        preloaded: names of modules that most processes need.

    Raises:
        OSError: if the system cannot create a process.
    """
    if sys.platform == "linux":
        forkserver.set_forkserver_preload([*preloaded, _PRELOADED])
        with _sigint_blocked(), clean_start(imports_main=False):
            forkserver.ensure_running()


@cache
def _start_watch() -> None:
    """Continue a fork server that was stopped by a signal for `_CONTINUED_EVERY_S` (SIGCONT).

    While it is stopped, starting or joining a process blocks.
    """

    def watch() -> None:
        stopped: int | None = None
        while True:
            time.sleep(_CONTINUED_EVERY_S)
            # No public attribute has it.
            pid = vars(forkserver._forkserver)["_forkserver_pid"]  # noqa: SLF001
            is_stopped = pid is not None and _is_stopped(pid)
            if is_stopped and pid == stopped:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGCONT)
            stopped = pid if is_stopped else None

    threading.Thread(target=watch, name="fork server's watch", daemon=True).start()


@contextmanager
def _sigint_blocked() -> Iterator[None]:
    """Let processes started meanwhile not be ended by Ctrl-C before they are set up.

    A process inherits the signal mask of the thread that starts it.
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


def _end_with_parent(temporary: str | None) -> None:
    """End this process when its parent process ends, however that ends.

    Args:
        temporary: folder that is deleted then; None for none.
    """
    die_with_parent()

    def watch() -> None:
        # PR_SET_PDEATHSIG tells of the fork server, misses a death before the call, is of Linux.
        parent = multiprocessing.parent_process()
        if parent is not None:
            parent.join()
            if temporary is not None:
                shutil.rmtree(temporary, ignore_errors=True)
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _kill_group(pid: int) -> None:
    """Kill the processes of a group that still run (SIGKILL), if it exists.

    Args:
        pid: id of the process that leads or led it.
    """
    # The group has ended, or consists of zombies, which macOS does not allow to kill.
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def processor_s(pid: int) -> float:
    """Return the processor time that a process has taken [s]; Linux only, else 0."""
    try:
        status = Path(f"/proc/{pid}/stat").read_bytes()
    except OSError:  # it has exited, or this is not Linux
        return 0.0
    # User and system time are the 14th and 15th field; the name, the second, may contain any.
    fields = status.rpartition(b") ")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _is_stopped(pid: int) -> bool:
    """Whether a signal such as SIGSTOP has stopped a process; Linux only, else False."""
    try:
        status = Path(f"/proc/{pid}/stat").read_bytes()
    except OSError:  # it has exited, or this is not Linux
        return False
    # The state follows the name, which is in parentheses and may contain any.
    return status.rpartition(b") ")[2][:1] == b"T"


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
