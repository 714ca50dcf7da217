"""Handshakes of websockets that are none: the connection is ended, and the server ends well."""

import socket
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.served import Served

_UPGRADE = (
    "Host: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
)


@pytest.mark.parametrize(
    "handshake",
    [
        f"POST /viewer HTTP/1.1\r\n{_UPGRADE}\r\n",
        f"GET /viewer HTTP/1.1\r\n{_UPGRADE}Cookie: {'a=b; ' * 1800}\r\n\r\n",
    ],
    ids=["a method that websockets do not have", "a header that is too long"],
)
def test_a_connection_without_a_handshake_is_ended(handshake: str, tmp_path: Path) -> None:
    server = Served(tmp_path)
    parts = urlsplit(server.address)
    with socket.create_connection((parts.hostname, parts.port), timeout=5) as client:
        client.sendall(handshake.format(host=parts.netloc).encode())
        try:
            received = client.recv(1)
        except ConnectionError:
            received = b""
        code = server.end()
    assert (received, code) == (b"", 0)
