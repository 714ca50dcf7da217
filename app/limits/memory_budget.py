"""A memory budget: how many bytes may be held for clients that have yet to send or read the rest.

Everyone together is held to a limit, and one client to a share of it, so that others always get
some. Operators have a budget of their own.
"""

import threading
from collections import Counter
from typing import Literal

Refusal = Literal["all", "share"]


class MemoryBudget:
    """Counts bytes by client. Safe to use from any thread.

    Attributes:
        held: bytes, of all clients.
    """

    def __init__(self, limit: int, share: int) -> None:
        """Nothing is held.

        Args:
            limit: bytes, of all clients together. What is larger alone gets in alone.
            share: bytes, of one client.
        """
        self._limit, self._share = limit, share
        self.held = 0
        self._by_client: Counter[str] = Counter()
        self._lock = threading.Lock()

    def take(self, client: str, size: int) -> Refusal | None:
        """Hold so many bytes more for a client, or say what does not let it."""
        with self._lock:
            mine = self._by_client[client]
            if mine and mine + size > self._share:
                return "share"
            if self.held and self.held + size > self._limit:
                return "all"
            self.held += size
            self._by_client[client] = mine + size
            return None

    def give_back(self, client: str, size: int) -> None:
        """Hold them no more."""
        with self._lock:
            self.held -= size
            self._by_client[client] -= size
            if self._by_client[client] <= 0:
                del self._by_client[client]
