"""The server's handle on a worker process: starts it, sends commands, detects stall and exit."""

import logging
import queue
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from app.jobs import worker
from app.jobs.messages import Command, Heartbeat, Message, Task
from hexapods.processes import LOST, Child, SetUp

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
        """Start nothing yet.

        Args:
            name: name of the process and its threads, for monitoring tools.
            task: the first item sent through the pipe.
            on_message: called with each message, one at a time, in the receiving thread.
            niceness: added to the server's nice value.
        """
        # A pipe's buffer is small: a queue and a thread keep `send` from blocking its caller.
        self._to_send: queue.SimpleQueue[Task | Command | None] = queue.SimpleQueue()
        self._to_send.put(task)
        self._name = name
        self._child = Child(worker.main, SetUp(name=name, niceness=niceness))
        self._on_message = on_message
        self._error: Exception | None = None
        self._kill_reason: str | None = None
        self._is_handling = False
        self._last_message_s = time.monotonic()

    def start(self, on_end: Callable[[Exit], None]) -> None:
        """Start the process.

        Args:
            on_end: called once, after the process has exited, with how it ended.

        Raises:
            OSError: if the system cannot create another process.
        """
        self._child.start()
        self._last_message_s = time.monotonic()
        name = self._name
        threading.Thread(target=self._receive_loop, args=(on_end,), name=name, daemon=True).start()
        threading.Thread(target=self._send_loop, name=f"to {name}", daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Process id; None before the start and after the exit."""
        return self._child.pid

    def send(self, command: Command) -> None:
        """Queue a command for the process; ignored if it has exited."""
        self._to_send.put(command)

    def kill(self, reason: str | None = None) -> None:
        """Kill the process (SIGKILL); the first reason given becomes part of its `Exit`."""
        self._kill_reason = self._kill_reason or reason
        self._child.kill()

    def silent_s(self) -> float:
        """Return the time since its last message or heartbeat [s]; 0 while one is handled."""
        return 0.0 if self._is_handling else time.monotonic() - self._last_message_s

    def excuse_silence(self) -> None:
        """Restart the silence timer, after the server process itself was suspended."""
        self._last_message_s = time.monotonic()

    def stopped_s(self) -> float:
        """Return for how long it was observed stopped by a signal such as SIGSTOP [s], else 0."""
        return self._child.stopped_s()

    def _send_loop(self) -> None:
        while (item := self._to_send.get()) is not None:
            with suppress(OSError):  # it has exited, which the receiving thread detects
                self._child.pipe.send(item)
        self._child.pipe.close()

    def _receive_loop(self, on_end: Callable[[Exit], None]) -> None:
        try:
            while self._has_message():
                self._handle(self._child.pipe.recv())
        except (EOFError, ConnectionError):
            pass
        except Exception as error:
            # Its results cannot be stored, so it must not continue.
            _logger.exception("%s: a message could not be handled", self._name)
            self._error = error
            self._child.kill()
        exit_code = self._child.end()
        self._to_send.put(None)
        is_lost = exit_code == LOST and self._kill_reason is None
        end = Exit(self._exit_description(exit_code), self._error, is_lost)
        on_end(end)

    def _has_message(self) -> bool:
        """Wait for a message; False if there will be none, as the process has exited."""
        self._child.wait()
        return self._child.pipe.poll()

    def _handle(self, message: Message | Heartbeat) -> None:
        """Handle a message; the time that takes does not count as silence of the process."""
        self._is_handling = True
        try:
            if not isinstance(message, Heartbeat):
                self._on_message(message)
        finally:
            self._last_message_s = time.monotonic()
            self._is_handling = False

    def _exit_description(self, exit_code: int | None) -> str:
        if self._error is not None:
            return f"the server could not take in its results ({self._error})"
        return self._kill_reason or _describe_exit_code(exit_code)


def _describe_exit_code(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        try:
            name = signal.Signals(-exit_code).name
        except ValueError:
            name = f"signal {-exit_code}"
        reason = ", perhaps for want of memory" if name == "SIGKILL" else ""
        return f"its process was ended by {name}{reason}"
    return f"its process ended with exit code {exit_code}"
