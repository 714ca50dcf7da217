"""Promise 35: guessing is rate limited, and other ports are foreign: every kind of credential is
counted, and the Origin matrix of promise 19 has the same host on another port.

Promised: 2,000 wrong guesses of each kind; here 200, in full by `make soak`. They are sent over raw
sockets, each kind from an address of its own. An operator's browser stays signed in meanwhile,
across a restart too, and until the token changes.

Codes of rooms are not counted: they are too long to guess, and a class shares its address.
"""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from app.features.classroom.names import ALPHABET, CODE_LENGTH
from app.features.classroom.room_registry import MAX_OPEN
from app.features.classroom.seats import MAX_PARTICIPANTS
from app.server import create_app
from app.settings import Settings
from tests.api.calls import ADDRESS
from tests.browser.serving import Serving, serving
from tests.promises.length import at_length
from tests.promises.raw import UPGRADE, Route, every_route, request_lines, send, status_of
from tests.storage.stores import opened

TOKEN, OTHER = "a-token-for-tests", "another-token-for-tests"
GUESSES = at_length(200, 2000)
ALLOWED = 30
"""The token bucket's 20 guesses, and its refill of one per 5 s on a slow machine."""
LOCAL = "127.0.0.1"
GUESSES_PER_S = 1600
"""Wrong codes of rooms that a client was seen to try."""
Guess = Callable[[int, int], tuple[str, ...]]

KINDS: dict[str, Guess] = {
    "bearer": lambda port, n: ("GET /healthz HTTP/1.1", f"Authorization: Bearer guess-{n}"),
    "link": lambda port, n: (f"GET /?token=guess-{n} HTTP/1.1",),
    "cookie": lambda port, n: (
        "GET /healthz HTTP/1.1",
        f"Cookie: hexapods_operator_{port}=guess-{n}",
    ),
    "cookie of a stream": lambda port, n: (
        "GET /api/v1/events?picture=true HTTP/1.1",
        f"Cookie: hexapods_operator_{port}=guess-{n}",
    ),
    "cookie of a handshake": lambda port, n: (
        "GET /viewer/ HTTP/1.1",
        f"Cookie: hexapods_operator_{port}=guess-{n}",
        *(f"{name}: {value}" for name, value in UPGRADE.items()),
    ),
    "in turns": lambda port, n: KINDS[("bearer", "link", "cookie")[n % 3]](port, n),
}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    with serving(tmp_path_factory.mktemp("data"), token=TOKEN) as shared:
        yield shared


def request(server: Serving, source: str, *lines: str) -> bytes:
    """Send a request with these lines from an address, and return the server's answer."""
    host = f"Host: 127.0.0.1:{server.port}"
    return send(server.port, lines[0], host, *lines[1:], source=source)


def sign_in(server: Serving, source: str = LOCAL) -> str:
    """Sign in by the link with the token; return the header with the session's cookie."""
    return cookie_of(request(server, source, f"GET /?token={TOKEN} HTTP/1.1"))


def cookie_of(answer: bytes) -> str:
    """Return the header that sends the cookie of an answer back."""
    lines = answer.decode("latin-1").split("\r\n")
    (cookie,) = [line for line in lines if line.lower().startswith("set-cookie:")]
    return "Cookie: " + cookie.partition(":")[2].partition(";")[0].strip()


def may_change(server: Serving, *headers: str, source: str = LOCAL) -> bool:
    """Whether the server accepts a writing request with these headers."""
    more = ("X-Requested-With: tests", "Content-Type: application/json", "Content-Length: 2")
    head = ("PUT /api/v1/stage HTTP/1.1", f"Host: 127.0.0.1:{server.port}", *headers, *more)
    return status_of(send(server.port, *head, body=b"{}", source=source)) == 200


@pytest.mark.timeout(600)
@pytest.mark.parametrize("kind", KINDS)
def test_wrong_guesses_of_every_credential_are_rate_limited(kind: str, server: Serving) -> None:
    source = f"127.0.0.{2 + list(KINDS).index(kind)}"
    cookie = sign_in(server, source)
    refused = 0
    for number in range(GUESSES):
        answer = request(server, source, *KINDS[kind](server.port, number))
        refused += status_of(answer) == 429
    assert refused >= GUESSES - ALLOWED
    assert may_change(server, cookie, source=source), "guesses must not lock out an operator"
    for _ in range(20):
        assert may_change(server, f"Authorization: Bearer {TOKEN}", source=source)
    sign_in(server, source)
    assert not may_change(server, source=source)


def test_guessing_the_codes_of_rooms_costs_a_neighbour_nothing(server: Serving) -> None:
    """Codes are too long to guess, so no limit is needed that others of the address could use up.

    With one, right codes could be told from wrong ones by what is refused once it is used up.
    """
    a_day = GUESSES_PER_S * 86_400
    assert MAX_OPEN * a_day / len(ALPHABET) ** CODE_LENGTH < 0.005
    with server.api(TOKEN) as teacher:
        code = teacher.post("rooms", json={}).raise_for_status().json()["code"]
    of_rooms = [route for route in every_route() if "{code}" in route.path]
    assert len(of_rooms) > 15

    def status(route: Route, code: str) -> int:
        """Return the status of a route of rooms that a stranger asks with a code."""
        path = route.path.replace("{code}", code).replace("{seed}", "0")
        lines = request_lines(Route(route.method, path), f"127.0.0.1:{server.port}")
        return status_of(send(server.port, *lines, "X-Requested-With: tests"))

    def answers(code: str) -> list[int]:
        return [status(route, code) for route in of_rooms]

    wrong_before, right_before = answers("WRNGCQDE"), answers(code)
    for number in range(GUESSES):
        guess = f"{number:08d}".translate(str.maketrans("01", "AB"))
        route = of_rooms[number % len(of_rooms)]
        assert status(route, guess) != 429, route
    assert answers("WRNGCQDE") == wrong_before
    assert answers(code) == right_before
    assert 429 not in right_before


def test_joins_of_one_person_cost_a_neighbour_nothing(server: Serving) -> None:
    with server.api(TOKEN) as teacher:
        code = teacher.post("rooms", json={}).raise_for_status().json()["code"]
    path = f"/api/v1/rooms/{code}"

    def join() -> str:
        """Join as somebody without a cookie, and return the header with the one that came."""
        host, custom_header = f"Host: 127.0.0.1:{server.port}", "X-Requested-With: tests"
        line = f"POST {path}/participants HTTP/1.1"
        answer = send(server.port, line, host, custom_header, "Content-Length: 0")
        assert status_of(answer) == 201, answer
        return cookie_of(answer)

    def seed(cookie: str) -> int:
        me = json.loads(
            request(server, LOCAL, f"GET {path} HTTP/1.1", cookie).split(b"\r\n\r\n")[1]
        )
        return int(me["me"]["seed"])

    pupil = join()
    with (
        server.api() as api,
        api.stream("GET", f"rooms/{code}/events", headers=dict([pupil.split(": ")])) as events,
    ):
        lines = events.iter_lines()
        # Whose page is open has a seat, however many are needed.
        assert "snapshot" in next(lines)
        for _ in range(2 * MAX_PARTICIPANTS):
            join()
        neighbours = [join() for _ in range(28)]
        assert len({seed(cookie) for cookie in neighbours}) == 28
        assert seed(pupil) == 0


@pytest.mark.parametrize("kind", ["bearer", "link", "cookie"])
def test_guesses_are_counted_by_the_address_of_the_connection(kind: str, server: Serving) -> None:
    """Nobody gets further guesses by naming other addresses, unless a proxy is configured."""
    refused = 0
    for number in range(GUESSES):
        line, *more = KINDS[kind](server.port, number)
        forwarded = f"X-Forwarded-For: 192.0.2.{number % 250}"
        refused += status_of(request(server, LOCAL, line, forwarded, *more)) == 429
    assert refused >= GUESSES - ALLOWED


def test_guesses_through_a_configured_proxy_are_counted_by_its_clients(tmp_path: Path) -> None:
    other = "127.0.2.1"
    with serving(tmp_path, token=TOKEN, trusted_proxies=f"{LOCAL}, 192.0.2.0/24") as server:

        def refused(source: str, *forwarded: str) -> int:
            """Return how many of the guesses are refused, one for each forwarded address."""
            lines = KINDS["bearer"](server.port, 1)
            answers = [
                request(server, source, *lines, f"X-Forwarded-For: {address}")
                for address in forwarded
            ]
            return [status_of(answer) for answer in answers].count(429)

        many = range(2 * ALLOWED)
        assert refused(LOCAL, *("198.51.100.200" for _ in many)) >= ALLOWED
        assert refused(LOCAL, *(f"198.51.100.{n}" for n in many)) == 0
        # What a client itself names is before the addresses that the proxies add.
        forged = (f"203.0.113.{n}, 198.51.100.201, 192.0.2.9" for n in many)
        assert refused(LOCAL, *forged) >= ALLOWED
        assert refused(other, *(f"198.51.101.{n}" for n in many)) >= ALLOWED


def status_after_restart(data: Path, token: str, cookie: str) -> int:
    """Return the status of a change with a session's cookie, from a new server on the folder."""
    headers = {"Cookie": cookie, "X-Requested-With": "tests"}
    with opened(data, None) as store:
        app = create_app(Settings(data=data, token=token), store)
        with TestClient(app, base_url=ADDRESS) as client:
            return client.put("/api/v1/stage", json={}, headers=headers).status_code


def test_a_session_survives_a_restart_but_not_a_change_of_token(tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        app = create_app(Settings(data=tmp_path, token=TOKEN), store)
        with TestClient(app, base_url=ADDRESS, follow_redirects=False) as client:
            cookie = (
                client.get("/", params={"token": TOKEN}).headers["Set-Cookie"].partition(";")[0]
            )
            custom_header = {"X-Requested-With": "tests"}
            assert client.put("/api/v1/stage", json={}, headers=custom_header).status_code == 200
    stored = (tmp_path / "hexapods.db").read_bytes()
    assert cookie.partition("=")[2].encode() not in stored
    assert status_after_restart(tmp_path, TOKEN, cookie) == 200
    assert status_after_restart(tmp_path, OTHER, cookie) == 401
    assert status_after_restart(tmp_path, TOKEN, cookie) == 401


def test_a_page_on_another_port_changes_nothing(server: Serving) -> None:
    cookie = sign_in(server)
    origin = f"http://127.0.0.1:{server.port}"
    assert may_change(server, cookie, f"Origin: {origin}", "Sec-Fetch-Site: same-origin")
    for foreign in (
        (f"Origin: http://127.0.0.1:{server.port + 1}",),
        ("Origin: http://127.0.0.1",),
        (f"Origin: http://localhost:{server.port}",),
        ("Sec-Fetch-Site: same-site",),
        (f"Origin: {origin}", "Sec-Fetch-Site: same-site"),
    ):
        assert not may_change(server, cookie, *foreign), foreign
