"""HTTP/1.1 by uvicorn, with limits to how long a client may keep the server waiting."""

import time
from asyncio import Transport

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from app.limits.connections import (
    BODY_BYTES_PER_S,
    BODY_S,
    HEAD_S,
    STALL_BYTES,
    STALL_S,
    Connection,
    ConnectionTable,
)

KEEP_ALIVE_S = 5
"""How long a connection without a request is kept."""


class LimitedHttpProtocol(H11Protocol):
    """One connection. Its requests find it in their scope's state as `connection`.

    What is overdue is found by `ConnectionTable.close_overdue`, once a second for all connections,
    rather than by timers of each.
    """

    table: ConnectionTable
    """Set by a subclass for each server: see `limited_http`."""

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override] # as uvicorn
        """Find the connection in the table, and be what it can be closed by."""
        super().connection_made(transport)
        file = transport.get_extra_info("socket").fileno()
        self._connection: Connection | None = self.table.of_file(file)
        self._upgraded = False
        self._since_s = time.monotonic()
        """When the server began to wait for the head or the body of a request."""
        self._body_bytes = 0
        self._stalled: tuple[float, int] | None = None
        """Since when the client has read too little, and the most left to send since [bytes]."""
        # Closed before it was begun, to make room for others.
        if self._connection is None:
            transport.abort()
            return
        self._connection.attach(self)
        self.app_state = {**self.app_state, "connection": self._connection}

    def data_received(self, data: bytes) -> None:
        """Take in what the client sends, and count what is of a body."""
        if self._is_answering():
            self._body_bytes += len(data)
        super().data_received(data)

    def handle_events(self) -> None:
        """Begin requests, and note that there is one."""
        was_answering = self._is_answering()
        super().handle_events()
        if not was_answering and self._is_answering():
            self._since_s, self._body_bytes = time.monotonic(), 0
            self._set_busy(True)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Leave the connection to the websocket's protocol, which has limits of its own."""
        self._upgraded = True
        self._set_busy(True)
        super().handle_websocket_upgrade(event)

    def on_response_complete(self) -> None:
        """Wait for the next request, from now on."""
        self._since_s, self._body_bytes = time.monotonic(), 0
        self._set_busy(False)
        super().on_response_complete()

    def resume_writing(self) -> None:
        """Go on: the client has read most of what waited for it."""
        self._stalled = None
        super().resume_writing()

    def overdue(self, now_s: float) -> bool:
        """Whether the client keeps the server waiting for longer than it may."""
        if self._reads_too_little(now_s):
            return True
        if self._upgraded or self.transport.is_closing():
            return False
        if not self._is_answering():
            return now_s - self._since_s > HEAD_S
        if not self.cycle.more_body or self.flow.read_paused:
            # The whole request is here, or it is the server that is not ready for more.
            return False
        return now_s - self._since_s > BODY_S + self._body_bytes / BODY_BYTES_PER_S

    def abort(self) -> None:
        """Close the connection at once, with whatever it still had to send."""
        self.transport.abort()

    def _reads_too_little(self, now_s: float) -> bool:
        left = self.transport.get_write_buffer_size()
        if left == 0:
            self._stalled = None
        elif self._stalled is None or self._stalled[1] - left >= STALL_BYTES:
            self._stalled = (now_s, left)
        else:
            self._stalled = (self._stalled[0], max(self._stalled[1], left))
        return self._stalled is not None and now_s - self._stalled[0] > STALL_S

    def _is_answering(self) -> bool:
        # uvicorn declares it as never None, which it is before the first request.
        return bool(self.cycle) and not self.cycle.response_complete

    def _set_busy(self, busy: bool) -> None:
        if self._connection is not None:
            self._connection.set_busy(busy)


def limited_http(table: ConnectionTable) -> type[LimitedHttpProtocol]:
    """The protocol for the connections in a table, as `uvicorn.Config` takes it.

    Args:
        table: of the connections of one server.
    """

    class _OfOneServer(LimitedHttpProtocol):
        pass

    _OfOneServer.table = table
    return _OfOneServer
