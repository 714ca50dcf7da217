"""Executor whose worker processes can be killed, and whose death fails no other call.

A `ProcessPoolExecutor` is broken by the death of any of its processes, cannot kill them before
Python 3.14, and keeps them for ever.
"""

import atexit
import logging
import pickle
import queue
import threading
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from functools import partial
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from hexapods.processes import STALLED_S, Child, SetUp

_CHECK_EVERY_S = 0.2
_CLOSE_S = 3.0
T = TypeVar("T")
_Call = tuple["Future[Any]", Callable[[], Any]]
_logger = logging.getLogger(__name__)


class WorkerPool(Executor):
    """Processes that call functions of modules, each started by the first call that it gets.

    A future raises BrokenExecutor if the process of its call ended, and OSError if none can be
    started; the next call is given to a new one.

    Attributes:
        count: number of processes.
    """

    def __init__(
        self,
        count: int,
        set_up: SetUp,
        *,
        idle_s: float | None = None,
        most_bytes: int | None = None,
    ) -> None:
        """Create the pool; each process starts with the first call that it gets.

        Args:
            count: number of processes.
            set_up: of each process.
            idle_s: time without a call after which a process is ended [s]; None for never.
            most_bytes: memory above which a process is killed; None for any.
        """
        self.count, self._set_up = count, set_up
        self._idle_s, self._most_bytes = idle_s, most_bytes
        self._calls: queue.SimpleQueue[_Call | None] = queue.SimpleQueue()
        self._children: dict[int, Child] = {}
        """The processes that run or are being started, by the number of their thread."""
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._is_closed = self._cancels = False

    @property
    def pids(self) -> list[int]:
        """Process ids of the processes that run."""
        return [child.pid for child in list(self._children.values()) if child.pid is not None]

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> "Future[T]":
        """Let the next free process call a function.

        Raises:
            RuntimeError: if it is shut down.
        """
        future: Future[T] = Future()
        with self._lock:
            if self._is_closed:
                raise RuntimeError("the pool is shut down")
            self._calls.put((future, partial(fn, *args, **kwargs)))
            # Each takes one call at a time, so that there are threads for all that wait.
            if not self._threads:
                # Before `multiprocessing` waits for processes that have no reason to end.
                atexit.register(self.shutdown, cancel_futures=True)
            if len(self._threads) < self.count:
                number = len(self._threads)
                name = f"{self._set_up.name} {number}"
                thread = threading.Thread(
                    target=self._serve, args=(number,), name=name, daemon=True
                )
                self._threads.append(thread)
                thread.start()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Accept no more calls, and end the processes after those that were submitted.

        With `cancel_futures` those that wait are cancelled, and the others are killed.
        """
        with self._lock:
            self._is_closed, self._cancels = True, cancel_futures
            for _ in self._threads:
                self._calls.put(None)
        if cancel_futures:
            self.kill()
        for thread in self._threads if wait else ():
            thread.join(_CLOSE_S if cancel_futures else None)
        atexit.unregister(self.shutdown)

    def kill(self) -> None:
        """Kill the processes (SIGKILL); the calls that they compute fail."""
        for child in list(self._children.values()):
            child.kill()

    def _serve(self, number: int) -> None:
        """Give calls to one process, one after the other."""
        while True:
            try:
                call = self._calls.get(timeout=self._idle_s if number in self._children else None)
            except queue.Empty:
                self._end(number)
                continue
            if call is None:
                self._end(number)
                return
            # Known before the call begins, so that `kill` misses none.
            child = self._child(number)
            if self._cancels:
                call[0].cancel()
            if call[0].set_running_or_notify_cancel():
                self._compute(number, child, *call)

    def _child(self, number: int) -> Child:
        """Return the process of a thread; a new one if it has none that lives."""
        child = self._children.get(number)
        # One whose first call was cancelled was not started yet.
        has_ended = child is not None and child.pid is not None and child.wait(0)
        if child is not None and (child.is_killed or has_ended):
            self._end(number)
        if number not in self._children:
            self._children[number] = Child(_serve_calls, self._set_up)
        return self._children[number]

    def _compute(
        self, number: int, child: Child, future: "Future[Any]", call: Callable[[], Any]
    ) -> None:
        try:
            if child.pid is None:
                child.start()
        except OSError as error:
            self._end(number)
            future.set_exception(error)
            return
        try:
            child.pipe.send(call)
            while not child.wait(_CHECK_EVERY_S):
                self._check(child)
            if not child.pipe.poll():
                raise EOFError
            succeeded, result = child.pipe.recv()
        except (EOFError, OSError):
            self._end(number)
            future.set_exception(BrokenExecutor("the process that computed it has ended"))
        except Exception as error:  # an argument cannot be pickled, or the result not be unpickled
            future.set_exception(error)
        else:
            if succeeded:
                future.set_result(result)
            else:
                future.set_exception(result)

    def _check(self, child: Child) -> None:
        """Kill a process that a signal has stopped, or that takes too much memory."""
        if child.stopped_s() > STALLED_S:
            _logger.warning("a worker was stopped by a signal for %g s", STALLED_S)
            child.kill()
        elif self._most_bytes is not None and child.memory_bytes() > self._most_bytes:
            _logger.warning("a worker took over %d MB of memory", self._most_bytes >> 20)
            child.kill()

    def _end(self, number: int) -> None:
        child = self._children.pop(number, None)
        if child is not None and child.pid is not None:
            child.kill()
            child.end()
            child.pipe.close()


def _serve_calls(pipe: Connection) -> None:
    """Run a worker's loop: call each received function, and send its result or exception back."""
    while True:
        reply: tuple[bool, Any]
        try:
            data = pipe.recv_bytes()
        except (EOFError, OSError):
            return
        try:
            reply = True, pickle.loads(data)()  # noqa: S301 - from the parent
        except Exception as error:  # such as a module that is missing here
            reply = False, error
        try:
            pipe.send(reply)
        except Exception as error:  # it cannot be pickled
            pipe.send((False, TypeError(f"a result cannot be sent ({error})")))
