"""The server's handle on a worker process: starts it, sends commands, detects stall and exit."""

import logging
import queue
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import connection
from typing import NamedTuple

from app.jobs import worker
from app.jobs.fork_server import process_context
from app.jobs.messages import Command, Heartbeat, Message, Task
from hexapods.processes import is_stopped, kill_group

_EXIT_S = 5.0
_REAPED_S = 0.1
"""After this time the end of the fork server can be seen by its id, not only by its socket's."""
_LOST = 255
"""Exit code that `multiprocessing` gives a process when the fork server has ended, not it."""
_logger = logging.getLogger(__name__)


class Exit(NamedTuple):
    """End of a process."""

    how: str
    """A clause for an error message."""
    error: Exception | None = None
    """The exception raised while one of its messages was handled, for which it was killed."""
    is_lost: bool = False
    """Whether the fork server ended, and the process with it."""


class WorkerProcess:
    """One process that computes one task, with a sending and a receiving thread."""

    def __init__(
        self, name: str, task: Task, on_message: Callable[[Message], None], niceness: int
    ) -> None:
        """Create the pipe and the process object; `start` starts the process.

        Args:
            name: name of the process and its threads, for monitoring tools.
            task: the first item sent through the pipe.
            on_message: called with each message, one at a time, in the receiving thread.
            niceness: added to the server's nice value.

        Raises:
            OSError: if the system cannot create a process.
        """
        # A pipe's buffer is small: a queue and a thread keep `send` from blocking its caller.
        self._to_send: queue.SimpleQueue[Task | Command | None] = queue.SimpleQueue()
        self._to_send.put(task)
        self._name, self._niceness = name, niceness
        self._create()
        self._on_message = on_message
        self._error: Exception | None = None
        self._kill_reason: str | None = None
        self._is_handling = False
        self._last_message_s = time.monotonic()
        self._stopped_since_s: float | None = None

    def start(self, on_end: Callable[[Exit], None]) -> None:
        """Start the process.

        Args:
            on_end: called once, after the process has exited, with how it ended.

        Raises:
            OSError: if the system cannot create another process.
        """
        try:
            self._process.start()
        except (EOFError, ConnectionError):
            self._start_again()
        self._last_message_s = time.monotonic()
        # Its exit is then the end of the pipe, unless a process that it started holds that too.
        self._child_pipe.close()
        name = self._name
        threading.Thread(target=self._receive_loop, args=(on_end,), name=name, daemon=True).start()
        threading.Thread(target=self._send_loop, name=f"to {name}", daemon=True).start()

    def _create(self) -> None:
        context = process_context()
        self._pipe, self._child_pipe = context.Pipe()
        # Not a daemon: multiprocessing ends daemons in atexit, which a killed server never runs.
        self._process = context.Process(
            target=worker.main,
            args=(self._child_pipe, self._niceness),
            name=self._name,
            daemon=False,
        )

    def _start_again(self) -> None:
        """Start the process after the fork server has ended; `multiprocessing` starts a new one."""
        # With a pipe of its own: the fork server may have forked before it ended.
        self._pipe.close()
        self._child_pipe.close()
        time.sleep(_REAPED_S)
        self._create()
        try:
            self._process.start()
        except (EOFError, ConnectionError) as error:
            raise OSError("the process that forks others has ended") from error

    @property
    def pid(self) -> int | None:
        """Process id; None before the start and after the exit."""
        try:
            return self._process.pid
        except ValueError:
            return None

    def send(self, command: Command) -> None:
        """Queue a command for the process; ignored if it has exited."""
        self._to_send.put(command)

    def kill(self, reason: str | None = None) -> None:
        """Kill the process (SIGKILL); the first reason given becomes part of its `Exit`."""
        self._kill_reason = self._kill_reason or reason
        with suppress(ValueError):  # it has exited, and its handle is closed
            self._process.kill()

    def silent_s(self) -> float:
        """Return the time since its last message or heartbeat [s]; 0 while one is handled."""
        return 0.0 if self._is_handling else time.monotonic() - self._last_message_s

    def excuse_silence(self) -> None:
        """Restart the silence and stop timers, after the server process itself was suspended."""
        self._last_message_s = time.monotonic()
        self._stopped_since_s = None

    def stopped_s(self) -> float:
        """Return for how long it was observed stopped by a signal such as SIGSTOP [s], else 0."""
        pid = self.pid
        if pid is None or not is_stopped(pid):
            self._stopped_since_s = None
            return 0.0
        now = time.monotonic()
        if self._stopped_since_s is None:
            self._stopped_since_s = now
        return now - self._stopped_since_s

    def _send_loop(self) -> None:
        while (item := self._to_send.get()) is not None:
            with suppress(OSError):  # it has exited, which the receiving thread detects
                self._pipe.send(item)
        self._pipe.close()

    def _receive_loop(self, on_end: Callable[[Exit], None]) -> None:
        try:
            while self._has_message():
                self._handle(self._pipe.recv())
        except (EOFError, ConnectionError):
            pass
        except Exception as error:
            # Its results cannot be stored, so it must not continue.
            _logger.exception("%s: a message could not be handled", self._process.name)
            self._error = error
            self._process.kill()
        self._process.join(_EXIT_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        if self._process.pid is not None:
            kill_group(self._process.pid)  # what it started and did not end
        self._to_send.put(None)
        is_lost = self._process.exitcode == _LOST and self._kill_reason is None
        end = Exit(self._exit_description(), self._error, is_lost)
        self._process.close()
        on_end(end)

    def _has_message(self) -> bool:
        """Wait for a message; False if there will be none, as the process has exited."""
        connection.wait([self._pipe, self._process.sentinel])
        return self._pipe.poll()

    def _handle(self, message: Message | Heartbeat) -> None:
        """Handle a message; the time that takes does not count as silence of the process."""
        self._is_handling = True
        try:
            if not isinstance(message, Heartbeat):
                self._on_message(message)
        finally:
            self._last_message_s = time.monotonic()
            self._is_handling = False

    def _exit_description(self) -> str:
        if self._error is not None:
            return f"the server could not take in its results ({self._error})"
        return self._kill_reason or _describe_exit_code(self._process.exitcode)


def _describe_exit_code(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        try:
            name = signal.Signals(-exit_code).name
        except ValueError:
            name = f"signal {-exit_code}"
        reason = ", perhaps for want of memory" if name == "SIGKILL" else ""
        return f"its process was ended by {name}{reason}"
    return f"its process ended with exit code {exit_code}"
