"""Pool of worker processes for interactive requests, which shut down when idle."""

import multiprocessing
import os
import queue
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple, TypeVar

from app.domain.errors import HexapodError, InvalidInput
from app.jobs.fork_server import process_context
from app.processes import kill_group, set_up_process
from app.storage.errors import Busy

IDLE_S = 60.0
TIMEOUT_S = 60.0
NICENESS = 10
"""Less than that of jobs, since a user waits for the reply."""
_CHUNK_SIZE = 3
_CLOSE_S, _KILL_EVERY_S = 3.0, 0.02
T = TypeVar("T")
R = TypeVar("R")


class _Request(NamedTuple):
    function: Callable[[Any], Any]
    arguments: Sequence[Any]
    future: "Future[list[Any]]"


class _Failure(NamedTuple):
    """Reason why a call failed, in a sentence, since not all errors can be unpickled."""

    reason: str


class ProcessPool:
    """Worker processes, started on the first request and shut down after an idle timeout.

    They die with the server, however that ends.
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
        self._count, self._idle_s = count or os.cpu_count() or 1, idle_s
        self._timeout_s = timeout_s
        self._requests: queue.SimpleQueue[_Request | None] = queue.SimpleQueue()
        self._executor: ProcessPoolExecutor | None = None
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self._closed = False

    @property
    def pids(self) -> list[int]:
        """Process ids of the running workers."""
        executor = self._executor
        # Private, since the executor offers no way to kill its processes before Python 3.14.
        return [] if executor is None else list(executor._processes or ())  # noqa: SLF001

    def map(self, function: Callable[[T], R], arguments: Sequence[T]) -> list[R]:
        """Call a function of a module with each of some arguments, and wait.

        Callable from any thread; requests are serialised.

        Returns:
            what it returned, in the same order.

        Raises:
            InvalidInput: if a call fails.
            Busy: if a worker exits, the timeout passes, or the pool is closed.
        """
        request = _Request(function, arguments, Future())
        with self._lock:
            self._check_open()
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._serve, name="process pool", daemon=True
                )
                self._thread.start()
            self._requests.put(request)
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
            try:
                self._check_open()
                request.future.set_result(self._run(request.function, request.arguments))
            except HexapodError as error:
                request.future.set_exception(error)
            except (BrokenProcessPool, TimeoutError, OSError, EOFError) as error:
                self._stop_workers()
                timed_out = isinstance(error, TimeoutError)
                reason = f"it took over {self._timeout_s:g} s" if timed_out else "one of them ended"
                message = f"the processes that tried it are gone ({reason}); try again"
                request.future.set_exception(Busy(message, 1))
            except Exception as error:  # such as an argument or result that cannot be pickled
                request.future.set_exception(error)

    def _run(self, function: Callable[[Any], Any], arguments: Sequence[Any]) -> list[Any]:
        if self._executor is None:
            self._executor = ProcessPoolExecutor(
                self._count, process_context(), initializer=_set_up_worker
            )
        results = []
        guarded = partial(_guarded, function)
        for reply in self._executor.map(
            guarded, arguments, timeout=self._timeout_s, chunksize=_CHUNK_SIZE
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
        executor = self._executor
        for process in list((executor._processes or {}).values()) if executor else ():  # noqa: SLF001
            with suppress(ValueError):  # it has exited, and its handle is closed
                if process.pid is not None and process.is_alive():
                    kill_group(process.pid)
                    process.kill()  # it may have no group of its own yet


def _set_up_worker() -> None:
    set_up_process(NICENESS)
    threading.Thread(target=_exit_with_parent, daemon=True).start()


def _exit_with_parent() -> None:
    """Exit after the server has; PR_SET_PDEATHSIG misses a server that died before its call."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _guarded(function: Callable[[Any], Any], argument: Any) -> Any:
    """Call a function in a worker; return a `_Failure` if it fails."""
    try:
        return function(argument)
    except HexapodError as error:
        return _Failure(str(error))
    # User-supplied agents are untrusted code: they may raise anything, and call `sys.exit`.
    except (Exception, SystemExit) as error:
        return _Failure(f"something in it broke ({type(error).__name__}: {error})")
