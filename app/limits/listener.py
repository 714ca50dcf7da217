"""Listening socket that applies the connection limits at `accept`."""

import contextlib
import errno
import os
import socket
import sys
from typing import Any

from app.limits.connections import Connection, ConnectionTable
from app.setting_fields import PREFIX
from app.settings import Settings
from hexapods.domain.errors import InvalidInput

ACCEPTS_AT_ONCE = 64
"""Accepts per iteration of the event loop; evicted sockets are closed in the next iteration, so
this many files may be open beyond the table's limit."""
BACKLOG = 2048
"""Length of the system's queue of connections that were not accepted yet."""
_REFUSALS_AT_ONCE = 256
_BUFFER_BYTES = 128 << 10
"""Size of a connection's socket buffers, which bounds kernel memory for clients that stall."""
_NO_MORE_FILES = (errno.EMFILE, errno.ENFILE)


class AdmittedSocket(socket.socket):
    """An accepted socket that releases its slot in the connection table when it is closed."""

    connection: Connection | None = None

    def close(self) -> None:
        """Close the socket, and release its slot."""
        super().close()
        if self.connection is not None:
            self.connection.release()


class Listener(socket.socket):
    """Listening socket that accepts only connections admitted by a `ConnectionTable`.

    asyncio's server calls `accept` as on any socket, except on Windows, where the system accepts
    and `http_protocol` refuses. Refusing here costs one further system call, and neither a
    transport nor a log record.

    Attributes:
        table: table of the server's connections.
    """

    def __init__(self, family: int, kind: int, protocol: int, table: ConnectionTable) -> None:
        """Create an unbound socket.

        Args:
            family: as for `socket.socket`.
            kind: as for `socket.socket`.
            protocol: as for `socket.socket`.
            table: table of the server's connections.
        """
        super().__init__(family, kind, protocol)
        self.table = table
        # Spare file descriptor, closed for a moment to refuse connections when none is left.
        self._spare: int | None = _open_spare()

    def accept(self) -> tuple[socket.socket, Any]:
        """Accept the next connection that the table admits, closing those that it refuses.

        Raises:
            BlockingIOError: if none is queued, or after `_REFUSALS_AT_ONCE` refusals, to return
                to the event loop.
        """
        for _ in range(_REFUSALS_AT_ONCE):
            try:
                plain, address = super().accept()
            except OSError as error:
                if error.errno not in _NO_MORE_FILES or not self._refuse_with_spare():
                    raise
                continue
            accepted = AdmittedSocket(plain.family, plain.type, plain.proto, plain.detach())
            connection = self.table.admit(str(address[0]), accepted.fileno())
            if connection is not None:
                accepted.connection = connection
                return accepted, address
            accepted.close()
        raise BlockingIOError

    def close(self) -> None:
        """Close the socket and the spare file descriptor."""
        super().close()
        self._close_spare()

    def _refuse_with_spare(self) -> bool:
        """Accept the queued connection with the spare file descriptor, and close it at once.

        Otherwise it would stay queued, and the event loop would poll the listener as readable in
        a busy loop.
        """
        if self._spare is None:
            return False
        self._close_spare()
        try:
            refused, _ = super().accept()
            refused.close()
        finally:
            self._spare = _open_spare()
        self.table.refused += 1
        return True

    def _close_spare(self) -> None:
        spare, self._spare = self._spare, None
        if spare is not None:
            os.close(spare)


def listen(settings: Settings, table: ConnectionTable) -> Listener:
    """Create a socket that listens on the host and port in the settings.

    Raises:
        InvalidInput: if the host is unknown, or the port cannot be bound.
    """
    try:
        addresses = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
        family, kind, protocol, _, address = addresses[0]
        listener = Listener(family, kind, protocol, table)
    except OSError as error:
        raise InvalidInput(
            f"cannot find the address {settings.host} ({error.strerror}); choose one of this "
            f"machine's with --host or {PREFIX}HOST"
        ) from error
    try:
        if sys.platform != "win32":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Accepted connections inherit the buffer sizes and keep-alive.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER_BYTES)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        if sys.platform == "linux":
            with contextlib.suppress(OSError):  # not in every kernel
                # The usual ones halve their rate at each loss, as if it told of a full link; on a
                # poor network that has more losses than that.
                listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_CONGESTION, b"bbr")
        listener.bind(address)
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        why = error.strerror or str(error)
        if error.errno == errno.EADDRINUSE:
            why = "something else listens there"
        raise InvalidInput(
            f"cannot listen on {settings.host} port {settings.port} ({why}); choose another with "
            f"--port or {PREFIX}PORT, or 0 for any that is free"
        ) from error
    return listener


def _open_spare() -> int | None:
    try:
        return os.open(os.devnull, os.O_RDONLY)
    except OSError:
        return None
