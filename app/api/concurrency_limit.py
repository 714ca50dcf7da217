"""Concurrency limit per role: spectators' requests do not delay an operator's.

A request holds a slot while the server computes, not while its client sends or reads: a slow client
occupies none.
"""

import asyncio
from collections import OrderedDict, deque
from collections.abc import Awaitable, Callable
from typing import TypeVar

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.auth import PUBLIC_PATHS, Role
from app.api.middleware import HttpMiddleware
from app.api.rate_limit import is_encoding, is_spectators_what_if
from app.limits.addresses import client_of

SLOTS: dict[Role, int] = {"operator": 16, "spectator": 2}
"""Slots by role. Few, as Python threads share one interpreter lock and delay each other."""
WHAT_IF_SLOTS = 1
"""Slots of spectators' what-ifs, each of which takes a second of all cores: they do not delay what
other spectators read, and an operator's what-if waits for one of them at most."""
ENCODING_SLOTS: dict[Role, int] = {"operator": 2, "spectator": 1}
"""Slots of files of long runs, which take up to minutes: they delay neither what a spectator reads
nor what an operator commands."""
PROBE_SLOTS = 2
"""Slots of liveness and readiness probes, which take milliseconds: a server with long requests in
progress is not taken for a dead one."""
_EVENT_STREAM = "text/event-stream"
T = TypeVar("T")


class RoundRobinSemaphore:
    """A fair semaphore: round-robin over clients, first in, first out within a client.

    Not thread-safe; to be used on one event loop.
    """

    def __init__(self, size: int) -> None:
        """Create a semaphore with all slots free.

        Args:
            size: number of concurrent holders.
        """
        self._free = size
        self._waiters: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    async def acquire(self, client: str) -> None:
        """Wait for a slot."""
        if self._free > 0:
            self._free -= 1
            return
        future = asyncio.get_running_loop().create_future()
        self._waiters.setdefault(client, deque()).append(future)
        try:
            await future
        except asyncio.CancelledError:
            if future.done() and not future.cancelled():
                self.release()
            raise

    def release(self) -> None:
        """Pass the slot to the next waiter, or free it."""
        while self._waiters:
            client, futures = self._waiters.popitem(last=False)
            future = futures.popleft()
            while future.done() and futures:  # cancelled while waiting
                future = futures.popleft()
            if futures:
                self._waiters[client] = futures
            if not future.done():
                future.set_result(None)
                return
        self._free += 1


class ConcurrencyLimit(HttpMiddleware):
    """Middleware that limits concurrent requests by role; requests beyond the limit wait."""

    def __init__(self, app: ASGIApp) -> None:
        """Wrap an app; to be installed inside `TokenGuard`, which sets the role."""
        super().__init__(app)
        self._semaphores = {role: RoundRobinSemaphore(size) for role, size in SLOTS.items()}
        self._encodings = {role: RoundRobinSemaphore(n) for role, n in ENCODING_SLOTS.items()}
        self._what_ifs = RoundRobinSemaphore(WHAT_IF_SLOTS)
        self._probes = RoundRobinSemaphore(PROBE_SLOTS)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Wait for a slot, and call the app."""
        slot = _Slot(self._semaphore_of(scope), client_of(scope))
        await slot.acquire()
        try:
            await self._app(scope, slot.wrap_receive(receive), slot.wrap_send(send))
        finally:
            slot.close()

    def _semaphore_of(self, scope: Scope) -> RoundRobinSemaphore:
        if scope["path"] in PUBLIC_PATHS:
            return self._probes
        if is_spectators_what_if(scope):
            return self._what_ifs
        semaphores = self._encodings if is_encoding(scope) else self._semaphores
        return semaphores[scope["state"]["role"]]


class _Slot:
    """The slot of one request, released while its client sends or reads."""

    def __init__(self, semaphore: RoundRobinSemaphore, client: str) -> None:
        self._semaphore, self._client = semaphore, client
        self._is_held = False
        self._closed = asyncio.Event()
        # One task may send the response while another waits for the client's disconnect.
        self._acquire_lock = asyncio.Lock()

    async def acquire(self) -> None:
        async with self._acquire_lock:
            if self._is_held or self._closed.is_set():
                return
            await self._semaphore.acquire(self._client)
            self._is_held = True
            if self._closed.is_set():  # closed while waiting
                self._release()

    def close(self) -> None:
        """Release the slot and never acquire it again."""
        self._closed.set()
        self._release()

    def wrap_receive(self, receive: Receive) -> Receive:
        """Wrap `receive`: release the slot until the body is complete, not during later calls."""
        has_all = False

        async def call_without_slot() -> Message:
            nonlocal has_all
            message = await (receive() if has_all else self._without_slot(receive))
            has_all = has_all or not message.get("more_body", False)
            return message

        return call_without_slot

    def wrap_send(self, send: Send) -> Send:
        """Wrap `send`: release the slot while sending, and for good after a stream's snapshot."""
        is_stream = False

        async def call_without_slot(message: Message) -> None:
            nonlocal is_stream
            if message["type"] == "http.response.start":
                is_stream = _is_stream(message)
            elif is_stream:
                # The first event, the snapshot, was computed under the slot.
                self.close()
            await self._without_slot(lambda: send(message))

        return call_without_slot

    async def _without_slot(self, act: Callable[[], Awaitable[T]]) -> T:
        self._release()
        result = await act()
        await self.acquire()
        return result

    def _release(self) -> None:
        if self._is_held:
            self._is_held = False
            self._semaphore.release()


def _is_stream(message: Message) -> bool:
    return Headers(raw=message.get("headers", [])).get("content-type", "").startswith(_EVENT_STREAM)
