"""Connection limits: how many may be open in all and by address, and how long each may stall.

A connection is counted from `accept` until its socket is closed, whatever protocol it speaks by
then. When there is no room, the address with the most connections loses one: the one that has been
idle for longest, or else its oldest one with a request. So an address that comes anew gets in, and
a crowd of silent connections only ever drives out its own kind.
"""

import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Protocol

from app.limits.addresses import client_group

HEAD_S = 10.0
"""For the whole head of a request, from the moment the server could take one."""
BODY_S, BODY_BYTES_PER_S = 20.0, 500
"""For a body: this long, and longer by a second for each so many bytes that came."""
STALL_S, STALL_BYTES = 30.0, 32 << 10
"""A client that has an answer to read must take so many bytes of it in so much time."""
OPERATOR_SLOTS = 16
"""Connections beyond both caps, for addresses that an operator came from."""
OPERATOR_S = 24 * 3600.0
_MAX_OPERATOR_ADDRESSES = 1000


class Peer(Protocol):
    """The protocol of a connection, as far as its limits are concerned."""

    def overdue(self, now_s: float) -> bool:
        """Whether the client keeps the server waiting for longer than it may."""

    def abort(self) -> None:
        """Close the connection at once, with whatever it still had to send."""


class Connection:
    """One open connection.

    Attributes:
        address: of the client; for IPv6 its network.
        file: descriptor of its socket.
        is_operator: a request of it had a valid token or session; never closed to make room.
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
        """Say by what it can be closed; before that it is not closed to make room."""
        self._peer = peer
        self._table._place(self)

    def set_busy(self, busy: bool) -> None:
        """Say whether a request is being answered, or none is there."""
        if busy != self._busy:
            self._busy = busy
            self._table._place(self)

    def authenticated(self) -> None:
        """Take note that an operator is at the other end."""
        if not self.is_operator:
            self.is_operator = True
            self._table._place(self)
        self._table._note_operator(self.address)

    def release(self) -> None:
        """Count it no more: its socket is closed."""
        self._table._remove(self)


class _Address:
    """The connections of one address: `idle` and `busy` with the oldest first."""

    __slots__ = ("busy", "count", "idle")

    def __init__(self) -> None:
        self.count = 0
        self.idle: OrderedDict[Connection, None] = OrderedDict()
        self.busy: OrderedDict[Connection, None] = OrderedDict()


class ConnectionTable:
    """All open connections of a server. To be used on its event loop only.

    Attributes:
        limit: of connections in all.
        limit_per_address: of connections of one address.
        refused: how many were not let in.
        evicted: how many were closed to make room.
        timed_out: how many were closed because the client kept the server waiting.
    """

    def __init__(
        self,
        limit: int,
        limit_per_address: int,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Nothing is open yet.

        Args:
            limit: of connections in all.
            limit_per_address: of connections of one address.
            now: the clock, in seconds.
        """
        self.limit, self.limit_per_address = limit, limit_per_address
        self.refused = self.evicted = self.timed_out = 0
        self._now = now
        self._open: dict[Connection, None] = {}
        self._files: dict[int, Connection] = {}
        self._addresses: dict[str, _Address] = {}
        self._operators: OrderedDict[str, float] = OrderedDict()

    def __len__(self) -> int:
        return len(self._open)

    def of_file(self, file: int) -> Connection | None:
        """The connection with this descriptor; None if it is not counted (any more)."""
        return self._files.get(file)

    def admit(self, host: str, file: int) -> Connection | None:
        """Count a connection that was just accepted; None if there is no room for it.

        Args:
            host: its client's address.
            file: descriptor of its socket.
        """
        address = client_group(host)
        mine = self._addresses.get(address)
        count = 0 if mine is None else mine.count
        extra = OPERATOR_SLOTS if self._has_operator(address) else 0
        is_room = count < self.limit_per_address + extra or (
            mine is not None and self._evict_from(mine)
        )
        is_room = is_room and (len(self._open) < self.limit + extra or self._make_room(count))
        if not is_room:
            self.refused += 1
            return None
        connection = Connection(self, address, file)
        self._open[connection] = None
        self._files[file] = connection
        self._addresses.setdefault(address, _Address()).count += 1
        return connection

    def close_overdue(self) -> None:
        """Close the connections whose clients keep the server waiting for too long."""
        now_s = self._now()
        for connection in list(self._open):
            peer = connection._peer
            if peer is not None and peer.overdue(now_s):
                self.timed_out += 1
                peer.abort()

    def _make_room(self, count: int) -> bool:
        """Close one connection of the heaviest address, for one of an address with so many."""
        heaviest = max(self._addresses.values(), key=lambda one: one.count if one.idle else 0)
        if heaviest.idle and heaviest.count >= count:
            return self._evict_from(heaviest)
        heaviest = max(self._addresses.values(), key=lambda one: one.count)
        # Not where the newcomer would have as many then: they would only take turns.
        return heaviest.count > count + 1 and self._evict_from(heaviest)

    def _evict_from(self, address: _Address) -> bool:
        victim = next(iter(address.idle), None) or next(iter(address.busy), None)
        if victim is None or victim._peer is None:
            return False
        self.evicted += 1
        victim._peer.abort()
        # Its socket is closed a moment later, when the event loop comes to it.
        self._remove(victim)
        return True

    def _place(self, connection: Connection) -> None:
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
        self._operators[address] = self._now()
        self._operators.move_to_end(address)
        if len(self._operators) > _MAX_OPERATOR_ADDRESSES:
            self._operators.popitem(last=False)

    def _has_operator(self, address: str) -> bool:
        return self._now() - self._operators.get(address, -OPERATOR_S) < OPERATOR_S
