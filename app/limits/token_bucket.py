"""How often someone may do something: an allowance that is used up, and fills again with time."""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable

MAX_CALLERS = 10_000


class RateLimiter:
    """One allowance for each caller. Safe to use from any thread.

    Callers that did nothing for the longest are forgotten, so that nothing grows.
    """

    def __init__(self, size: int, per_s: float, now: Callable[[], float] = time.monotonic) -> None:
        """Every caller may do all of it at once.

        Args:
            size: how much can be done at once.
            per_s: how fast it fills again.
            now: the clock, in seconds.
        """
        self._size, self._per_s, self._now = size, per_s, now
        self._callers: OrderedDict[str, tuple[float, float]] = OrderedDict()
        """By caller what was left, and when."""
        self._lock = threading.Lock()

    def wait_s(self, caller: str) -> float:
        """How long until there is something left; 0 if there is now."""
        with self._lock:
            return max(0.0, (1 - self._left(caller)) / self._per_s)

    def take(self, caller: str) -> float:
        """Use some of it, if there is any; else say how long to wait [s]."""
        with self._lock:
            left = self._left(caller)
            if left < 1:
                return (1 - left) / self._per_s
            self._callers[caller] = (left - 1, self._now())
            self._callers.move_to_end(caller)
            if len(self._callers) > MAX_CALLERS:
                self._callers.popitem(last=False)
            return 0.0

    def _left(self, caller: str) -> float:
        left, since_s = self._callers.get(caller, (float(self._size), 0.0))
        return min(self._size, left + max(0.0, self._now() - since_s) * self._per_s)
