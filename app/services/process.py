"""A job's process: started, spoken to, and its death noticed, from the server's side."""

import logging
import multiprocessing
import queue
import signal
import threading
from collections.abc import Callable
from contextlib import suppress

from app.services import worker
from app.services.orders import Message, Order, Word

_EXIT_S = 5.0
_logger = logging.getLogger(__name__)


class Child:
    """One process that works on one order.

    Start it from a thread that lives as long as the server: on Linux the kernel ends the process
    when the thread that started it ends.
    """

    def __init__(self, name: str, order: Order, on_message: Callable[[Message], None]) -> None:
        """Start nothing yet.

        Args:
            name: of the process and its thread, for who looks at them.
            order: what to do.
            on_message: called with each message, one at a time, in a thread of the child's own.
        """
        context = multiprocessing.get_context("spawn")
        self._pipe, self._its_pipe = context.Pipe()
        # A pipe holds little, and a process takes a while to read from it: nobody waits for that.
        self._to_send: queue.SimpleQueue[Order | Word | None] = queue.SimpleQueue()
        self._to_send.put(order)
        # Not a daemon: multiprocessing ends daemons from atexit, which a killed server never runs.
        self._process = context.Process(
            target=worker.main, args=(self._its_pipe,), name=name, daemon=False
        )
        self._on_message = on_message
        self._error: Exception | None = None

    def start(self, on_end: Callable[[str], None]) -> None:
        """Start the process.

        Args:
            on_end: called once, when the process is gone, with how it ended in a few words.

        Raises:
            OSError: if the system has no room for one more process.
        """
        self._process.start()
        # The only copy of its end is now its own, so that reading ends when it does.
        self._its_pipe.close()
        name = self._process.name
        threading.Thread(target=self._listen, args=(on_end,), name=name, daemon=True).start()
        threading.Thread(target=self._talk, name=f"to {name}", daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Of the process; None before it was started."""
        return self._process.pid

    def send(self, word: Word) -> None:
        """Tell it something; nothing happens if it is gone."""
        self._to_send.put(word)

    def kill(self) -> None:
        """End the process at once."""
        self._process.kill()

    def _talk(self) -> None:
        while (said := self._to_send.get()) is not None:
            with suppress(OSError):  # it is gone, which who listens to it finds out
                self._pipe.send(said)
        self._pipe.close()

    def _listen(self, on_end: Callable[[str], None]) -> None:
        try:
            while True:
                self._on_message(self._pipe.recv())
        except (EOFError, ConnectionError):
            pass
        except Exception as error:
            # What it says cannot be taken in, so it must not go on.
            _logger.exception("%s: a message could not be handled", self._process.name)
            self._error = error
            self._process.kill()
        self._process.join(_EXIT_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._to_send.put(None)
        on_end(self._how_it_ended())
        self._process.close()

    def _how_it_ended(self) -> str:
        if self._error is not None:
            return f"the server could not take in its results ({self._error})"
        return _in_words(self._process.exitcode)


def _in_words(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        try:
            name = signal.Signals(-exit_code).name
        except ValueError:
            name = f"signal {-exit_code}"
        why = ", perhaps for want of memory" if name == "SIGKILL" else ""
        return f"its process was ended by {name}{why}"
    return f"its process ended with exit code {exit_code}"
