"""uvicorn's websocket protocol for viewers: small buffers, so that the hub sees back-pressure."""

import socket
from asyncio import BaseTransport
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

_HIGH_WATER_BYTES = 8 * 1024
_SEND_BUFFER_BYTES = 16 * 1024
_MESSAGE_LIMIT_BYTES = 64 * 1024


class ViewerProtocol(WebSocketsSansIOProtocol):
    """Websocket protocol with small send buffers that aborts connections of stalled peers.

    With the system's buffers a viewer at 40 kB/s sees the race ten seconds late, and the lag grows;
    with these it is a little over a second late, because the hub coalesces waiting frames.
    """

    def connection_made(self, transport: BaseTransport) -> None:
        """Set the size of the send buffers."""
        super().connection_made(transport)
        self.transport.set_write_buffer_limits(high=_HIGH_WATER_BYTES)
        self.transport.get_extra_info("socket").setsockopt(
            socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES
        )

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
