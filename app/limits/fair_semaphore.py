"""Fair semaphore: turns by client, a share of the slots for each, and a bounded queue."""

import asyncio
from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from typing import Literal, NamedTuple

Reason = Literal["closed", "full", "left"]


class NotAdmitted(Exception):
    """A slot was not given; `reason` tells why.

    `closed`: the semaphore was closed. `full`: the client has as many waiting as it may. `left`:
    it has gone meanwhile.
    """

    def __init__(self, reason: Reason) -> None:
        super().__init__(reason)
        self.reason: Reason = reason


class _Waiter(NamedTuple):
    admitted: "asyncio.Future[None]"
    has_left: Callable[[], bool]


class FairSemaphore:
    """Semaphore that is round-robin over clients, and first in, first out within a client.

    A waiter that has left gets no slot, also if it was the next. Not thread-safe; to be used on one
    event loop.
    """

    def __init__(self, size: int, per_client: int | None = None, max_waiting: int = 200) -> None:
        """Create a semaphore with all slots free.

        Args:
            size: number of concurrent holders.
            per_client: how many of them one client may be; None for all.
            max_waiting: how many of one client may wait.
        """
        self._free, self._per_client = size, size if per_client is None else per_client
        self._max_waiting = max_waiting
        self._held: Counter[str] = Counter()
        self._queues: OrderedDict[str, deque[_Waiter]] = OrderedDict()
        """Waiting requests by client; the client whose turn is next comes first."""
        self._is_closed = False

    async def acquire(
        self, client: str, has_left: Callable[[], bool] = lambda: False, is_new: bool = True
    ) -> None:
        """Wait for a slot.

        Args:
            client: whose turn it takes.
            has_left: whether it does not want the slot any more; looked at before it gets one.
            is_new: whether `max_waiting` applies; not for one that was admitted before.

        Raises:
            NotAdmitted: if it gets none.
        """
        if self._is_closed:
            raise NotAdmitted("closed")
        if self._free > 0 and self._held[client] < self._per_client:
            if has_left():
                raise NotAdmitted("left")
            self._take(client)
            return
        queue = self._queues.setdefault(client, deque())
        if is_new and len(queue) >= self._max_waiting and not self._drop_departed(queue):
            raise NotAdmitted("full")
        waiter = _Waiter(asyncio.get_running_loop().create_future(), has_left)
        queue.append(waiter)
        try:
            await waiter.admitted
        except asyncio.CancelledError:
            if not waiter.admitted.cancelled() and waiter.admitted.exception() is None:
                self.release(client)
            raise

    def release(self, client: str) -> None:
        """Free a slot of a client, and give it to the next waiter."""
        self._held[client] -= 1
        if not self._held[client]:
            del self._held[client]
        self._free += 1
        self._admit()

    def close(self) -> None:
        """Send all waiters away, and admit no more."""
        self._is_closed = True
        queues, self._queues = self._queues, OrderedDict()
        for queue in queues.values():
            for waiter in queue:
                _refuse(waiter, "closed")

    def _admit(self) -> None:
        """Give free slots to waiters."""
        while self._free > 0 and (client := self._next_client()) is not None:
            queue = self._queues[client]
            while queue:
                waiter = queue.popleft()
                if waiter.admitted.done():  # cancelled while waiting
                    continue
                if waiter.has_left():
                    _refuse(waiter, "left")
                    continue
                self._take(client)
                waiter.admitted.set_result(None)
                self._queues.move_to_end(client)
                break
            if not queue:
                del self._queues[client]

    def _next_client(self) -> str | None:
        return next(
            (client for client in self._queues if self._held[client] < self._per_client), None
        )

    def _take(self, client: str) -> None:
        self._free -= 1
        self._held[client] += 1

    def _drop_departed(self, queue: deque[_Waiter]) -> bool:
        """Remove the waiters that have left from a queue; return whether there were any."""
        present = []
        for waiter in queue:
            if waiter.has_left():
                _refuse(waiter, "left")
            elif not waiter.admitted.done():
                present.append(waiter)
        is_shorter = len(present) < len(queue)
        queue.clear()
        queue.extend(present)
        return is_shorter


def _refuse(waiter: _Waiter, reason: Reason) -> None:
    if not waiter.admitted.done():
        waiter.admitted.set_exception(NotAdmitted(reason))
