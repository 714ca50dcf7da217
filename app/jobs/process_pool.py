"""Pool of worker processes for interactive requests, which shut down when idle."""

import math
import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import (
    FIRST_EXCEPTION,
    BrokenExecutor,
    CancelledError,
    Future,
    wait,
)
from typing import TypeVar

from app.storage.errors import Busy
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.processes import SetUp
from hexapods.system_processes import processor_s
from hexapods.worker_pool import WorkerPool

IDLE_S = 60.0
TIMEOUT_S = 60.0
NICENESS = 10
"""Less than that of jobs, since a user waits for the reply."""
_CHUNK_SIZE = 3
_CHECK_EVERY_S, _CLOSE_S = 0.1, 3.0
T = TypeVar("T")
R = TypeVar("R")


class TookTooLong(Busy):
    """A request was given up after the pool's timeout: it is slow, or the machine is busy."""


class OutOfProcessorTime(HexapodError):
    """A request was given up, since it has taken more processor time than it may."""


class ProcessPool:
    """Worker processes, started on the first request and shut down after an idle timeout.

    They die with the server, however that ends.

    Attributes:
        count: number of processes.
    """

    def __init__(
        self,
        count: int | None = None,
        idle_s: float = IDLE_S,
        timeout_s: float = TIMEOUT_S,
        *,
        name: str = "pool worker",
        niceness: int = NICENESS,
    ) -> None:
        """Create the pool; the first request starts the processes.

        Args:
            count: number of processes; by default one per core.
            idle_s: time without a request after which they are shut down [s].
            timeout_s: time after which a request is given up, and its processes are killed [s].
            name: of the processes.
            niceness: of the processes.
        """
        self.count, self._timeout_s = count or os.cpu_count() or 1, timeout_s
        set_up = SetUp(name=name, niceness=niceness)
        self._pool = WorkerPool(self.count, set_up, idle_s=idle_s)
        self._turn = threading.Lock()
        """Held by the request that is served."""
        self._closed = False

    @property
    def pids(self) -> list[int]:
        """Process ids of the running workers."""
        return self._pool.pids

    def map(
        self,
        function: Callable[[T], R],
        arguments: Sequence[T],
        check: Callable[[], None] = lambda: None,
        limit_s: float = math.inf,
    ) -> list[R]:
        """Call a function of a module with each of some arguments, and wait.

        Callable from any thread; requests are serialised.

        Args:
            function: the function.
            arguments: what it is called with.
            check: called ten times a second meanwhile; if it raises, the request is given up, and
                the processes that work for it are killed.
            limit_s: processor time that all calls together may take [s]. Unlike the timeout it does
                not depend on what else the machine does.

        Returns:
            what it returned, in the same order.

        Raises:
            InvalidInput: if a call fails.
            OutOfProcessorTime: if the limit is exceeded.
            TookTooLong: if the timeout passes.
            Busy: if a worker exits, or the pool is closed.
        """
        while not self._turn.acquire(timeout=_CHECK_EVERY_S):
            self._check_open()
            check()
        try:
            self._check_open()
            return self._results(function, arguments, check, limit_s)
        except (BrokenExecutor, CancelledError, OSError, RuntimeError) as error:
            message = "the processes that tried it are gone (one of them ended); try again"
            raise Busy(message, 1) from error
        finally:
            self._turn.release()

    def close(self) -> None:
        """Kill the processes; reject further requests, and those that wait."""
        self._closed = True
        self._pool.shutdown(cancel_futures=True)

    def _check_open(self) -> None:
        if self._closed:
            raise Busy("the server is stopping; try again later", 1)

    def _results(
        self,
        function: Callable[[T], R],
        arguments: Sequence[T],
        check: Callable[[], None],
        limit_s: float,
    ) -> list[R]:
        deadline_s = time.monotonic() + self._timeout_s
        before_s = {pid: processor_s(pid) for pid in self.pids}
        starts = range(0, len(arguments), _CHUNK_SIZE)
        calls = [self._pool.submit(_call, function, arguments[i : i + _CHUNK_SIZE]) for i in starts]
        waiting: set[Future[list[R]]] = set(calls)
        try:
            while waiting:
                done, waiting = wait(waiting, _CHECK_EVERY_S, FIRST_EXCEPTION)
                for call in done:
                    call.result()
                if waiting:
                    check()
                # A process that has ended counts as 0: its time cannot be read any more.
                taken_s = sum(max(processor_s(p) - before_s.get(p, 0.0), 0.0) for p in self.pids)
                if waiting and taken_s > limit_s:
                    raise OutOfProcessorTime(f"it took over {limit_s:g} s of processor time")
                if waiting and time.monotonic() > deadline_s:
                    message = f"it took over {self._timeout_s:g} s, and was given up; try again"
                    raise TookTooLong(message, 1)
        except BaseException as error:
            for call in calls:
                call.cancel()
            if not isinstance(error, InvalidInput):
                self._pool.kill()
                wait(calls, _CLOSE_S)
            raise
        return [result for call in calls for result in call.result()]


def _call(function: Callable[[T], R], arguments: Sequence[T]) -> list[R]:
    """Call a function in a worker; all that fails there is InvalidInput, and can be pickled."""
    try:
        return [function(argument) for argument in arguments]
    except HexapodError as error:
        raise InvalidInput(str(error)) from None
    # User-supplied agents are untrusted code: they may raise anything, and call `sys.exit`.
    except (Exception, SystemExit) as error:
        raise InvalidInput(f"something in it broke ({type(error).__name__}: {error})") from None
