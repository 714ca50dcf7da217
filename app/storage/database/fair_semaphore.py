"""A semaphore for threads that is handed over in the order in which they came."""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class FairSemaphore:
    """Lets so many threads in at once, first come, first served.

    With `threading.Semaphore`, or a pool's own queue, a thread that lets go and comes again at
    once overtakes those that wait, of which one may wait for ever.
    """

    def __init__(self, size: int) -> None:
        """Let as many in as `size` says."""
        self._free = size
        self._waiting: deque[threading.Lock] = deque()
        self._lock = threading.Lock()

    @property
    def waiting(self) -> int:
        """How many threads wait for a place."""
        return len(self._waiting)

    @contextmanager
    def taken(self, timeout_s: float, late: Callable[[], Exception]) -> Iterator[None]:
        """Wait for a place and keep it for as long as the context lasts.

        Args:
            timeout_s: how long to wait at most.
            late: makes the error to raise after that.
        """
        if not self._acquire(timeout_s):
            raise late()
        try:
            yield
        finally:
            self._release()

    def _acquire(self, timeout_s: float) -> bool:
        with self._lock:
            if self._free:
                self._free -= 1
                return True
            turn = threading.Lock()
            turn.acquire()
            self._waiting.append(turn)
        if turn.acquire(timeout=timeout_s):
            return True
        with self._lock:
            if turn in self._waiting:
                self._waiting.remove(turn)
                return False
        # It was handed over in the moment in which the time ran out.
        return True

    def _release(self) -> None:
        with self._lock:
            if self._waiting:
                self._waiting.popleft().release()
            else:
                self._free += 1
