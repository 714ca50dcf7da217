"""Promise 17: bodies are capped: 1 MiB of JSON, chunked too: 413, memory flat.

In full, for every writing route: 256 MiB are announced by Content-Length, or one chunk more than
allowed is sent of an unfinished chunked body.
"""

import http.client
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest

from app.api.memory_limit import MAX_BODY_BYTES
from tests.browser.serving import Serving
from tests.promises.raw import every_route, watched_memory

pytestmark = pytest.mark.test

OFFERED_BYTES = 256 << 20
CHUNK = bytes(1 << 16)
FLAT_BYTES = 20_000_000
WRITING = ("POST", "PUT", "PATCH", "DELETE")


def answer(server: Serving, method: str, path: str, *, chunked: bool) -> int:
    """Send a too large body until the server answers or closes; return the status."""
    connection = http.client.HTTPConnection(urlsplit(server.address).netloc, timeout=60)
    connection.putrequest(method, path)
    connection.putheader("Content-Type", "application/json")
    if chunked:
        connection.putheader("Transfer-Encoding", "chunked")
    else:
        connection.putheader("Content-Length", str(OFFERED_BYTES))
    connection.endheaders()
    for chunk in chunks() if chunked else ():
        try:
            connection.send(chunk)
        except (BrokenPipeError, ConnectionResetError):
            break
    try:
        return connection.getresponse().status
    finally:
        connection.close()


def chunks() -> Iterator[bytes]:
    """Yield chunks just beyond the limit, without the last chunk."""
    for _ in range(MAX_BODY_BYTES // len(CHUNK) + 1):
        yield f"{len(CHUNK):x}\r\n".encode() + CHUNK + b"\r\n"


def test_every_body_is_capped(quiet_server: Serving) -> None:
    routes = [route for route in every_route() if route.method in WRITING]
    assert len(routes) > 10
    refused = 0
    with watched_memory(quiet_server.pid) as memory:
        for method, path in routes:
            filled_path = path.replace("{run_id}", "none")
            assert answer(quiet_server, method, filled_path, chunked=False) == 413, (method, path)
            takes_files = filled_path.endswith(("/import", "/robots", "/readings"))
            if not takes_files and method != "DELETE":
                # Or 404, from a route that takes no body and so reads none.
                status = answer(quiet_server, method, filled_path, chunked=True)
                assert status in (404, 413), (method, path)
                refused += status == 413

    assert refused >= 4
    assert memory.grown_bytes < FLAT_BYTES
