"""Processes that compute for this one: start, set-up, supervision and kill of each.

On Linux they are forks of one process, the fork server of `multiprocessing`, which has imported
what they need: a fork starts in some hundredths of the time, and shares that memory. Elsewhere,
where the libraries that are used do not all survive a fork, each is started anew.
"""

import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import connection
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnContext
from multiprocessing.process import BaseProcess
from typing import Any

from hexapods.clean_start import clean_start
from hexapods.domain.robot_library import LIBRARY, RobotLibrary
from hexapods.system_processes import (
    die_with_parent,
    is_stopped,
    kill_group,
    lead_group,
    lower_priority,
    memory_bytes,
    processor_s,
    set_process_name,
    sigint_blocked,
)

if sys.platform == "linux":
    from multiprocessing.context import ForkServerContext

    from hexapods.fork_server import fork_server_context, preload

    Context = ForkServerContext | SpawnContext
else:
    Context = SpawnContext

STALLED_S = 8.0
"""A process stopped by a signal (SIGSTOP) for longer is killed: it would never be done."""
LOST = 255
"""Exit code that `multiprocessing` gives a process when the fork server has ended, not it."""
_START_S = 5.0
"""Time in which a process starts although the fork server has just ended."""
_RETRY_S = 0.1
_FROZEN_S = 5.0
"""After a longer time between two looks this process was stopped itself."""
_END_S = 5.0


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
        lower_priority(self.niceness)
        # Ctrl-C goes to the terminal's whole process group; who starts processes ends them itself.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _end_with_parent(self.temporary)
        if self.leads_group:
            lead_group()
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
        with sigint_blocked():
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
        if self.pid is None or not is_stopped(self.pid):
            self._stopped_since_s = None
            return 0.0
        if self._stopped_since_s is None or now_s - looked_s > _FROZEN_S:
            self._stopped_since_s = now_s
        return now_s - self._stopped_since_s

    def memory_bytes(self) -> int:
        """Return the resident memory of the process [bytes]; 0 after its exit."""
        pid = self.pid
        return 0 if pid is None else memory_bytes(pid)

    def processor_s(self) -> float:
        """Return the time that processors have spent on the process [s]; 0 after its exit."""
        pid = self.pid
        return 0.0 if pid is None else processor_s(pid)

    def kill(self) -> None:
        """Kill the process and its group (SIGKILL): at once, or as soon as it starts."""
        self.is_killed = True
        pid = self.pid  # another thread may end it meanwhile
        with suppress(ValueError):  # it has ended
            if pid is not None and self._process.is_alive():
                kill_group(pid)
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
        kill_group(self.pid)  # what it started and did not end
        self.pid, code = None, self._process.exitcode
        self._process.close()
        return code

    def _has_started(self) -> bool:
        """Start the process; False if the fork server has ended, and a retry may start a new one.

        A retry does so once the fork server's exit can be seen by its process id, not only by its
        socket.
        """
        context = process_context()
        # On Windows both ends are of another class, with the same methods.
        ends: tuple[Any, Any] = context.Pipe()
        self.pipe, other_end = ends
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


def process_context() -> Context:
    """Return the `multiprocessing` context that creates processes."""
    if sys.platform == "linux":
        return fork_server_context()
    else:  # noqa: RET505 - mypy would call what follows unreachable
        return multiprocessing.get_context("spawn")


def start_fork_server(preloaded: Sequence[str]) -> None:
    """Let the fork server begin to import modules, if it does not run yet; Linux only.

    Args:
        preloaded: names of modules that most processes need.

    Raises:
        OSError: if the system cannot create a process.
    """
    if sys.platform == "linux":
        preload(preloaded)


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
