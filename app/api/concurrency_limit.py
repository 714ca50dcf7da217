"""Limits how many requests are worked on at once, so that an operator's never wait for strangers'.

A request has a turn while the server works on it, not while its client sends or reads: who reads
slowly keeps nobody from anything.
"""

import asyncio
from collections import OrderedDict, deque
from collections.abc import Awaitable, Callable
from typing import TypeVar

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.auth import Role
from app.limits.addresses import client_of

TURNS: dict[Role, int] = {"operator": 16, "spectator": 2}
"""Python threads share one interpreter: each that computes delays all the others."""
_STREAM = "text/event-stream"
T = TypeVar("T")


class RoundRobinSemaphore:
    """A semaphore whose waiters take turns by who they are, so that none wins by asking more.

    To be used on one event loop.
    """

    def __init__(self, size: int) -> None:
        """All of it is free.

        Args:
            size: how many may hold it at once.
        """
        self._free = size
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    async def acquire(self, who: str) -> None:
        """Wait for one's turn."""
        if self._free > 0:
            self._free -= 1
            return
        turn = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(who, deque()).append(turn)
        try:
            await turn
        except asyncio.CancelledError:
            if turn.done() and not turn.cancelled():
                self.release()
            raise

    def release(self) -> None:
        """Let the next one have it."""
        while self._waiting:
            who, turns = self._waiting.popitem(last=False)
            turn = turns.popleft()
            while turn.done() and turns:  # cancelled while it waited
                turn = turns.popleft()
            if turns:
                self._waiting[who] = turns
            if not turn.done():
                turn.set_result(None)
                return
        self._free += 1


class ConcurrencyLimit:
    """Lets so many requests of each role be worked on at once; the others wait."""

    def __init__(self, app: ASGIApp) -> None:
        """Limit an app; inside of what finds out the role."""
        self._app = app
        self._semaphores = {role: RoundRobinSemaphore(size) for role, size in TURNS.items()}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Wait for a turn, and pass on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        turn = _Turn(self._semaphores[scope["state"]["role"]], client_of(scope))
        await turn.take()
        try:
            await self._app(scope, turn.receiving(receive), turn.sending(send))
        finally:
            turn.give_up()


class _Turn:
    """The turn of one request."""

    def __init__(self, semaphore: RoundRobinSemaphore, who: str) -> None:
        self._semaphore, self._who = semaphore, who
        self._is_held = False
        self._given_up = asyncio.Event()
        # An answer may be sent while another task of the request waits for its client to go.
        self._taking = asyncio.Lock()

    async def take(self) -> None:
        async with self._taking:
            if self._is_held or self._given_up.is_set():
                return
            await self._semaphore.acquire(self._who)
            self._is_held = True
            if self._given_up.is_set():  # meanwhile
                self._let_go()

    def give_up(self) -> None:
        """For good."""
        self._given_up.set()
        self._let_go()

    def receiving(self, receive: Receive) -> Receive:
        """The same without a turn, until the body is here; later ones wait for its client to go."""
        has_all = False

        async def without_turn() -> Message:
            nonlocal has_all
            message = await (receive() if has_all else self._without(receive))
            has_all = has_all or not message.get("more_body", False)
            return message

        return without_turn

    def sending(self, send: Send) -> Send:
        """The same without a turn; for good once a stream of events has begun to wait for them."""
        is_stream = False

        async def without_turn(message: Message) -> None:
            nonlocal is_stream
            if message["type"] == "http.response.start":
                is_stream = _is_stream(message)
            elif is_stream:
                # Its first words, the snapshot, were work.
                self.give_up()
            await self._without(lambda: send(message))

        return without_turn

    async def _without(self, act: Callable[[], Awaitable[T]]) -> T:
        self._let_go()
        done = await act()
        await self.take()
        return done

    def _let_go(self) -> None:
        if self._is_held:
            self._is_held = False
            self._semaphore.release()


def _is_stream(message: Message) -> bool:
    return Headers(raw=message.get("headers", [])).get("content-type", "").startswith(_STREAM)
