"""The listening socket: counts what it accepts, and closes at once what there is no room for."""

import errno
import os
import socket
import sys
from typing import Any

from app.domain.errors import InvalidInput
from app.limits.connections import Connection, ConnectionTable
from app.settings import PREFIX, Settings

ACCEPTS_AT_ONCE = 64
"""In one round of the event loop; so many files may be open beyond the table's limit."""
WAITING = 2048
"""Connections that the system keeps until they are accepted."""
_REFUSALS_AT_ONCE = 256
_BUFFER_BYTES = 128 << 10
"""What the system may hold of a connection's data, each way, for a client that does not read."""
_NO_MORE_FILES = (errno.EMFILE, errno.ENFILE)


class AdmittedSocket(socket.socket):
    """An accepted socket, which is counted until it is closed."""

    connection: Connection | None = None

    def close(self) -> None:
        """Close it, and count it no more."""
        super().close()
        if self.connection is not None:
            self.connection.release()


class Listener(socket.socket):
    """Accepts connections as far as a table has room for them.

    asyncio's server calls `accept` as if it were any socket. What is refused here has cost one
    system call more than being accepted, and neither a transport nor a line in the log.

    Attributes:
        table: counts the connections.
    """

    def __init__(self, family: int, kind: int, protocol: int, table: ConnectionTable) -> None:
        """Listen to nothing yet.

        Args:
            family: as of `socket.socket`.
            kind: as of `socket.socket`.
            protocol: as of `socket.socket`.
            table: counts the connections.
        """
        super().__init__(family, kind, protocol)
        self.table = table
        # Given up for a moment where files have run out all the same.
        self._spare: int | None = _open_spare()

    def accept(self) -> tuple[socket.socket, Any]:
        """The next connection that there is room for.

        Raises:
            BlockingIOError: if none waits, or many were refused and others shall have a turn.
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
        """Close it, and its spare file."""
        super().close()
        self._close_spare()

    def _refuse_with_spare(self) -> bool:
        """Take the connection that waits with the spare file, only to close it.

        Otherwise it would wait on, and the event loop would be told so without an end.
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
    """Listen on the address in the settings.

    Raises:
        InvalidInput: if that cannot be.
    """
    try:
        found = socket.getaddrinfo(
            settings.host, settings.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
        family, kind, protocol, _, address = found[0]
        listener = Listener(family, kind, protocol, table)
    except OSError as error:
        raise InvalidInput(
            f"cannot find the address {settings.host} ({error.strerror}); choose one of this "
            f"machine's with --host or {PREFIX}HOST"
        ) from error
    try:
        if sys.platform != "win32":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Connections inherit them.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER_BYTES)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        listener.bind(address)
        listener.listen(WAITING)
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
        return os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return None
