"""One browser that watches: what waits for it, and what it follows."""

import asyncio
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.viewer import follow, wire


@dataclass(slots=True)
class Counters:
    """What the hub has done since it was made."""

    viewers: int = 0
    """How many watch now."""
    frames_sent: int = 0
    frames_merged: int = 0
    """Frames whose news a viewer got as a part of a later one, or will, because it was behind."""
    resyncs: int = 0
    """Viewers that were told to begin anew, because viser itself did."""


CatchUp = Callable[["Session"], tuple[wire.Frame, int] | None]
"""One frame with all that a session has missed, and the version it brings it to; None while there
is nothing to show."""


class Session:
    """Sends to one accepted websocket at the speed it reads, and hears what it wants to follow.

    A few frames wait in order. When more would, all of them are dropped, and what they said comes
    in one frame when the browser is ready for it; however long that takes, nothing grows here.
    """

    WAITING_FRAMES = 4

    def __init__(
        self, websocket: WebSocket, view: str, counters: Counters, catch_up: CatchUp
    ) -> None:
        self.view = view
        self.version: int | None = None
        """Which one the browser has or is being sent; None before the first, the whole scene."""
        self._websocket = websocket
        self._counters = counters
        self._catch_up = catch_up
        self._waiting: deque[tuple[wire.Frame, int]] = deque()
        self._behind = True
        self._wake = asyncio.Event()
        self._wake.set()
        self._closing: tuple[int, str] | None = None
        self._sender: asyncio.Task[None] | None = None

    def push(self, frame: wire.Frame, version: int) -> None:
        """Send a frame as soon as the browser is ready, by itself or in what it has missed."""
        if not self._behind and len(self._waiting) < self.WAITING_FRAMES:
            self._waiting.append((frame, version))
        else:
            if self.version is not None:
                self._counters.frames_merged += len(self._waiting) + 1
            self._waiting.clear()
            self._behind = True
        self._wake.set()

    def wake(self) -> None:
        """Look again whether there is anything to show."""
        self._wake.set()

    def close(self, code: int, reason: str) -> None:
        """Close instead of sending what waits. Browsers reconnect by themselves."""
        self._closing = (code, reason)
        self._wake.set()

    async def closed(self, timeout_s: float) -> None:
        """Wait until nothing is sent any more; past the time, stop a send that does not end."""
        if self._sender is not None:
            await asyncio.wait([self._sender], timeout=timeout_s)
            self._sender.cancel()

    async def run(self, on_view: Callable[["Session"], None]) -> None:
        """Serve until either side closes.

        Args:
            on_view: Called after the browser has chosen another view.
        """
        self._sender = asyncio.create_task(self._send())
        listener = asyncio.create_task(self._listen(on_view))
        both = (self._sender, listener)
        try:
            await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in both:
                task.cancel()
            outcomes = await asyncio.gather(*both, return_exceptions=True)
        for outcome in outcomes:
            if isinstance(outcome, Exception):
                raise outcome

    async def _send(self) -> None:
        try:
            while self._closing is None:
                following = self._next()
                if following is None:
                    self._wake.clear()
                    await self._wake.wait()
                    continue
                frame, self.version = following
                await self._websocket.send_bytes(frame.raw)
                self._counters.frames_sent += 1
            await self._websocket.close(*self._closing)
        except (WebSocketDisconnect, RuntimeError):
            # Gone; a RuntimeError is how uvicorn refuses to send when it closed by itself.
            return

    def _next(self) -> tuple[wire.Frame, int] | None:
        if self._waiting:
            return self._waiting.popleft()
        if not self._behind:
            return None
        missed = self._catch_up(self)
        self._behind = missed is None
        return missed

    async def _listen(self, on_view: Callable[["Session"], None]) -> None:
        while True:
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            view = follow.chosen_view(message.get("bytes"))
            if view is not None and view != self.view:
                self.view = view
                on_view(self)
