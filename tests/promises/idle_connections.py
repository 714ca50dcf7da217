"""Load generator of idle and slow connections.

Usage: `python -m tests.promises.idle_connections PORT COUNT ADDRESSES PATH…`. Opens connections and
keeps them open, each of one of these kinds in turn: one that sends nothing, one that sends a header
byte by byte (slowloris), one that does so with a body, and one that sends a request and does not
read the answer. Connections that the server closes are opened again at a limited rate. Prints a
line of JSON once all were tried, and another when standard input ends, and exits.
"""

import json
import resource
import select
import selectors
import socket
import sys
import time
from collections.abc import Sequence

REOPENED_PER_S = 50
TRICKLE_S = 2.0
_RECEIVE_BYTES = 2048
_KINDS = 4


class IdleConnection:
    """An anonymous connection that stays idle, and can be reopened."""

    def __init__(self, number: int, port: int, address: str, paths: Sequence[str]) -> None:
        self.kind = number % _KINDS
        self._port, self._address = port, address
        self._path = paths[number // _KINDS % len(paths)]
        self.sock: socket.socket | None = None

    def open(self) -> None:
        """Connect, and send the first bytes of this kind."""
        self.sock = sock = socket.socket()
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BYTES)
        sock.settimeout(5)
        try:
            sock.bind((self._address, 0))
            sock.connect(("127.0.0.1", self._port))
            sock.send(self._initial_bytes())
            sock.setblocking(False)
        except OSError:
            self.close()

    def trickle(self) -> None:
        """Send one more byte, if this kind does."""
        if self.sock is None or self.kind not in (1, 2):
            return
        try:
            self.sock.send(b"x")
        except BlockingIOError:
            pass
        except OSError:
            self.close()

    def close(self) -> None:
        """Close the connection; it can be reopened."""
        sock, self.sock = self.sock, None
        if sock is not None:
            sock.close()

    def _initial_bytes(self) -> bytes:
        host = f"Host: 127.0.0.1:{self._port}\r\n"
        return (
            b"",
            f"GET / HTTP/1.1\r\n{host}X-Slow: ".encode(),
            f"GET / HTTP/1.1\r\n{host}Content-Length: 1000000\r\n\r\n".encode(),
            f"GET {self._path} HTTP/1.1\r\n{host}\r\n".encode(),
        )[self.kind]


def main(port: int, count: int, addresses: int, paths: Sequence[str]) -> None:
    """Keep connections open from 127.0.0.1, 127.0.0.2 … until standard input ends."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    connections = [
        IdleConnection(number, port, f"127.0.0.{1 + number % addresses}", paths)
        for number in range(count)
    ]
    for connection in connections:
        connection.open()
    _emit(open=sum(connection.sock is not None for connection in connections))
    came_back = 0
    while not select.select([sys.stdin], [], [], 1.0)[0]:
        _close_lost(connections)
        away = [connection for connection in connections if connection.sock is None]
        for connection in away[:REOPENED_PER_S]:
            connection.open()
            came_back += connection.sock is not None
        if int(time.monotonic()) % int(TRICKLE_S) == 0:
            for connection in connections:
                connection.trickle()
    _emit(open=sum(connection.sock is not None for connection in connections), came_back=came_back)


def _emit(**figures: int) -> None:
    sys.stdout.write(json.dumps(figures) + "\n")
    sys.stdout.flush()


def _close_lost(connections: Sequence[IdleConnection]) -> None:
    """Close the connections that the server has closed, detected without reading (MSG_PEEK)."""
    with selectors.DefaultSelector() as selector:
        for candidate in connections:
            if candidate.sock is not None:
                selector.register(candidate.sock, selectors.EVENT_READ, candidate)
        ready = selector.select(0) if selector.get_map() else []
    for key, _ in ready:
        connection: IdleConnection = key.data
        try:
            is_lost = key.fileobj.recv(1, socket.MSG_PEEK) == b""  # type: ignore[union-attr]
        except BlockingIOError:
            continue
        except OSError:
            is_lost = True
        if is_lost:
            connection.close()


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])
