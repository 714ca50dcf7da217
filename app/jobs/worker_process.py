"""A job's process, from the server's side: started, sent commands, its stall or death noticed."""

import logging
import multiprocessing
import os
import queue
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from app.jobs import worker
from app.jobs.messages import Command, Heartbeat, Message, Task

_EXIT_S = 5.0
_logger = logging.getLogger(__name__)


class Exit(NamedTuple):
    """How a process ended."""

    how: str
    """In a few words, for a sentence."""
    error: Exception | None = None
    """Why the server ended it: what it said could not be taken in."""


class WorkerProcess:
    """One process that works on one order.

    Start it from a thread that lives as long as the server: on Linux the kernel ends the process
    when the thread that started it ends.
    """

    def __init__(
        self, name: str, order: Task, on_message: Callable[[Message], None], niceness: int
    ) -> None:
        """Start nothing yet.

        Args:
            name: of the process and its thread, for who looks at them.
            order: what to do.
            on_message: called with each message, one at a time, in a thread of the child's own.
            niceness: by how much its priority is lower than the server's.
        """
        context = multiprocessing.get_context("spawn")
        self._pipe, self._its_pipe = context.Pipe()
        # A pipe holds little, and a process takes a while to read from it: nobody waits for that.
        self._to_send: queue.SimpleQueue[Task | Command | None] = queue.SimpleQueue()
        self._to_send.put(order)
        # Not a daemon: multiprocessing ends daemons from atexit, which a killed server never runs.
        self._process = context.Process(
            target=worker.main, args=(self._its_pipe, niceness), name=name, daemon=False
        )
        self._on_message = on_message
        self._error: Exception | None = None
        self._killed_for: str | None = None
        self._is_taking = False
        self._heard_s = time.monotonic()
        self._stopped_since_s: float | None = None

    def start(self, on_end: Callable[[Exit], None]) -> None:
        """Start the process.

        Args:
            on_end: called once, when the process is gone, with how it ended.

        Raises:
            OSError: if the system has no room for one more process.
        """
        self._process.start()
        self._heard_s = time.monotonic()
        # The only copy of its end is now its own, so that reading ends when it does.
        self._its_pipe.close()
        name = self._process.name
        threading.Thread(target=self._listen, args=(on_end,), name=name, daemon=True).start()
        threading.Thread(target=self._talk, name=f"to {name}", daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Of the process; None before it was started, and after its end."""
        try:
            return self._process.pid
        except ValueError:
            return None

    def send(self, word: Command) -> None:
        """Tell it something; nothing happens if it is gone."""
        self._to_send.put(word)

    def kill(self, why: str | None = None) -> None:
        """End the process at once, for a reason that its end is to name."""
        self._killed_for = self._killed_for or why
        with suppress(ValueError):  # it is gone, and its handle is closed
            self._process.kill()

    def silent_s(self) -> float:
        """For how long it has said nothing, not even that it lives; 0 while it is listened to."""
        return 0.0 if self._is_taking else time.monotonic() - self._heard_s

    def stopped_s(self) -> float:
        """For how long it was seen to be stopped by a signal, as SIGSTOP does; 0 if it is not."""
        if not self._is_stopped():
            self._stopped_since_s = None
            return 0.0
        now = time.monotonic()
        if self._stopped_since_s is None:
            self._stopped_since_s = now
        return now - self._stopped_since_s

    def _is_stopped(self) -> bool:
        if not hasattr(os, "waitid") or self.pid is None:
            return False
        try:
            # Looks, and leaves everything as it is for who waits for the end.
            found = os.waitid(os.P_PID, self.pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT)
        except OSError:
            return False
        return found is not None

    def _talk(self) -> None:
        while (said := self._to_send.get()) is not None:
            with suppress(OSError):  # it is gone, which who listens to it finds out
                self._pipe.send(said)
        self._pipe.close()

    def _listen(self, on_end: Callable[[Exit], None]) -> None:
        try:
            while True:
                self._hear(self._pipe.recv())
        except (EOFError, ConnectionError):
            pass
        except Exception as error:
            # What it says cannot be taken in, so it must not go on.
            _logger.exception("%s: a message could not be taken in", self._process.name)
            self._error = error
            self._process.kill()
        self._process.join(_EXIT_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._to_send.put(None)
        end = Exit(self._how_it_ended(), self._error)
        self._process.close()
        on_end(end)

    def _hear(self, message: Message | Heartbeat) -> None:
        """Take in a message; what the server does meanwhile is no silence of the process."""
        self._is_taking = True
        try:
            if not isinstance(message, Heartbeat):
                self._on_message(message)
        finally:
            self._heard_s = time.monotonic()
            self._is_taking = False

    def _how_it_ended(self) -> str:
        if self._error is not None:
            return f"the server could not take in its results ({self._error})"
        return self._killed_for or _in_words(self._process.exitcode)


def _in_words(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        try:
            name = signal.Signals(-exit_code).name
        except ValueError:
            name = f"signal {-exit_code}"
        why = ", perhaps for want of memory" if name == "SIGKILL" else ""
        return f"its process was ended by {name}{why}"
    return f"its process ended with exit code {exit_code}"
