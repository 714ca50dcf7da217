"""HTTP/1.1 protocol of uvicorn (h11) with timeouts against slow clients ("slowloris")."""

import time
from asyncio import AbstractEventLoop, Transport
from http import HTTPStatus
from typing import Any

import h11
from uvicorn.config import Config
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

from app.limits.bounded_connection import READ_BYTES, BoundedConnection
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
"""Keep-alive timeout of a connection without a request."""


class LimitedHttpProtocol(H11Protocol):
    """Protocol of one connection, with timeouts for head, body and response.

    Requests find their `Connection` in the state of their ASGI scope as `connection`. Timeouts are
    checked by `ConnectionTable.close_overdue`, once a second for all connections, rather than by a
    timer per connection.
    """

    table: ConnectionTable
    """Set by a subclass for each server: see `limited_http`."""

    def __init__(
        self,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        _loop: AbstractEventLoop | None = None,
    ) -> None:
        """Create the protocol as uvicorn does, with a parser that bounds the cost of a head."""
        super().__init__(config, server_state, app_state, _loop)
        self.conn: BoundedConnection = BoundedConnection()

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override] # as uvicorn
        """Attach this protocol to its connection in the table; close it if it has no place there.

        The listener has admitted it already, where the event loop calls its `accept`: the loop of
        Windows does not.
        """
        super().connection_made(transport)
        # An attribute of the transports of asyncio's loops that select; others read more at once.
        transport.max_size = READ_BYTES  # type: ignore[attr-defined]
        file = transport.get_extra_info("socket").fileno()
        self._connection: Connection | None = self.table.of_file(file)
        if self._connection is None and not transport.is_closing():
            # Without a peer's address the client has left already.
            peer = transport.get_extra_info("peername")
            self._connection = peer and self.table.admit(str(peer[0]), file)
        self._since_s = time.monotonic()
        """When the server started to wait for the head or the body of a request."""
        self._body_bytes = 0
        self._stalled: tuple[float, int] | None = None
        """Start of the present stall, and the maximum of unsent bytes since; None if none."""
        if self._connection is None:
            transport.abort()
            return
        self._connection.attach(self)
        self.app_state = {**self.app_state, "connection": self._connection}

    def connection_lost(self, exc: Exception | None) -> None:
        """Give the connection's place in the table free: its socket is closed next."""
        super().connection_lost(exc)
        if self._connection is not None:
            self._connection.release()

    def data_received(self, data: bytes) -> None:
        """Process received data, and count the bytes of a body."""
        if self._is_answering():
            self._body_bytes += len(data)
        super().data_received(data)

    def handle_events(self) -> None:
        """Process parsed events; when a request begins, mark the connection as busy."""
        was_answering = self._is_answering()
        super().handle_events()
        if not was_answering and self._is_answering():
            self._since_s, self._body_bytes = time.monotonic(), 0
            self._set_busy(True)

    def send_400_response(self, msg: str) -> None:
        """Refuse a request that cannot be parsed, with the reason, and close the connection.

        A response that has begun is cut off.
        """
        if self.conn.our_state not in (h11.IDLE, h11.SEND_RESPONSE):
            self.transport.abort()
            return
        refusal = self.conn.refusal
        status = HTTPStatus(400 if refusal is None else refusal.error_status_hint)
        detail = msg if status == HTTPStatus.BAD_REQUEST else str(refusal)
        headers = [("Content-Type", "text/plain; charset=utf-8"), ("Connection", "close")]
        head = h11.Response(status_code=status, headers=headers, reason=status.phrase)
        for event in (head, h11.Data(data=detail.encode()), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        self.transport.close()

    def on_response_complete(self) -> None:
        """Mark the connection as idle, and start the timeout for the next request's head."""
        self._since_s, self._body_bytes = time.monotonic(), 0
        self._set_busy(False)
        super().on_response_complete()

    def resume_writing(self) -> None:
        """Continue sending after back-pressure: the client has read most of the buffer."""
        self._stalled = None
        super().resume_writing()

    def overdue(self, now_s: float) -> bool:
        """Whether the client has exceeded a timeout."""
        if self._is_stalled(now_s):
            return True
        if self.transport.is_closing():
            return False
        if not self._is_answering():
            return now_s - self._since_s > HEAD_S
        if not self.cycle.more_body or self.flow.read_paused:
            # The request is complete, or reading is paused by the server's own back-pressure.
            return False
        return now_s - self._since_s > BODY_S + self._body_bytes / BODY_BYTES_PER_S

    def abort(self) -> None:
        """Close the connection at once, discarding unsent data."""
        self.transport.abort()

    def _should_upgrade(self) -> bool:
        """Ignore `Upgrade`, as HTTP allows; uvicorn would log each request that has it."""
        return False

    def _is_stalled(self, now_s: float) -> bool:
        unsent = self.transport.get_write_buffer_size()
        if unsent == 0:
            self._stalled = None
        elif self._stalled is None or self._stalled[1] - unsent >= STALL_BYTES:
            self._stalled = (now_s, unsent)
        else:
            self._stalled = (self._stalled[0], max(self._stalled[1], unsent))
        return self._stalled is not None and now_s - self._stalled[0] > STALL_S

    def _is_answering(self) -> bool:
        # `cycle` is None before the first request, although uvicorn's type says otherwise.
        return bool(self.cycle) and not self.cycle.response_complete

    def _set_busy(self, busy: bool) -> None:
        if self._connection is not None:
            self._connection.set_busy(busy)


def limited_http(table: ConnectionTable) -> type[LimitedHttpProtocol]:
    """Create the protocol class of one server, for the `http` argument of `uvicorn.Config`.

    Args:
        table: table of the server's connections.
    """

    class _BoundHttpProtocol(LimitedHttpProtocol):
        pass

    _BoundHttpProtocol.table = table
    return _BoundHttpProtocol
