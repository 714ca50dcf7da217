"""Part of promise 28: one address cannot take all connections, and an operator always gets one.

Of the viewer connections, and of the event streams, one address gets at most four fifths; a client
from another address is admitted even when all are taken, and so is an operator from the same.
"""

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from websockets.exceptions import ConnectionClosed

from tests.promises.length import at_length
from tests.served import Served, serving_from
from tests.viewer.serving import Viewer

pytestmark = pytest.mark.test

TOKEN = "only-the-operator-knows-this"
PLACES = at_length(10, 300)
SHARE = PLACES * 4 // 5


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving_from(tmp_path_factory.mktemp("data")) as make:
        yield make(HEXAPODS_TOKEN=TOKEN, HEXAPODS_MAX_VIEWERS=str(PLACES))


def open_viewer(server: Served, stack: ExitStack, source: str, *, operator: bool = False) -> Viewer:
    """Connect a viewer from one of this machine's loopback addresses."""
    port = int(server.address.rpartition(":")[2])
    headers = {"Authorization": f"Bearer {TOKEN}"} if operator else {}
    sock = socket.create_connection(("127.0.0.1", port), source_address=(source, 0))
    viewer = Viewer(f"ws://127.0.0.1:{port}/viewer/", sock=sock, additional_headers=headers)
    return stack.enter_context(viewer)


def refusal(viewer: Viewer) -> tuple[int, str]:
    with pytest.raises(ConnectionClosed) as closed:
        viewer.frames_until(lambda _: False)
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code, closed.value.rcvd.reason


@pytest.mark.timeout(600)
def test_one_address_cannot_take_all_viewer_places(server: Served) -> None:
    with ExitStack() as stack:
        viewers = [open_viewer(server, stack, "127.0.0.2") for _ in range(SHARE)]
        viewers[-1].frame()
        assert refusal(open_viewer(server, stack, "127.0.0.2")) == (1013, "address full")
        neighbours = [open_viewer(server, stack, "127.0.0.3") for _ in range(PLACES - SHARE)]
        neighbours[-1].frame()
        # All places are taken now.
        assert open_viewer(server, stack, "127.0.0.4").frame().raw
        assert refusal(viewers[-1]) == (1013, "place taken")
        assert open_viewer(server, stack, "127.0.0.2", operator=True).frame().raw
        assert refusal(viewers[-2]) == (1013, "place taken")


def open_event_stream(
    server: Served, stack: ExitStack, source: str, *, operator: bool = False
) -> bytes:
    """Open an event stream, and return the head of the answer."""
    port = int(server.address.rpartition(":")[2])
    sock = socket.create_connection(("127.0.0.1", port), source_address=(source, 0), timeout=30)
    stack.enter_context(sock)
    bearer = f"Authorization: Bearer {TOKEN}\r\n" if operator else ""
    sock.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: 127.0.0.1\r\n{bearer}\r\n".encode())
    answer = b""
    while b"\r\n\r\n" not in answer:
        answer += sock.recv(1 << 16)
    return answer


@pytest.mark.timeout(600)
def test_one_address_cannot_take_all_event_streams(server: Served) -> None:
    with ExitStack() as stack:
        for _ in range(SHARE):
            assert open_event_stream(server, stack, "127.0.0.2").startswith(b"HTTP/1.1 200")
        refused = open_event_stream(server, stack, "127.0.0.2")
        assert refused.startswith(b"HTTP/1.1 429")
        assert b"retry-after: 10" in refused.lower()
        for _ in range(PLACES - SHARE):
            assert open_event_stream(server, stack, "127.0.0.3").startswith(b"HTTP/1.1 200")
        assert open_event_stream(server, stack, "127.0.0.4").startswith(b"HTTP/1.1 200")
        assert open_event_stream(server, stack, "127.0.0.2", operator=True).startswith(
            b"HTTP/1.1 200"
        )
    # Closed connections free their places.
    with ExitStack() as stack:
        for _ in range(SHARE):
            assert open_event_stream(server, stack, "127.0.0.5").startswith(b"HTTP/1.1 200")
        with server.client.stream("GET", "/api/v1/events") as stream:
            lines = stream.iter_lines()
            data = next(line for line in lines if line.startswith("data: "))
            assert json.loads(data.removeprefix("data: "))["role"] == "spectator"
