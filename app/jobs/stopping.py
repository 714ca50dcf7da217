"""Ends long work of requests in threads, when the server stops or the client has left."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from app.limits.connections import client_has_left
from app.storage.errors import Busy

_LOOK_EVERY_S = 0.1


class ClientLeft(Busy):
    """The client of a request has closed its connection, so there is nobody to answer."""

    def __init__(self) -> None:
        super().__init__("the client has closed its connection", 1)


class Stopping:
    """Flag of a server that is stopping. Thread-safe."""

    def __init__(self) -> None:
        """Create a cleared flag, as of a running server."""
        self._is_set = threading.Event()

    def set(self) -> None:
        """Mark the server as stopping: every `check` raises from now on."""
        self._is_set.set()

    def check(self) -> None:
        """Raise if the present request needs no answer; call it between the parts of long work.

        Raises:
            Busy: if the server stops.
            ClientLeft: if the client of the request has left.
        """
        if self._is_set.is_set():
            raise Busy("the server is stopping; try again later", 1)
        if client_has_left():
            raise ClientLeft

    @contextmanager
    def holding(self, lock: threading.Lock) -> Iterator[None]:
        """Hold a lock, for which a request waits only as long as it needs an answer.

        Raises:
            Busy, ClientLeft: see `check`.
        """
        while not lock.acquire(timeout=_LOOK_EVERY_S):
            self.check()
        try:
            self.check()
            yield
        finally:
            lock.release()
