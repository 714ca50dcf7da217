"""Per-client token bucket, for rate limits."""

import threading
import time
from collections.abc import Callable

from cachetools import LRUCache

MAX_CLIENTS = 10_000
"""Buckets kept at most."""


class RateLimiter:
    """A token bucket per client. Thread-safe.

    Beyond `MAX_CLIENTS` the least recently used buckets are dropped, which bounds memory.
    """

    def __init__(self, size: int, per_s: float, now: Callable[[], float] = time.monotonic) -> None:
        """Start with full buckets.

        Args:
            size: capacity of a bucket in tokens, which is the largest burst.
            per_s: refill rate [tokens/s].
            now: monotonic clock [s].
        """
        self._size, self._per_s, self._now = size, per_s, now
        self._buckets: LRUCache[str, tuple[float, float]] = LRUCache(MAX_CLIENTS)
        """By client: number of tokens, and when it was computed [s]."""
        self._lock = threading.Lock()

    def take(self, client: str) -> float:
        """Take a token and return 0; if there is none, return the time until there is one [s]."""
        with self._lock:
            tokens = self._tokens(client)
            if tokens < 1:
                return (1 - tokens) / self._per_s
            self._keep(client, tokens - 1)
            return 0.0

    def wait_s(self, client: str) -> float:
        """Return the time until there is a token [s], and take none; 0 if there is one."""
        with self._lock:
            return max(0.0, (1 - self._tokens(client)) / self._per_s)

    def charge(self, client: str, tokens: float) -> None:
        """Take further tokens of a client for what it cost; the bucket may owe them then."""
        with self._lock:
            self._keep(client, self._tokens(client) - tokens)

    def debt_s(self, client: str) -> float:
        """Return the time until a bucket owes nothing [s]; 0 if it does not."""
        with self._lock:
            return max(0.0, -self._tokens(client) / self._per_s)

    def _keep(self, client: str, tokens: float) -> None:
        self._buckets[client] = (tokens, self._now())

    def _tokens(self, client: str) -> float:
        tokens, since_s = self._buckets.get(client, (float(self._size), 0.0))
        return min(self._size, tokens + max(0.0, self._now() - since_s) * self._per_s)
