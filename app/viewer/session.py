"""One browser's connection: small buffers, a bounded queue of frames, and the view it follows.

All is drawn under one scene node. Translating that node by minus a robot's position, in one browser
only, keeps the robot centred there while the user can still orbit the camera.
"""

import asyncio
import socket
import sys
from asyncio import BaseTransport
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from hexapods.drawing.viser_internals import stream
from hexapods.runs.race_config import MAX_LANES

FREE, ELSEWHERE = "free", "elsewhere"
VIEWS = frozenset({FREE, ELSEWHERE, "leader", *map(str, range(1, MAX_LANES + 1))})
"""Valid views: the leader of the race, the robot on a lane from 1, none; or not the stage at all,
while the page plays a run by itself."""

_HIGH_WATER_BYTES = 16 * 1024
_UNSENT_BYTES = 16 * 1024
_SEND_BUFFER_BYTES = 512 * 1024
_NOT_SENT_LOW_AT = getattr(socket, "TCP_NOTSENT_LOWAT", 25) if sys.platform == "linux" else None
"""Number of the socket option TCP_NOTSENT_LOWAT, which Python names from 3.12 on."""
_MESSAGE_LIMIT_BYTES = 64 * 1024
_MAX_VIEW_BYTES = 64
"""Far smaller than the camera poses that every viser client sends, which need no decoding then."""


@dataclass(slots=True)
class Counters:
    """Counters of the hub since its creation."""

    viewers: int = 0
    """Number of viewers connected now."""
    frames_sent: int = 0
    frames_merged: int = 0
    """Frames coalesced into a later one because a viewer was too slow, summed over viewers."""
    resyncs: int = 0
    """Viewers that were made to reconnect because viser was restarted."""


CatchUp = Callable[["Session"], tuple[stream.Frame, int | None] | None]
"""Returns one frame with all changes since a session's version, and the new version; None while
there is nothing to show."""


class Session:
    """Sends frames to one accepted websocket as fast as it reads, and receives the view it chooses.

    Frames are queued in order, as many as come in a second: a lost packet stops a connection for a
    round trip or two, after which all of them go at once. If more arrive, the queue is dropped, and
    the browser gets their changes coalesced into one catch-up frame when it is ready, so that
    memory is bounded however slow it is. A browser that has been too slow has a short queue, so
    that it is not a second late all the time, until `STEADY_FRAMES` were sent without that.

    Args:
        websocket: accepted websocket.
        view: view that the browser has at first.
        counters: counters of the hub, updated here.
        catch_up: makes a catch-up frame.
    """

    MAX_QUEUED_FRAMES, MAX_QUEUED_IF_SLOW = 30, 4
    STEADY_FRAMES = 150

    def __init__(
        self, websocket: WebSocket, view: str, counters: Counters, catch_up: CatchUp
    ) -> None:
        self.view = view
        self.version: int | None = None
        """Version of the scene that the browser has or is being sent; None before the first."""
        self._websocket = websocket
        self._counters = counters
        self._catch_up = catch_up
        self._queue: deque[tuple[stream.Frame, int | None]] = deque()
        self._sent_since_slow = self.STEADY_FRAMES
        self._is_lagging = True
        self._wake = asyncio.Event()
        self._wake.set()
        self._close_args: tuple[int, str] | None = None
        self._sender: asyncio.Task[None] | None = None

    def push(self, frame: stream.Frame, version: int) -> None:
        """Queue a frame; if the queue is full, replace all of it by a later catch-up frame.

        Args:
            frame: the frame.
            version: version of the scene after it.
        """
        is_slow = self._sent_since_slow < self.STEADY_FRAMES
        most = self.MAX_QUEUED_IF_SLOW if is_slow else self.MAX_QUEUED_FRAMES
        if not self._is_lagging and len(self._queue) < most:
            self._queue.append((frame, version))
        else:
            if self.version is not None:
                self._counters.frames_merged += len(self._queue) + 1
                self._sent_since_slow = 0
            self._queue.clear()
            self._is_lagging = True
        self._wake.set()

    def forget(self) -> None:
        """Drop queued frames and the browser's version, as its page shows another thing."""
        self.version = None
        self._queue.clear()
        self._is_lagging = False

    def resume(self) -> None:
        """Send all changes since the browser's version, or the whole scene if it has none."""
        self._is_lagging = True
        self._wake.set()

    def wake(self) -> None:
        """Make the sender check again whether there is anything to send."""
        self._wake.set()

    def close(self, code: int, reason: str) -> None:
        """Close the websocket and drop queued frames. Browsers reconnect by themselves."""
        self._close_args = (code, reason)
        self._wake.set()

    async def closed(self, timeout_s: float) -> None:
        """Wait until the sender has ended; cancel it after the timeout [s]."""
        if self._sender is not None:
            await asyncio.wait([self._sender], timeout=timeout_s)
            self._sender.cancel()

    async def run(self, on_view: Callable[["Session"], None]) -> None:
        """Serve until either side closes.

        Args:
            on_view: Called after the browser has chosen another view.
        """
        self._sender = asyncio.create_task(self._send())
        receiver = asyncio.create_task(self._receive(on_view))
        tasks = (self._sender, receiver)
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            outcomes = await asyncio.gather(*tasks, return_exceptions=True)
        for outcome in outcomes:
            if isinstance(outcome, Exception):
                raise outcome

    async def _send(self) -> None:
        try:
            while self._close_args is None:
                queued = self._next()
                if queued is None:
                    self._wake.clear()
                    await self._wake.wait()
                    continue
                frame, self.version = queued
                await self._websocket.send_bytes(frame.raw)
                self._counters.frames_sent += 1
                self._sent_since_slow += 1
            await self._websocket.close(*self._close_args)
        except (WebSocketDisconnect, RuntimeError):
            # Disconnected; uvicorn raises RuntimeError for a send after it closed by itself.
            return

    def _next(self) -> tuple[stream.Frame, int | None] | None:
        if self._queue:
            return self._queue.popleft()
        if not self._is_lagging:
            return None
        frame = self._catch_up(self)
        self._is_lagging = frame is None
        return frame

    async def _receive(self, on_view: Callable[["Session"], None]) -> None:
        while True:
            message = await self._websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            view = decode_view(message.get("bytes"))
            if view is not None and view != self.view:
                self.view = view
                on_view(self)


class _FollowMessage(msgspec.Struct, forbid_unknown_fields=True):
    type: Literal["FollowMessage"]
    view: str


_view_decoder = msgspec.msgpack.Decoder(_FollowMessage)


def decode_view(data: bytes | None) -> str | None:
    """Decode a `{"type": "FollowMessage", "view": …}` message (msgpack) of a browser.

    The only message that the hub accepts: returns None for any other input.
    """
    if data is None or len(data) > _MAX_VIEW_BYTES:
        return None
    try:
        return valid_view(_view_decoder.decode(data).view)
    except msgspec.MsgspecError:
        return None


def valid_view(view: str | None) -> str | None:
    """Return the view if it is valid, else None."""
    return view if view in VIEWS else None


class ViewerProtocol(WebSocketsSansIOProtocol):
    """Websocket protocol that keeps little unsent, and aborts connections of stalled peers.

    With the system's buffers a viewer at 40 kB/s sees the race ten seconds late, and the lag grows;
    with these it is a little over a second late, because the hub coalesces waiting frames. What was
    sent and is not acknowledged yet is not in the way: at a round trip of 0.3 s and 5 % of packets
    lost it is over 16 kB, and a buffer of that size, for both, let 2 frames a second through.
    """

    def connection_made(self, transport: BaseTransport) -> None:
        """Set the size of the send buffers."""
        super().connection_made(transport)
        self.transport.set_write_buffer_limits(high=_HIGH_WATER_BYTES)
        sock = self.transport.get_extra_info("socket")
        if _NOT_SENT_LOW_AT is None:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _UNSENT_BYTES)
            return
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES)
        sock.setsockopt(socket.IPPROTO_TCP, _NOT_SENT_LOW_AT, _UNSENT_BYTES)

    def data_received(self, data: bytes) -> None:
        """Handle received data; close the connection after an invalid handshake.

        uvicorn leaves it open then, unanswered, and would wait for it when the server stops.
        """
        super().data_received(data)
        if self.conn.handshake_exc is not None and self.conn.eof_sent:
            self.transport.abort()

    def shutdown(self) -> None:
        """Close the connection without waiting for a peer that does not read."""
        super().shutdown()
        self._abort_if_blocked()

    def keepalive_timeout(self) -> None:
        """Close a connection without pongs, and do not wait for the peer to read."""
        super().keepalive_timeout()
        self._abort_if_blocked()

    def _abort_if_blocked(self) -> None:
        # close() waits until the buffer is flushed, which never happens if the peer does not read.
        if self.transport.get_write_buffer_size() > 0:
            self.transport.abort()


def websocket_options() -> dict[str, Any]:
    """Return the options of `uvicorn.Config` for viewers.

    No compression: viser's frames are compressed already, and a second time doubles the CPU load.
    Large messages are rejected, because browsers only send short ones.
    """
    return {
        "ws": ViewerProtocol,
        "ws_max_size": _MESSAGE_LIMIT_BYTES,
        "ws_per_message_deflate": False,
        "ws_ping_interval": 20.0,
        "ws_ping_timeout": 20.0,
    }
