"""Memory budget: bounds the bytes buffered for clients that upload or download slowly.

There is a limit for all clients together and a lower one per client, so that one client cannot
use up the budget. Operators have a separate budget.
"""

import threading
from collections import Counter
from typing import Literal

Refusal = Literal["all", "share"]


class MemoryBudget:
    """Counts buffered bytes by client. Thread-safe.

    Attributes:
        held: bytes buffered for all clients together.
    """

    def __init__(self, limit: int, share: int) -> None:
        """Create a budget with nothing taken.

        Args:
            limit: for all clients together [bytes]; a larger request is granted if it is alone.
            share: for one client [bytes]; a larger request is granted if it is its only one.
        """
        self._limit, self._share = limit, share
        self.held = 0
        self._by_client: Counter[str] = Counter()
        self._lock = threading.Lock()

    def reserve(self, client: str, size: int) -> Refusal | None:
        """Reserve bytes for a client; return None, or which limit refuses them."""
        with self._lock:
            client_held = self._by_client[client]
            if client_held and client_held + size > self._share:
                return "share"
            if self.held and self.held + size > self._limit:
                return "all"
            self.held += size
            self._by_client[client] = client_held + size
            return None

    def release(self, client: str, size: int) -> None:
        """Release reserved bytes."""
        with self._lock:
            self.held -= size
            self._by_client[client] -= size
            if self._by_client[client] <= 0:
                del self._by_client[client]
