"""Memory budget: unread responses and unfinished request bodies are bounded."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress

import pytest
import uvicorn
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.memory_limit import ANSWERS_SHARE_BYTES, BODIES_SHARE_BYTES, BodyMemoryLimit
from app.api.policy import PUBLIC, RoutePolicy
from tests.api.guarding import admitted

MB = 1 << 20
LARGE = 8 * MB


async def answer(scope: Scope, receive: Receive, send: Send) -> None:
    request = Request(scope, receive)
    body = await request.body()
    size = LARGE if scope["path"] == "/large" else 10
    await Response(b"x" * size, headers={"X-Received": str(len(body))})(scope, receive, send)


class AsOperator:
    """Set the role of every request, as the token guard does."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            takes_file = scope["path"].endswith("import")
            scope["state"] = admitted("operator", RoutePolicy(access=PUBLIC, takes_file=takes_file))
        await self._app(scope, receive, send)


@pytest.fixture
def port() -> Iterator[int]:
    app = AsOperator(BodyMemoryLimit(answer))
    config = uvicorn.Config(
        app, host="127.0.0.1", port=0, lifespan="off", ws="none", log_level="critical"
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield server.servers[0].sockets[0].getsockname()[1]
    server.should_exit = server.force_exit = True
    thread.join()


def send_request(stack: ExitStack, port: int, head: str, body: bytes = b"") -> socket.socket:
    sock = stack.enter_context(socket.socket())
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    sock.settimeout(30)
    sock.connect(("127.0.0.1", port))
    sock.sendall(f"{head} HTTP/1.1\r\nHost: x\r\n".encode() + body)
    return sock


def test_unread_responses_are_complete_within_the_share_and_refused_beyond(port: int) -> None:
    with ExitStack() as stack:
        within = ANSWERS_SHARE_BYTES // LARGE
        readers = [send_request(stack, port, "GET /large", b"\r\n") for _ in range(within)]
        assert [reader.recv(12) for reader in readers] == [b"HTTP/1.1 200"] * within
        refused = send_request(stack, port, "GET /large", b"\r\n").recv(4096)
        assert refused.startswith(b"HTTP/1.1 429")
        assert b"retry-after: 5" in refused.lower()
        assert send_request(stack, port, "GET /small", b"\r\n").recv(12) == b"HTTP/1.1 200"

        received = 0
        while received < LARGE:
            chunk = readers[0].recv(1 << 16)
            assert chunk
            received += chunk.count(b"x")
        assert send_request(stack, port, "GET /large", b"\r\n").recv(12) == b"HTTP/1.1 200"


def test_unfinished_bodies_are_refused_beyond_the_share(port: int) -> None:
    with ExitStack() as stack:
        length = f"Content-Length: {64 * MB}\r\n\r\n".encode()
        fitting = BODIES_SHARE_BYTES // (16 * MB)
        senders = [
            send_request(stack, port, "POST /api/v1/import", length) for _ in range(fitting + 1)
        ]
        for sender in senders[:fitting]:
            sender.sendall(bytes(16 * MB - 256 * 1024))
        time.sleep(0.5)
        with suppress(OSError):  # the server closes the connection during the send
            senders[fitting].sendall(bytes(16 * MB))
        assert senders[fitting].recv(12) == b"HTTP/1.1 429"
