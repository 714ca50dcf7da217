"""Promise 19: foreign pages get nowhere: Host, Origin and Fetch metadata over every route.

Over raw sockets: 100 % refused. The gate tries every third of them on each route; in full by
`make soak`.
"""

import pytest

from tests.browser.serving import Serving
from tests.promises.length import at_length
from tests.promises.raw import every_route, request_lines, send, status_of

pytestmark = pytest.mark.test

EVERY = at_length(3, 1)
FOREIGN_HOSTS = [
    "evil.example",
    "evil.example:{port}",
    "127.0.0.1.evil.example:{port}",
    "localhost.evil.example",
    "localhost@evil.example",
    "evil.example/127.0.0.1",
    "127.0.0.1:{port}, evil.example",
    "[::1",
    "",
]
FOREIGN_ORIGINS = [
    "http://evil.example",
    "https://evil.example:{port}",
    "http://127.0.0.1.evil.example:{port}",
    "http://127.0.0.1:{port}.evil.example",
    "http://127.0.0.1:{port}@evil.example",
    "http://203.0.113.7:{port}",
    "chrome-extension://abcdefghijklmnop",
    "file://",
    "null",
    "",
    "http://127.0.0.1:{port}, http://evil.example",
    # The same machine on another port, on the standard port, and by another of its names.
    "http://127.0.0.1:8399",
    "http://127.0.0.1",
    "https://127.0.0.1",
    "http://localhost:{port}",
    "http://[::1]:{port}",
]
FOREIGN_FETCHES = [
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"},
    {"Sec-Fetch-Site": "same-origin, cross-site"},
    {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "image"},
    {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"},
    {"Sec-Fetch-Site": "same-site", "Sec-Fetch-Mode": "websocket", "Sec-Fetch-Dest": "websocket"},
]


def test_foreign_headers_are_refused_on_every_route(quiet_server: Serving) -> None:
    port = quiet_server.port
    server_host = f"127.0.0.1:{port}"
    headers = [{"Host": host.format(port=port)} for host in FOREIGN_HOSTS]
    headers += [{"Origin": origin.format(port=port)} for origin in FOREIGN_ORIGINS]
    headers += FOREIGN_FETCHES
    routes = every_route()
    accepted = []
    for number, route in enumerate(routes):
        # Each route begins with another one, so that each of them meets many routes.
        for foreign in headers[number % EVERY :: EVERY]:
            answer = send(port, *request_lines(route, server_host, **foreign))
            # uvicorn itself refuses a malformed Host.
            if status_of(answer) not in (403, 400):
                accepted.append((route, foreign, answer[:100]))
    assert accepted == []


def test_duplicate_hosts_or_origins_are_refused(quiet_server: Serving) -> None:
    port = quiet_server.port
    for more in (
        [f"Host: 127.0.0.1:{port}", "Host: evil.example"],
        ["Host: evil.example", f"Host: 127.0.0.1:{port}"],
        [
            f"Host: 127.0.0.1:{port}",
            f"Origin: http://127.0.0.1:{port}",
            "Origin: http://evil.example",
        ],
        [],
    ):
        answer = send(port, "GET /api/v1/stage HTTP/1.1", *more)
        assert status_of(answer) in (400, 403), more


def test_the_apps_own_page_is_accepted_on_every_route(quiet_server: Serving) -> None:
    port = quiet_server.port
    server_host = f"127.0.0.1:{port}"
    for route in every_route():
        if route.method in ("GET", "HEAD"):
            answer = send(port, *request_lines(route, server_host, Origin=f"http://{server_host}"))
            assert status_of(answer) not in (400, 401, 403), (route, answer[:200])
