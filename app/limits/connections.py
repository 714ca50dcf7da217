"""Connection limits: maximum of open connections in total and per address, and eviction.

A connection counts from `accept`, or from its first event where the event loop accepts by itself,
until its socket is closed.
At a limit, a connection of the address with the most connections is evicted: the one idle for
longest, or else the oldest with a request. So new addresses are admitted, and a flood of idle
connections evicts only its own.
"""

import select
import sys
import time
from collections import OrderedDict
from collections.abc import Callable
from contextvars import ContextVar
from typing import Protocol

from cachetools import TTLCache
from starlette.types import Scope

from app.limits.addresses import client_group

HEAD_S = 10.0
"""Timeout for a whole request head, from the moment the connection is ready for a request."""
BODY_S, BODY_BYTES_PER_S = 20.0, 500
"""Timeout for a request body, extended by a second for each `BODY_BYTES_PER_S` received."""
STALL_S, STALL_BYTES = 30.0, 32 << 10
"""A client must read at least this many bytes of a pending response in this time."""
OPERATOR_SLOTS = 16
"""Connections beyond both limits, for addresses from which an operator was authenticated."""
OPERATOR_S = 24 * 3600.0
"""Time for which an address counts as an operator's after an authentication."""
_MAX_OPERATOR_ADDRESSES = 1000
# Without these (Windows, macOS) a closed connection is noticed by the event loop alone.
_CLOSED_BY_CLIENT = getattr(select, "POLLRDHUP", 0)


class Peer(Protocol):
    """Interface of a connection's protocol, as needed to enforce its limits."""

    def overdue(self, now_s: float) -> bool:
        """Whether the client has exceeded a timeout."""

    def abort(self) -> None:
        """Close the connection at once, discarding unsent data."""


class Connection:
    """One open connection.

    Attributes:
        address: client group of its address (see `addresses`).
        file: file descriptor of its socket.
        is_operator: whether a request had a valid token or session; such connections are never
            evicted.
    """

    __slots__ = ("_busy", "_peer", "_table", "address", "file", "is_operator")

    def __init__(self, table: "ConnectionTable", address: str, file: int) -> None:
        self.address = address
        self.file = file
        self.is_operator = False
        self._table = table
        self._busy = False
        self._peer: Peer | None = None

    def attach(self, peer: Peer) -> None:
        """Set the protocol that can close the connection; before that it is not evicted."""
        self._peer = peer
        self._table._reclassify(self)

    def set_busy(self, busy: bool) -> None:
        """Set whether a request is in progress."""
        if busy != self._busy:
            self._busy = busy
            self._table._reclassify(self)

    def authenticated(self) -> None:
        """Mark the connection as an operator's, and its address for `OPERATOR_S`."""
        if not self.is_operator:
            self.is_operator = True
            self._table._reclassify(self)
        self._table._note_operator(self.address)

    def has_left(self) -> bool:
        """Whether its client has closed it. Callable from any thread.

        The system is asked, since the event loop may not know yet: it reads no more while a
        further request is in the buffer (pipelining).
        """
        if self not in self._table._open:
            return True
        if sys.platform == "win32" or not _CLOSED_BY_CLIENT:
            return False
        poll = select.poll()
        poll.register(self.file, _CLOSED_BY_CLIENT)
        return bool(poll.poll(0))

    def release(self) -> None:
        """Remove the connection from the table, after its socket was closed."""
        self._table._remove(self)


_of_request: ContextVar[Connection | None] = ContextVar("connection of the request", default=None)


def set_client(scope: Scope) -> Callable[[], bool]:
    """Make a request's client that of `client_has_left`, in this task and the threads it starts.

    Returns:
        whether the client has left; false if its connection is in no table.
    """
    connection: Connection | None = scope.get("state", {}).get("connection")
    _of_request.set(connection)
    return client_has_left if connection is None else connection.has_left


def client_has_left() -> bool:
    """Whether the client has left for which this thread or task works; false if there is none."""
    connection = _of_request.get()
    return connection is not None and connection.has_left()


class _Address:
    """Connections of one address; those that can be evicted in `idle` and `busy`, oldest first."""

    __slots__ = ("busy", "count", "idle")

    def __init__(self) -> None:
        self.count = 0
        self.idle: OrderedDict[Connection, None] = OrderedDict()
        self.busy: OrderedDict[Connection, None] = OrderedDict()


class ConnectionTable:
    """Table of a server's open connections. Not thread-safe: use on its event loop only.

    Attributes:
        limit: maximum of connections in total.
        limit_per_address: maximum of connections of one address.
        refused: connections refused so far.
        evicted: connections closed so far to admit others.
        timed_out: connections closed so far because of a timeout.
    """

    def __init__(
        self,
        limit: int,
        limit_per_address: int,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Create an empty table.

        Args:
            limit: maximum of connections in total.
            limit_per_address: maximum of connections of one address.
            now: monotonic clock [s].
        """
        self.limit, self.limit_per_address = limit, limit_per_address
        self.refused = self.evicted = self.timed_out = 0
        self._now = now
        self._open: dict[Connection, None] = {}
        self._files: dict[int, Connection] = {}
        self._addresses: dict[str, _Address] = {}
        self._operators: TTLCache[str, None, float] = TTLCache(
            _MAX_OPERATOR_ADDRESSES, OPERATOR_S, now
        )

    def __len__(self) -> int:
        return len(self._open)

    def of_file(self, file: int) -> Connection | None:
        """Return the connection with this file descriptor; None if it is not in the table."""
        return self._files.get(file)

    def admit(self, host: str, file: int) -> Connection | None:
        """Add an accepted connection, evicting others if needed; None if it must be refused.

        Args:
            host: address of its client.
            file: file descriptor of its socket.
        """
        address = client_group(host)
        same = self._addresses.get(address)
        count = 0 if same is None else same.count
        extra = OPERATOR_SLOTS if self._has_operator(address) else 0
        is_admitted = count < self.limit_per_address + extra or (
            same is not None and self._evict_from(same)
        )
        is_admitted = is_admitted and (
            len(self._open) < self.limit + extra or self._evict_for(count)
        )
        if not is_admitted:
            self.refused += 1
            return None
        connection = Connection(self, address, file)
        self._open[connection] = None
        self._files[file] = connection
        self._addresses.setdefault(address, _Address()).count += 1
        return connection

    def close_overdue(self) -> None:
        """Close the connections whose clients have exceeded a timeout; call once a second."""
        now_s = self._now()
        for connection in list(self._open):
            peer = connection._peer
            if peer is not None and peer.overdue(now_s):
                self.timed_out += 1
                peer.abort()

    def _evict_for(self, count: int) -> bool:
        """Evict from the address with the most connections, for an address that has `count`."""
        heaviest = max(
            self._addresses.values(), key=lambda address: address.count if address.idle else 0
        )
        if heaviest.idle and heaviest.count >= count:
            return self._evict_from(heaviest)
        heaviest = max(self._addresses.values(), key=lambda address: address.count)
        # Only if the newcomer still has fewer afterwards; else the two would evict each other.
        return heaviest.count > count + 1 and self._evict_from(heaviest)

    def _evict_from(self, address: _Address) -> bool:
        victim = next(iter(address.idle), None) or next(iter(address.busy), None)
        if victim is None or victim._peer is None:
            return False
        self.evicted += 1
        victim._peer.abort()
        # Removed now, since its socket is closed only in the next iteration of the event loop.
        self._remove(victim)
        return True

    def _reclassify(self, connection: Connection) -> None:
        address = self._addresses.get(connection.address)
        if address is None or connection not in self._open:
            return
        address.idle.pop(connection, None)
        address.busy.pop(connection, None)
        if connection._peer is not None and not connection.is_operator:
            (address.busy if connection._busy else address.idle)[connection] = None

    def _remove(self, connection: Connection) -> None:
        if connection not in self._open:
            return
        del self._open[connection]
        del self._files[connection.file]
        address = self._addresses[connection.address]
        address.idle.pop(connection, None)
        address.busy.pop(connection, None)
        address.count -= 1
        if address.count == 0:
            del self._addresses[connection.address]

    def _note_operator(self, address: str) -> None:
        self._operators[address] = None

    def _has_operator(self, address: str) -> bool:
        return address in self._operators
