"""Connections have a place in the table on any event loop, also where it accepts by itself."""

import socket
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress

import pytest
import uvicorn
from starlette.responses import PlainTextResponse

from app.limits.connections import ConnectionTable
from app.limits.http_protocol import limited_http
from app.limits.listener import Listener
from tests.timeouts import LONG_S, ProgressTimeout

LIMIT = 2
TEXT = b"here"
REQUEST = b"GET / HTTP/1.1\r\nHost: x\r\n\r\n"


@contextmanager
def served(table: ConnectionTable, listener: socket.socket) -> Iterator[tuple[str, int]]:
    """Serve one text on a free port; yield its address."""
    config = uvicorn.Config(
        PlainTextResponse(TEXT),
        http=limited_http(table),
        lifespan="off",
        ws="none",
        loop="asyncio",
        log_config=None,
    )
    server = uvicorn.Server(config)
    with closing(listener):
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        address = listener.getsockname()
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        try:
            yield address
        finally:
            server.should_exit = True
            thread.join()


def answered(address: tuple[str, int]) -> socket.socket:
    """Connect, and return the connection once it has an answer."""
    connection = socket.create_connection(address, LONG_S)
    ask(connection)
    return connection


def ask(connection: socket.socket) -> None:
    """Request the text, and receive all of it."""
    connection.sendall(REQUEST)
    received = b""
    while not received.endswith(TEXT):
        received += (more := connection.recv(1 << 16))
        assert more, "closed"


def until_open(table: ConnectionTable, count: int) -> None:
    timeout = ProgressTimeout()
    while len(table) != count:
        timeout.check(len(table))


@pytest.mark.parametrize("loop_accepts", [False, True], ids=["listener", "event loop"])
def test_the_longest_idle_makes_room_and_what_is_closed_counts_no_more(loop_accepts: bool) -> None:
    table = ConnectionTable(10, LIMIT)
    kind = (socket.AF_INET, socket.SOCK_STREAM, 0)
    listener = socket.socket(*kind) if loop_accepts else Listener(*kind, table)
    with served(table, listener) as address:
        first, second = answered(address), answered(address)
        third = answered(address)
        assert first.recv(1) == b""
        assert (len(table), table.evicted) == (LIMIT, 1)
        third.close()
        until_open(table, 1)
        with closing(answered(address)):
            ask(second)
        first.close()
        second.close()
        until_open(table, 0)


@pytest.mark.parametrize("loop_accepts", [False, True], ids=["listener", "event loop"])
def test_who_finds_no_place_is_disconnected(loop_accepts: bool) -> None:
    table = ConnectionTable(10, 0)
    kind = (socket.AF_INET, socket.SOCK_STREAM, 0)
    listener = socket.socket(*kind) if loop_accepts else Listener(*kind, table)
    with (
        served(table, listener) as address,
        closing(socket.create_connection(address, LONG_S)) as refused,
    ):
        with suppress(ConnectionResetError):
            assert refused.recv(1) == b""
        assert (len(table), table.refused) == (0, 1)
