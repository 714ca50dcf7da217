"""Concurrency limit per role and kind of work: what takes long delays nothing else.

A request holds a slot while the server computes, not while its client sends or reads: a slow client
occupies none. No work is begun for a client that has left.
"""

import asyncio
from collections.abc import Awaitable, Callable
from typing import TypeVar

from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.policy import work_of
from app.api.problems import problem
from app.api.rate_limit import too_many
from app.api.work import Work
from app.limits.addresses import client_of
from app.limits.connections import set_client
from app.limits.fair_semaphore import FairSemaphore, NotAdmitted
from app.stage.roles import Role
from app.storage.errors import Busy

MAX_WAITING = 200
"""Requests of one address that may wait for a kind of work: thirty pages behind one address send
six each at most."""
_RETRY_S = 5
_EVENT_STREAM = "text/event-stream"
T = TypeVar("T")


class _ClientLeft(Busy):
    """A client has left while its request waited for a slot."""


class WorkSlots:
    """The semaphores of all kinds of work, by role."""

    def __init__(self) -> None:
        """Create none yet: those of a kind are made for its first request."""
        self._semaphores: dict[tuple[Role, Work], FairSemaphore] = {}
        self._is_closed = False

    def of(self, scope: Scope) -> FairSemaphore:
        """Return the semaphore of a request; to be called inside `TokenGuard`."""
        role, work = scope["state"]["role"], work_of(scope)
        semaphore = self._semaphores.get((role, work))
        if semaphore is None:
            slots = work.operators if role == "operator" else None
            semaphore = FairSemaphore(*(slots or work.spectators), MAX_WAITING)
            self._semaphores[role, work] = semaphore
            if self._is_closed:
                semaphore.close()
        return semaphore

    def close(self) -> None:
        """Send away all requests that wait, and any new one: the server stops."""
        self._is_closed = True
        for semaphore in self._semaphores.values():
            semaphore.close()


class ConcurrencyLimit(HttpMiddleware):
    """Guard that limits concurrent requests by kind of work; requests beyond the limit wait.

    To be installed inside `TokenGuard`, which sets the role, and inside `BodyMemoryLimit`, which
    sends the start of a response with its first chunk.
    """

    def __init__(self, app: ASGIApp, slots: WorkSlots) -> None:
        """Wrap an app."""
        super().__init__(app)
        self._slots = slots

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Wait for a slot and call the app, or respond 429 or 503."""
        slot = _Slot(self._slots.of(scope), client_of(scope), set_client(scope))
        try:
            await slot.acquire(is_new=True)
        except NotAdmitted as refused:
            await _refusal(refused)(scope, receive, send)
            return
        try:
            await self._app(scope, slot.wrap_receive(receive), slot.wrap_send(send))
        finally:
            slot.close()


class _Slot:
    """The slot of one request, released while its client sends or reads."""

    def __init__(self, semaphore: FairSemaphore, client: str, has_left: Callable[[], bool]) -> None:
        self._semaphore, self._client, self._has_left = semaphore, client, has_left
        self._is_held = False
        self._closed = asyncio.Event()
        # One task may send the response while another waits for the client's disconnect.
        self._acquire_lock = asyncio.Lock()

    async def acquire(self, is_new: bool = False) -> None:
        """Wait for the slot.

        Raises:
            NotAdmitted: if there is none for the request.
        """
        async with self._acquire_lock:
            if self._is_held or self._closed.is_set():
                return
            await self._semaphore.acquire(self._client, self._has_left, is_new)
            self._is_held = True
            if self._closed.is_set():  # closed while waiting
                self._release()

    def close(self) -> None:
        """Release the slot and never acquire it again."""
        self._closed.set()
        self._release()

    def wrap_receive(self, receive: Receive) -> Receive:
        """Wrap `receive`: release the slot until the body is complete, not during later calls.

        Of a client that has left it receives the disconnect, as of one that leaves later.
        """
        has_all = False

        async def call_without_slot() -> Message:
            nonlocal has_all
            try:
                message = await (receive() if has_all else self._without_slot(receive))
            except _ClientLeft:
                message = {"type": "http.disconnect"}
            has_all = has_all or not message.get("more_body", False)
            return message

        return call_without_slot

    def wrap_send(self, send: Send) -> Send:
        """Wrap `send`: release the slot while a chunk is sent, for good with the last one.

        Of a stream of events for good with the first one, the snapshot.
        """
        is_stream = False

        async def call_without_slot(message: Message) -> None:
            nonlocal is_stream
            if message["type"] == "http.response.start":
                is_stream = _is_stream(message)
                await send(message)
                return
            if is_stream or not message.get("more_body", False):
                self.close()
            await self._without_slot(lambda: send(message))

        return call_without_slot

    async def _without_slot(self, act: Callable[[], Awaitable[T]]) -> T:
        self._release()
        result = await act()
        try:
            await self.acquire()
        except NotAdmitted as refused:
            if refused.reason != "closed":
                raise _ClientLeft("the client has closed its connection", 1) from refused
            # The server stops: what is nearly complete is completed, and what takes long asks
            # `Stopping` by itself.
            self.close()
        return result

    def _release(self) -> None:
        if self._is_held:
            self._is_held = False
            self._semaphore.release(self._client)


def _is_stream(message: Message) -> bool:
    return Headers(raw=message.get("headers", [])).get("content-type", "").startswith(_EVENT_STREAM)


def _refusal(refused: NotAdmitted) -> Response:
    if refused.reason == "full":
        detail = (
            f"The server is busy, and {MAX_WAITING} requests of this address wait already; "
            f"try again in {_RETRY_S} s."
        )
        return too_many(detail, _RETRY_S)
    # Nobody reads it if the client has left.
    detail = "The server is stopping; try again later."
    return problem(503, detail, headers={"Retry-After": "1"})
