"""Promise 35: guessing is rate limited, and other ports are foreign: every kind of credential is
counted, and the Origin matrix of promise 19 has the same host on another port.

In full: 2,000 wrong guesses of each kind, over raw sockets, each kind against a server of its own;
an operator's browser stays signed in meanwhile, across a restart too, and until the token changes.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.browser.serving import Serving, serving
from tests.promises.raw import send, status_of

TOKEN, OTHER = "a-token-for-tests", "another-token-for-tests"
GUESSES = 2000
ALLOWED = 30
"""The token bucket's 20 guesses, and its refill of one per 5 s on a slow machine."""
Guess = Callable[[int, int], tuple[str, ...]]

KINDS: dict[str, Guess] = {
    "bearer": lambda port, n: ("GET /healthz HTTP/1.1", f"Authorization: Bearer guess-{n}"),
    "link": lambda port, n: (f"GET /?token=guess-{n} HTTP/1.1",),
    "cookie": lambda port, n: (
        "GET /healthz HTTP/1.1",
        f"Cookie: hexapods_operator_{port}=guess-{n}",
    ),
    "cookie of a websocket": lambda port, n: (
        "GET /viewer/ HTTP/1.1",
        f"Cookie: hexapods_operator_{port}=guess-{n}",
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
    ),
    "in turns": lambda port, n: KINDS[("bearer", "link", "cookie")[n % 3]](port, n),
}


def request(server: Serving, *lines: str) -> bytes:
    """Send a request with these lines, and return the server's answer."""
    return send(server.port, lines[0], f"Host: 127.0.0.1:{server.port}", *lines[1:])


def sign_in(server: Serving) -> str:
    """Sign in by the link with the token; return the header with the session's cookie."""
    answer = request(server, f"GET /?token={TOKEN} HTTP/1.1").decode("latin-1")
    (cookie,) = [line for line in answer.split("\r\n") if line.lower().startswith("set-cookie:")]
    return "Cookie: " + cookie.partition(":")[2].partition(";")[0].strip()


def may_change(server: Serving, *headers: str) -> bool:
    """Whether the server accepts a writing request with these headers."""
    more = ("X-Requested-With: tests", "Content-Type: application/json", "Content-Length: 2")
    head = ("PUT /api/v1/stage HTTP/1.1", f"Host: 127.0.0.1:{server.port}", *headers, *more)
    return status_of(send(server.port, *head, body=b"{}")) == 200


@pytest.mark.timeout(600)
@pytest.mark.parametrize("kind", KINDS)
def test_wrong_guesses_of_every_credential_are_rate_limited(kind: str, tmp_path: Path) -> None:
    with serving(tmp_path, token=TOKEN) as server:
        cookie = sign_in(server)
        refused = 0
        for number in range(GUESSES):
            answer = request(server, *KINDS[kind](server.port, number))
            # A websocket is refused by 403 in either case.
            refused += status_of(answer) in (429, 403)
        assert refused >= GUESSES - ALLOWED
        assert may_change(server, cookie), "guesses must not lock out a signed-in operator"
        assert not may_change(server)


def test_a_session_survives_a_restart_but_not_a_change_of_token(tmp_path: Path) -> None:
    with serving(tmp_path, token=TOKEN) as server:
        port = server.port
        cookie = sign_in(server)
        assert may_change(server, cookie)
        stored = (tmp_path / "hexapods.db").read_bytes()
        assert cookie.partition("=")[2].encode() not in stored
    with serving(tmp_path, port, token=TOKEN) as server:
        assert may_change(server, cookie)
    with serving(tmp_path, port, token=OTHER) as server:
        assert not may_change(server, cookie)
    with serving(tmp_path, port, token=TOKEN) as server:
        assert not may_change(server, cookie)


def test_a_page_on_another_port_changes_nothing(tmp_path: Path) -> None:
    with serving(tmp_path, token=TOKEN) as server:
        cookie = sign_in(server)
        own = f"http://127.0.0.1:{server.port}"
        assert may_change(server, cookie, f"Origin: {own}", "Sec-Fetch-Site: same-origin")
        for foreign in (
            (f"Origin: http://127.0.0.1:{server.port + 1}",),
            ("Origin: http://127.0.0.1",),
            (f"Origin: http://localhost:{server.port}",),
            ("Sec-Fetch-Site: same-site",),
            (f"Origin: {own}", "Sec-Fetch-Site: same-site"),
        ):
            assert not may_change(server, cookie, *foreign), foreign
