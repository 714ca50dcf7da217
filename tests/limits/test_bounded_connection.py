"""The parser of heads and framings: what h11 would parse at any length is refused at a length."""

import h11
import pytest

from app.limits.bounded_connection import (
    CHUNK_BYTES,
    MAX_HEAD_BYTES,
    MAX_HEAD_LINES,
    MAX_SMALL_CHUNKS,
    BoundedConnection,
)

FIRST = b"GET / HTTP/1.1\r\nHost: a\r\n"
CHUNKED = b"POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"


def events(connection: BoundedConnection) -> list[object]:
    """Return the events until more data is needed, without that."""
    read: list[object] = []
    while not isinstance(event := connection.next_event(), type):
        read.append(event)
    return read


def refusal(*pieces: bytes) -> int:
    """Return the status that a request is refused with, which comes in pieces."""
    connection = BoundedConnection()
    *first, last = pieces
    for piece in first:
        connection.receive_data(piece)
        assert events(connection) == []
    connection.receive_data(last)
    with pytest.raises(h11.RemoteProtocolError) as refused:
        events(connection)
    assert connection.refusal is refused.value
    return refused.value.error_status_hint


def test_a_head_in_one_piece_is_as_long_as_one_that_trickles() -> None:
    rest = MAX_HEAD_BYTES - len(FIRST) - len(b"a:\r\n\r\n")
    connection = BoundedConnection()
    connection.receive_data(FIRST + b"a:" + b"b" * rest + b"\r\n\r\n")
    request, end = events(connection)
    assert isinstance(request, h11.Request)
    assert isinstance(end, h11.EndOfMessage)
    longer = b"a:" + b"b" * (rest + 1) + b"\r\n\r\n"
    assert refusal(FIRST + longer) == 431
    assert refusal(FIRST, longer[: MAX_HEAD_BYTES // 2], longer[MAX_HEAD_BYTES // 2 :]) == 431


def test_a_head_has_few_lines() -> None:
    least = 3  # the request line, that of the host and the empty one
    connection = BoundedConnection()
    connection.receive_data(FIRST + b"a:b\r\n" * (MAX_HEAD_LINES - least) + b"\r\n")
    assert len(events(connection)) == 2
    assert refusal(FIRST + b"a:b\r\n" * (MAX_HEAD_LINES - least + 1) + b"\r\n") == 431


def test_a_request_behind_another_is_bounded_too() -> None:
    connection = BoundedConnection()
    connection.receive_data(FIRST + b"\r\n" + FIRST + b"a:b\r\n" * MAX_HEAD_LINES + b"\r\n")
    assert len(events(connection)) == 2
    connection.send(h11.Response(status_code=204, headers=[]))
    connection.send(h11.EndOfMessage())
    connection.start_next_cycle()
    with pytest.raises(h11.RemoteProtocolError):
        connection.next_event()


def test_a_body_has_few_small_chunks_and_any_number_of_large_ones() -> None:
    connection = BoundedConnection()
    large = f"{CHUNK_BYTES:x}\r\n".encode() + b"x" * CHUNK_BYTES + b"\r\n"
    connection.receive_data(CHUNKED + b"1\r\nx\r\n" * MAX_SMALL_CHUNKS)
    assert len(events(connection)) == 1 + MAX_SMALL_CHUNKS
    for _ in range(2 * MAX_SMALL_CHUNKS):
        connection.receive_data(large)
        assert len(events(connection)) == 1
    assert refusal(CHUNKED + b"1\r\nx\r\n" * (MAX_SMALL_CHUNKS + 1)) == 400
