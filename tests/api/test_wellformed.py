"""Malformed requests over raw sockets are refused with a 4xx or 501, never a 500."""

import contextlib
from collections.abc import Iterator
from typing import Any

import pytest

from tests.browser.serving import Serving, serving
from tests.promises.raw import every_route, send, status_of

TOKEN = "a-token-for-tests"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with serving(tmp_path_factory.mktemp("data"), token=TOKEN) as running:
        yield running


def ask(server: Serving, *lines: str, body: bytes = b"") -> bytes:
    return send(server.port, lines[0], f"Host: 127.0.0.1:{server.port}", *lines[1:], body=body)


@pytest.mark.parametrize(
    ("target", "status"),
    [
        ("/?a=1#&token=x", 400),
        ("/#?token=x", 400),
        ("/api/v1/trainings#x", 400),
        ("/api/v1/events?#", 400),
        ("/api/v1/trainings/\xe9", 400),
        ("/?token=\xe9", 400),
        ("/\x7f", 400),
        ("http://127.0.0.1/api/v1/stage", 400),
        ("http://evil.example/", 400),
        ("127.0.0.1:80", 400),
        ("*", 400),
        ("?token=x", 400),
        ("//evil.example", 404),
        ("//evil.example/%2e%2e", 404),
        ("/viewer//evil.example", 404),
        ("/?token=%23&a=%ff", 401),
        ("/?token=%00", 401),
        ("/" + "a" * 9000, 414),
        ("/?" + "a" * 9000, 414),
    ],
    ids=lambda value: str(value)[:30],
)
@pytest.mark.parametrize("method", ["GET", "HEAD", "POST", "OPTIONS"])
def test_malformed_targets_are_refused(
    server: Serving, method: str, target: str, status: int
) -> None:
    answer = ask(server, f"{method} {target} HTTP/1.1", "Content-Length: 0")
    if method in ("GET", "HEAD") or status in (400, 414):
        assert status_of(answer) == status, answer[:300]
    assert 400 <= status_of(answer) < 500
    assert b"location: " not in answer.lower()


def test_overlong_target_is_refused(server: Serving) -> None:
    # The server may close the connection during the send.
    with contextlib.suppress(ConnectionResetError, BrokenPipeError):
        answer = ask(server, f"GET /{'a' * 1_000_000} HTTP/1.1")
        assert status_of(answer) in (0, 400, 414), answer[:300]
    assert status_of(ask(server, "GET /healthz HTTP/1.1")) == 200


@pytest.mark.parametrize(
    "lines",
    [
        ("Content-Length: 4", "Transfer-Encoding: chunked"),
        ("Transfer-Encoding: chunked", "Content-Length: 4"),
        ("Transfer-Encoding: identity", "Content-Length: 4"),
        ("Transfer-Encoding: chunked, identity",),
        ("Transfer-Encoding: chunked", "Transfer-Encoding: chunked"),
        ("Content-Length: 4", "Content-Length: 5"),
        ("Content-Length: 4, 5",),
        ("Content-Length: +4",),
        ("Content-Length: 4x",),
        ("Content-Length : 4",),
    ],
    ids=str,
)
def test_ambiguous_framing_is_refused(server: Serving, lines: tuple[str, ...]) -> None:
    """The bytes that follow on the connection are not parsed as another request."""
    more = (f"Authorization: Bearer {TOKEN}", "Content-Type: application/json")
    hidden = b"0\r\n\r\nGET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
    answer = ask(server, "PUT /api/v1/stage HTTP/1.1", *more, *lines, body=hidden)
    assert status_of(answer) in (400, 501), answer[:300]
    assert answer.count(b"HTTP/1.1 ") == 1


def test_head_has_the_headers_of_get_without_the_body(server: Serving) -> None:
    bearer = f"Authorization: Bearer {TOKEN}"
    routes = every_route()
    paths = {r.path.replace("{run_id}", "none") for r in routes if r.method == "GET"}
    assert len(paths) > 20
    for path in sorted(paths):
        # `ask` reads to the end, so a HEAD of the event stream must end.
        head, _, body = ask(server, f"HEAD {path} HTTP/1.1", bearer).partition(b"\r\n\r\n")
        assert body == b"", path
        if path == "/api/v1/events":
            assert b"text/event-stream" in head
            continue
        got, _, _ = ask(server, f"GET {path} HTTP/1.1", bearer).partition(b"\r\n\r\n")
        assert stable_headers(head) == stable_headers(got), path
    answer = ask(server, "PUT /api/v1/options HTTP/1.1", bearer, "Content-Length: 0")
    assert b"allow: GET, HEAD\r\n" in answer.lower().replace(b"get, head", b"GET, HEAD")


def stable_headers(head: bytes) -> dict[bytes, Any]:
    """Return status and headers, without those that differ between requests."""
    status, *lines = head.split(b"\r\n")
    headers = dict(line.lower().split(b": ", 1) for line in lines)
    for name in (b"date", b"content-length", b"transfer-encoding"):
        headers.pop(name, None)
    return {b"status": status, **headers}


def test_head_of_a_stream_leaves_the_connection_usable(server: Serving) -> None:
    lines = ["HEAD /api/v1/events HTTP/1.1", f"Host: 127.0.0.1:{server.port}", "", "GET /healthz"]
    answer = send(server.port, "\r\n".join(lines) + " HTTP/1.1", "Host: 127.0.0.1")
    assert answer.count(b"HTTP/1.1 200") >= 1
