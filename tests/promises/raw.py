"""Requests as no well-behaved client sends them, and what they cost the server."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import psutil
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts

_PATIENCE_S = 60.0


class Route(NamedTuple):
    """One thing that the server answers to; `WS` is the method of websockets."""

    method: str
    path: str


def every_route(app: FastAPI) -> list[Route]:
    """All that the app has, as it knows them itself; folders as the path of one file in them."""
    found: list[Route] = []
    for context in iter_route_contexts(app.routes):
        path = context.path or "/"
        if path == "/static":
            found += [Route(method, "/static/favicon.svg") for method in ("GET", "HEAD")]
        else:
            found += [Route(method, path) for method in sorted(context.methods or {"WS"})]
    assert len(found) > 30
    return found


def send(port: int, *lines: str, body: bytes = b"") -> bytes:
    """Send a request word by word, and return what begins the answer.

    Args:
        port: of the server.
        lines: the request's line and its headers, in any bytes of Latin-1.
        body: after them.
    """
    with socket.create_connection(("127.0.0.1", port), timeout=_PATIENCE_S) as sock:
        end = [] if "Upgrade: websocket" in lines else ["Connection: close"]
        head = "\r\n".join([*lines, *end]) + "\r\n\r\n"
        sock.sendall(head.encode("latin-1") + body)
        answer = b""
        while len(answer) < 1 << 16 and (part := sock.recv(1 << 16)):
            answer += part
            if answer.startswith(b"HTTP/1.1 101") or b"text/event-stream" in answer:
                break  # there is no end to wait for
        return answer


def status_of(answer: bytes) -> int:
    """The status of an answer; 0 if the server just hung up."""
    return int(answer.split()[1]) if answer else 0


def request_lines(route: Route, host: str, **headers: str) -> list[str]:
    """The lines of a request, for a websocket those of a handshake."""
    lines = [f"{'GET' if route.method == 'WS' else route.method} {route.path} HTTP/1.1"]
    if "Host" not in headers:
        lines.append(f"Host: {host}")
    lines += [f"{name}: {value}" for name, value in headers.items()]
    if route.method == "WS":
        lines += [
            "Connection: Upgrade",
            "Upgrade: websocket",
            "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        ]
    elif route.method not in ("GET", "HEAD"):
        lines.append("Content-Length: 0")
    return lines


class Memory:
    """A process's memory while it is watched.

    Attributes:
        grown_bytes: the most that it had over what it had at first.
    """

    grown_bytes = 0


@contextmanager
def watched_memory(pid: int) -> Iterator[Memory]:
    """Look at a process's resident memory every few milliseconds."""
    process, memory, over = psutil.Process(pid), Memory(), threading.Event()
    before = process.memory_info().rss

    def look() -> None:
        while not over.wait(0.005):
            memory.grown_bytes = max(memory.grown_bytes, process.memory_info().rss - before)

    watcher = threading.Thread(target=look, daemon=True)
    watcher.start()
    try:
        yield memory
    finally:
        over.set()
        watcher.join()
        memory.grown_bytes = max(memory.grown_bytes, process.memory_info().rss - before)
