"""One browser that watches: what waits for it, and what it follows."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.viewer import follow, wire
from app.viewer.snapshot import Backlog


@dataclass(slots=True)
class Counters:
    """What the hub has done since it was made."""

    viewers: int = 0
    """How many watch now."""
    frames_sent: int = 0
    frames_merged: int = 0
    """Frames that a viewer got as a part of one later frame, because it was behind."""
    resyncs: int = 0
    """Viewers that were told to begin anew, because viser itself did."""


class Session:
    """Sends to one accepted websocket at the speed it reads, and hears what it wants to follow."""

    def __init__(self, websocket: WebSocket, view: str, counters: Counters) -> None:
        self.view = view
        self.started = False
        """Whether it has been given the whole scene, which the frames after that build on."""
        self._websocket = websocket
        self._counters = counters
        self._backlog = Backlog()
        self._wake = asyncio.Event()
        self._closing: tuple[int, str] | None = None
        self._sender: asyncio.Task[None] | None = None

    def push(self, frame: wire.Frame) -> None:
        """Send a frame as soon as the browser is ready for it, alone or merged with others."""
        merged = self._backlog.merged
        self._backlog.push(frame)
        self._counters.frames_merged += self._backlog.merged - merged
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
                await self._wake.wait()
                self._wake.clear()
                await self._send_backlog()
            await self._websocket.close(*self._closing)
        except (WebSocketDisconnect, RuntimeError):
            # Gone; a RuntimeError is how uvicorn refuses to send when it closed by itself.
            return

    async def _send_backlog(self) -> None:
        for frame in self._backlog.take():
            if self._closing is not None:
                return
            await self._websocket.send_bytes(frame.raw)
            self._counters.frames_sent += 1

    async def _listen(self, on_view: Callable[["Session"], None]) -> None:
        while True:
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            view = follow.chosen_view(message.get("bytes"))
            if view is not None and view != self.view:
                self.view = view
                on_view(self)
