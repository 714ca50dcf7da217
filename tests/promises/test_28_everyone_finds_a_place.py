"""Part of promise 28: one address cannot take all places, and an operator always gets one.

Of the places before the stage, and of those for streams of events, one address gets four fifths;
who comes from another gets in even when all are taken, and so does an operator from the same.
"""

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from tests.promises.length import at_length
from tests.served import Served, serving_from
from tests.viewer.serving import Viewer

TOKEN = "only-the-operator-knows-this"
PLACES = at_length(10, 300)
SHARE = PLACES * 4 // 5


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Served]:
    with serving_from(tmp_path) as make:
        yield make(HEXAPODS_TOKEN=TOKEN, HEXAPODS_MAX_VIEWERS=str(PLACES))


def watching(server: Served, stack: ExitStack, source: str, *, operator: bool = False) -> Viewer:
    """A viewer from one of this machine's addresses."""
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
def test_places_before_the_stage(server: Served) -> None:
    with ExitStack() as stack:
        crowd = [watching(server, stack, "127.0.0.2") for _ in range(SHARE)]
        crowd[-1].frame()
        assert refusal(watching(server, stack, "127.0.0.2")) == (1013, "address full")
        others = [watching(server, stack, "127.0.0.3") for _ in range(PLACES - SHARE)]
        others[-1].frame()
        # All are taken now.
        assert watching(server, stack, "127.0.0.4").frame().raw
        assert refusal(crowd[-1]) == (1013, "place taken")
        assert watching(server, stack, "127.0.0.2", operator=True).frame().raw
        assert refusal(crowd[-2]) == (1013, "place taken")


def listening(server: Served, stack: ExitStack, source: str, *, operator: bool = False) -> bytes:
    """Begin to follow the events; the head of the answer."""
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
def test_places_for_streams_of_events(server: Served) -> None:
    with ExitStack() as stack:
        for _ in range(SHARE):
            assert listening(server, stack, "127.0.0.2").startswith(b"HTTP/1.1 200")
        refused = listening(server, stack, "127.0.0.2")
        assert refused.startswith(b"HTTP/1.1 429")
        assert b"retry-after: 10" in refused.lower()
        for _ in range(PLACES - SHARE):
            assert listening(server, stack, "127.0.0.3").startswith(b"HTTP/1.1 200")
        assert listening(server, stack, "127.0.0.4").startswith(b"HTTP/1.1 200")
        assert listening(server, stack, "127.0.0.2", operator=True).startswith(b"HTTP/1.1 200")
    # Those who left have left: their places are free again.
    with ExitStack() as stack:
        for _ in range(SHARE):
            assert listening(server, stack, "127.0.0.5").startswith(b"HTTP/1.1 200")
        with server.client.stream("GET", "/api/v1/events") as stream:
            lines = stream.iter_lines()
            data = next(line for line in lines if line.startswith("data: "))
            assert json.loads(data.removeprefix("data: "))["role"] == "spectator"
