"""Part of promise 28: one address cannot take all streams, and an operator always gets one.

Of the event streams, those of viewers among them, one address gets at most four fifths; a client
from another address is admitted even when all are taken, and so is an operator from the same.
"""

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from tests.event_streams import PATH, WITH_PICTURE
from tests.promises.length import at_length
from tests.served import Served, serving_from

pytestmark = pytest.mark.test

TOKEN = "only-the-operator-knows-this"
PLACES = at_length(10, 300)
SHARE = PLACES * 4 // 5


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving_from(tmp_path_factory.mktemp("data")) as make:
        yield make(HEXAPODS_TOKEN=TOKEN, HEXAPODS_MAX_VIEWERS=str(PLACES))


class Stream(socket.socket):
    """An event stream as a client receives it; `head` is that of the answer."""

    def __init__(self, server: Served, source: str, path: str, *, operator: bool = False) -> None:
        """Open a stream from one of this machine's loopback addresses."""
        super().__init__()
        self.bind((source, 0))
        self.settimeout(30)
        self.connect(("127.0.0.1", int(server.address.rpartition(":")[2])))
        bearer = f"Authorization: Bearer {TOKEN}\r\n" if operator else ""
        self.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n{bearer}\r\n".encode())
        self.head = b""
        while b"\r\n\r\n" not in self.head:
            self.head += self.recv(1 << 16)

    @property
    def status(self) -> int:
        """Status of the answer."""
        return int(self.head.split()[1])

    def wait_for_end(self) -> None:
        """Read until the server ends the stream."""
        received = self.head
        while not received.endswith(b"\r\n0\r\n\r\n"):
            chunk = self.recv(1 << 16)
            assert chunk, "cut off in the middle"
            received = received[-8:] + chunk


@pytest.mark.timeout(600)
@pytest.mark.parametrize("path", [PATH, WITH_PICTURE], ids=["events", "viewers"])
def test_one_address_cannot_take_all_streams(server: Served, path: str) -> None:
    with ExitStack() as stack:

        def opened(source: str, *, operator: bool = False) -> Stream:
            return stack.enter_context(Stream(server, source, path, operator=operator))

        of_address = [opened("127.0.0.2") for _ in range(SHARE)]
        assert {stream.status for stream in of_address} == {200}
        refused = opened("127.0.0.2")
        assert refused.status == 429
        assert b"retry-after: 10" in refused.head.lower()
        for _ in range(PLACES - SHARE):
            assert opened("127.0.0.3").status == 200
        # All places are taken now: who comes takes that of the newest of whoever has most.
        assert opened("127.0.0.4").status == 200
        of_address[-1].wait_for_end()
        assert opened("127.0.0.2", operator=True).status == 200
        of_address[-2].wait_for_end()
    # Closed connections free their places.
    with ExitStack() as stack:
        for _ in range(SHARE):
            assert opened("127.0.0.5").status == 200
        with server.client.stream("GET", path) as response:
            lines = response.iter_lines()
            data = next(line for line in lines if line.startswith("data: "))
            assert json.loads(data.removeprefix("data: "))["role"] == "spectator"
