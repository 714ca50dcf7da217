"""A fair (first-in, first-out) semaphore for threads."""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class FifoSemaphore:
    """Semaphore that is handed to waiting threads in the order in which they arrived.

    With `threading.Semaphore`, or a connection pool's own queue, a thread that releases and
    acquires again at once overtakes waiting threads, which may starve.
    """

    def __init__(self, size: int) -> None:
        """Admit `size` threads at a time."""
        self._free = size
        self._waiting: deque[threading.Lock] = deque()
        self._lock = threading.Lock()

    @property
    def waiting(self) -> int:
        """Number of threads that wait to acquire the semaphore."""
        return len(self._waiting)

    @property
    def is_exhausted(self) -> bool:
        """Whether a thread that acquires it now has to wait."""
        return not self._free

    @contextmanager
    def acquired(self, timeout_s: float, timeout_error: Callable[[], Exception]) -> Iterator[None]:
        """Acquire the semaphore, and release it when the context ends.

        Args:
            timeout_s: how long to wait at most.
            timeout_error: creates the exception to raise after that time.
        """
        if not self._acquire(timeout_s):
            raise timeout_error()
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
        # It was handed over to this thread between the timeout and the lock.
        return True

    def _release(self) -> None:
        with self._lock:
            if self._waiting:
                self._waiting.popleft().release()
            else:
                self._free += 1
