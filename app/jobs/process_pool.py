"""Pool of worker processes for interactive requests, which shut down when idle."""

import os
import queue
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple, TypeVar

from app.jobs.fork_server import process_context
from app.storage.errors import Busy
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.processes import end_with_parent, kill_workers, set_up_process, worker_processes

IDLE_S = 60.0
TIMEOUT_S = 60.0
NICENESS = 10
"""Less than that of jobs, since a user waits for the reply."""
_CHUNK_SIZE = 3
_CLOSE_S, _KILL_EVERY_S = 3.0, 0.02
_CHECK_EVERY_S = 0.1
T = TypeVar("T")
R = TypeVar("R")


class TookTooLong(Busy):
    """A request was given up, since it took longer than it may."""


@dataclass(frozen=True, eq=False)
class _Request:
    function: Callable[[Any], Any]
    arguments: Sequence[Any]
    timeout_s: float
    future: "Future[list[Any]]" = field(default_factory=Future)


class _Failure(NamedTuple):
    """Reason why a call failed, in a sentence, since not all errors can be unpickled."""

    reason: str


class ProcessPool:
    """Worker processes, started on the first request and shut down after an idle timeout.

    They die with the server, however that ends.

    Attributes:
        count: number of processes.
    """

    def __init__(
        self, count: int | None = None, idle_s: float = IDLE_S, timeout_s: float = TIMEOUT_S
    ) -> None:
        """Create the pool; the first request starts the processes.

        Args:
            count: number of processes; by default one per core.
            idle_s: time without a request after which they are shut down [s].
            timeout_s: time after which a request is given up, and its processes are killed [s].
        """
        self.count, self._idle_s = count or os.cpu_count() or 1, idle_s
        self._timeout_s = timeout_s
        self._requests: queue.SimpleQueue[_Request | None] = queue.SimpleQueue()
        self._executor: ProcessPoolExecutor | None = None
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self._running: _Request | None = None
        self._closed = False

    @property
    def pids(self) -> list[int]:
        """Process ids of the running workers."""
        executor = self._executor
        found = [] if executor is None else worker_processes(executor)
        return [process.pid for process in found if process.pid is not None]

    def map(
        self,
        function: Callable[[T], R],
        arguments: Sequence[T],
        check: Callable[[], None] = lambda: None,
        timeout_s: float | None = None,
    ) -> list[R]:
        """Call a function of a module with each of some arguments, and wait.

        Callable from any thread; requests are serialised.

        Args:
            function: the function.
            arguments: what it is called with.
            check: called ten times a second meanwhile; if it raises, the request is given up, and
                the processes that work for it are killed.
            timeout_s: time after which this request is given up [s]; that of the pool if None.

        Returns:
            what it returned, in the same order.

        Raises:
            InvalidInput: if a call fails.
            TookTooLong: if the timeout passes.
            Busy: if a worker exits, or the pool is closed.
        """
        request = _Request(function, arguments, self._timeout_s if timeout_s is None else timeout_s)
        with self._lock:
            self._check_open()
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._serve, name="process pool", daemon=True
                )
                self._thread.start()
            self._requests.put(request)
        try:
            while not wait([request.future], _CHECK_EVERY_S).done:
                check()
        except BaseException:
            self._give_up(request)
            raise
        return request.future.result()

    def close(self) -> None:
        """Kill the processes; reject further requests, and those that wait."""
        with self._lock:
            self._closed = True
            self._requests.put(None)
            thread = self._thread
        deadline = time.monotonic() + _CLOSE_S
        # More than once: a worker that is being started is not listed yet.
        while thread is not None and thread.is_alive() and time.monotonic() < deadline:
            self._kill_workers()
            thread.join(_KILL_EVERY_S)

    def _check_open(self) -> None:
        if self._closed:
            raise Busy("the server is stopping; try again later", 1)

    def _serve(self) -> None:
        while True:
            try:
                request = self._requests.get(timeout=self._idle_s)
            except queue.Empty:
                self._stop_workers()
                continue
            if request is None:
                self._stop_workers()
                return
            if not request.future.set_running_or_notify_cancel():
                continue
            try:
                self._check_open()
                request.future.set_result(self._run(request))
            except HexapodError as error:
                request.future.set_exception(error)
            except TimeoutError:
                self._stop_workers()
                message = f"it took over {request.timeout_s:g} s, and was given up; try again"
                request.future.set_exception(TookTooLong(message, 1))
            except (BrokenProcessPool, OSError, EOFError):
                self._stop_workers()
                message = "the processes that tried it are gone (one of them ended); try again"
                request.future.set_exception(Busy(message, 1))
            except Exception as error:  # such as an argument or result that cannot be pickled
                request.future.set_exception(error)

    def _give_up(self, request: _Request) -> None:
        """Let a request that waits not begin, and kill the processes of one that is served."""
        request.future.cancel()
        deadline = time.monotonic() + _CLOSE_S
        # More than once, as in `close`.
        while not request.future.done() and time.monotonic() < deadline:
            with self._lock:
                if self._running is request:
                    self._kill_workers()
            wait([request.future], _KILL_EVERY_S)

    def _run(self, request: _Request) -> list[Any]:
        with self._lock:
            self._running = request
        try:
            return self._results(request)
        finally:
            with self._lock:
                self._running = None

    def _results(self, request: _Request) -> list[Any]:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                self.count, process_context(), initializer=_set_up_worker
            )
        results = []
        guarded = partial(_guarded, request.function)
        for reply in self._executor.map(
            guarded, request.arguments, timeout=request.timeout_s, chunksize=_CHUNK_SIZE
        ):
            if isinstance(reply, _Failure):
                # All calls of a request share it; leaving the iteration cancels the others.
                raise InvalidInput(reply.reason)
            results.append(reply)
        return results

    def _stop_workers(self) -> None:
        self._kill_workers()
        if self._executor is not None:
            self._executor.shutdown()
            self._executor = None

    def _kill_workers(self) -> None:
        if (executor := self._executor) is not None:
            kill_workers(executor)


def _set_up_worker() -> None:
    set_up_process(NICENESS)
    end_with_parent()


def _guarded(function: Callable[[Any], Any], argument: Any) -> Any:
    """Call a function in a worker; return a `_Failure` if it fails."""
    try:
        return function(argument)
    except HexapodError as error:
        return _Failure(str(error))
    # User-supplied agents are untrusted code: they may raise anything, and call `sys.exit`.
    except (Exception, SystemExit) as error:
        return _Failure(f"something in it broke ({type(error).__name__}: {error})")
