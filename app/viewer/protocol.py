"""How uvicorn speaks to viewers: slow ones wait in the hub, not in buffers on the way to them."""

import socket
from asyncio import BaseTransport
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

_HIGH_WATER_BYTES = 8 * 1024
_SEND_BUFFER_BYTES = 16 * 1024
_MESSAGE_LIMIT_BYTES = 64 * 1024


class ViewerProtocol(WebSocketsSansIOProtocol):
    """Small buffers, so that a slow viewer sees what is, and stalled ones are let go.

    With the system's buffers a viewer at 40 kB/s sees the race ten seconds late, and later each
    second; with these it is a little over a second behind, because the hub merges what waits.
    """

    def connection_made(self, transport: BaseTransport) -> None:
        """Make the buffers small."""
        super().connection_made(transport)
        self.transport.set_write_buffer_limits(high=_HIGH_WATER_BYTES)
        self.transport.get_extra_info("socket").setsockopt(
            socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES
        )

    def shutdown(self) -> None:
        """Close, without waiting for someone who does not read."""
        super().shutdown()
        self._let_go()

    def keepalive_timeout(self) -> None:
        """Close a connection that answers no pings, without waiting for it to read."""
        super().keepalive_timeout()
        self._let_go()

    def _let_go(self) -> None:
        # close() waits until all is written, which never comes for a peer that does not read.
        if self.transport.get_write_buffer_size() > 0:
            self.transport.abort()


def websocket_options() -> dict[str, Any]:
    """What `uvicorn.Config` needs for viewers.

    No compression: viser's frames are compressed already, and doing it again doubles the CPU.
    Nothing large is accepted, because nothing large is listened to.
    """
    return {
        "ws": ViewerProtocol,
        "ws_max_size": _MESSAGE_LIMIT_BYTES,
        "ws_per_message_deflate": False,
        "ws_ping_interval": 20.0,
        "ws_ping_timeout": 20.0,
    }
