"""Raw HTTP requests that clients would not send, and a monitor of the server's memory."""

import re
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import NamedTuple

import psutil
from fastapi.routing import iter_route_contexts

from app.api.policy import Access, policies
from app.server import create_app
from app.settings import Settings
from tests.storage.stores import temporary_store

_PATIENCE_S = 60.0
UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}
"""Headers of the handshake of a websocket, which no path of the server answers."""


class Route(NamedTuple):
    """A method and path of the server."""

    method: str
    path: str


def every_route() -> list[Route]:
    """Return all routes of the server; a folder of static files as the path of one file in it."""
    with temporary_store() as store:
        contexts = iter_route_contexts(create_app(Settings(data=Path("unused")), store).routes)
    routes: list[Route] = []
    for context in contexts:
        path = context.path or "/"
        if path == "/static":
            routes += [Route(method, "/static/favicon.svg") for method in ("GET", "HEAD")]
        else:
            routes += [Route(method, path) for method in sorted(context.methods or ())]
    assert len(routes) > 30
    return routes


@cache
def accesses() -> dict[Route, Access]:
    """Return the access of each of `every_route`, as its policy has it."""
    with temporary_store() as store:
        of_routes = policies(create_app(Settings(data=Path("unused")), store))
    by_route: dict[Route, Access] = {}
    for route in every_route():
        path = "/static" if route.path.startswith("/static/") else route.path
        method = "get" if route.method == "HEAD" else route.method.lower()
        by_route[route] = of_routes[method, re.sub(":(path|robot)}", "}", path)].access
    return by_route


def send(port: int, *lines: str, body: bytes = b"", source: str = "127.0.0.1") -> bytes:
    """Send a request over a raw socket, and return the first 64 KiB of the answer.

    Args:
        port: the server's port.
        lines: the request line and the headers, in any bytes of Latin-1.
        body: the request's body.
        source: the client's address, a loopback one.
    """
    with socket.create_connection(("127.0.0.1", port), _PATIENCE_S, (source, 0)) as sock:
        head = "\r\n".join([*lines, "Connection: close"]) + "\r\n\r\n"
        sock.sendall(head.encode("latin-1") + body)
        answer = b""
        while len(answer) < 1 << 16 and (chunk := sock.recv(1 << 16)):
            answer += chunk
            if b"text/event-stream" in answer:
                break  # an endless stream
        return answer


def status_of(answer: bytes) -> int:
    """Return the status code of an answer; 0 if the server closed the connection without one."""
    return int(answer.split()[1]) if answer else 0


def request_lines(route: Route, host: str, **headers: str) -> list[str]:
    """Return the request line and headers for a route."""
    lines = [f"{route.method} {route.path} HTTP/1.1"]
    if "Host" not in headers:
        lines.append(f"Host: {host}")
    lines += [f"{name}: {value}" for name, value in headers.items()]
    if route.method not in ("GET", "HEAD"):
        lines.append("Content-Length: 0")
    return lines


class Memory:
    """Memory of a monitored process.

    Attributes:
        grown_bytes: peak resident memory above that at the start.
    """

    grown_bytes = 0


@contextmanager
def watched_memory(pid: int) -> Iterator[Memory]:
    """Sample a process's resident memory every 5 ms."""
    process, memory, finished = psutil.Process(pid), Memory(), threading.Event()
    before = process.memory_info().rss

    def look() -> None:
        while not finished.wait(0.005):
            memory.grown_bytes = max(memory.grown_bytes, process.memory_info().rss - before)

    watcher = threading.Thread(target=look, daemon=True)
    watcher.start()
    try:
        yield memory
    finally:
        finished.set()
        watcher.join()
        memory.grown_bytes = max(memory.grown_bytes, process.memory_info().rss - before)
