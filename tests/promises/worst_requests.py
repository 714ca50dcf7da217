"""The largest and worst that a stranger can send, and what it costs the server's processor."""

import itertools
import re
import socket
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple
from urllib.parse import quote

from app.api.cookies import NAME
from app.api.request_headers import READ, READ_BEFORE
from app.features.classroom.access import ROOM_NAME
from app.features.classroom.names import ALPHABET, CODE_LENGTH
from app.features.demo.access import VISITOR_NAME

NAMES = (NAME, ROOM_NAME, VISITOR_NAME)
"""The beginnings of the names of all cookies."""
HEAD_BYTES = 60_000
"""As much as arrives at once on loopback."""
LARGE_BYTES = 60_000
"""More than any header may have."""
ADMITTED_BYTES = 7_500
"""As much as a header, a cookie, a path or a query may have, with its name and separators."""
BODY_BYTES = 1_000_000
_PATIENCE_S = 60.0


def _repeated(unit: str) -> Callable[[int], str]:
    return lambda size: (unit * (size // len(unit) + 1))[:size]


def _between(first: str, unit: str, last: str) -> Callable[[int], str]:
    return lambda size: f"{first}{_repeated(unit)(size - len(first) - len(last))}{last}"


VALUES: Mapping[str, Callable[[int], str]] = {
    "a word": _repeated("a"),
    "digits": _repeated("1"),
    "commas": _repeated(","),
    "items": _repeated("a,"),
    "a media type many times": _repeated("text/csv;q=0.1,"),
    "parameters": _between("text/html", ";a=b", ""),
    "many qualities": _between("gzip", ";q=0.0", ""),
    "escaped quotes": _between('a="', '\\"', '"'),
    "octal escapes": _between('a="', "\\200", '"'),
    "an open quote": _between('"', "\\", ""),
    "boundary": _between("multipart/form-data; boundary=", "-", ""),
    "continued parameters": lambda size: "".join(f";a*{n}=b" for n in range(size))[:size],
    "spaces": _between("a", " ", "a"),
    "words": _repeated("a "),
    "addresses": _repeated("127.0.0.1, "),
    "hexadecimal address": _between("[", "f:", "]"),
    "ranges": _between("bytes=", "0-1,", "0-1"),
    "entity tags": _repeated('W/"a", '),
    "slashes": _repeated("/"),
    "colons": _repeated(":"),
    "dots": _repeated("."),
    "brackets": _repeated("["),
    "percents": _repeated("%25"),
    "labels": _between("xn--", "a.", "a"),
    "at signs": _repeated("@"),
    "cookies": _repeated("a=b; "),
    "other bytes": _repeated("\xff"),
}
"""By what they are, functions of their size."""


def cookies(port: int) -> Iterator[tuple[str, Callable[[int], str]]]:
    """Yield the worst `Cookie` headers by what they are: for each name that the app declares."""
    codes = ("".join(code) for code in itertools.product(ALPHABET, repeat=CODE_LENGTH))
    many_codes = list(itertools.islice(codes, HEAD_BYTES // 20))
    for name in NAMES:
        for prefix in ("", "__Host-"):
            cookie_name = f"{prefix}{name}_{port}"
            if name == ROOM_NAME:
                cookie_name = f"{cookie_name}_{many_codes[-1]}"
            yield f"{cookie_name} escaped", _between(f'{cookie_name}="', '\\"', '"')
            yield f"{cookie_name} many times", _repeated(f"{cookie_name}=x; ")
            yield f"{cookie_name} of great length", _between(f"{cookie_name}=", "x", "")
    rooms = "; ".join(f"{ROOM_NAME}_{port}_{code}=x" for code in many_codes)
    yield "cookies of many rooms", lambda size: rooms[:size]
    sessions = "; ".join(f"{NAME}_{number}=x" for number in range(HEAD_BYTES // 20))
    yield "sessions of many ports", lambda size: sessions[:size]


def headers(port: int) -> Iterator[tuple[str, str, Callable[[int], str]]]:
    """Yield name, what its value is and the value as a function of its size, of all headers."""
    for name in sorted(READ | READ_BEFORE | {"range", "forwarded", "x-unknown"}):
        for what, value in VALUES.items():
            yield name, what, value
    for what, value in cookies(port):
        yield "cookie", what, value


def addresses(path: str, parameters: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield what is bad, and the addresses of a path with parameters in braces, and a query."""
    pieces = path.replace("{", "}").split("}")
    for what, value in VALUES.items():
        worst = quote(value(ADMITTED_BYTES), safe="/:@,;=")[: ADMITTED_BYTES - len(path)]
        if len(pieces) > 1:
            filled = "".join(worst if n % 2 else piece for n, piece in enumerate(pieces[:2]))
            yield (
                f"{what} in the path",
                filled + "".join("x" if n % 2 else piece for n, piece in enumerate(pieces[2:])),
            )
        for name in parameters:
            yield f"{what} as {name}", f"{path}?{name}={worst}".replace("{", "").replace("}", "")
    bare = path.replace("{", "").replace("}", "")
    yield "a line below", f"{bare}{'/files' * (ADMITTED_BYTES // 6)}%0A"
    for name in (*parameters, "x", "token", "id"):
        query = f"{name}=a,&" * (ADMITTED_BYTES // (len(name) + 4))
        yield f"{name} many times", f"{bare}?{query}"
    yield "ampersands", f"{bare}?{'&' * ADMITTED_BYTES}"


def bodies(fields: tuple[str, ...]) -> Iterator[tuple[str, bytes]]:
    """Yield the worst bodies of a size, by what they are: JSON, and values of each field."""
    half = BODY_BYTES // 2
    worst: dict[str, str] = {
        "nested lists": "[" * half + "]" * half,
        "many members": "{" + ",".join(f'"k{n}":0' for n in range(BODY_BYTES // 12)) + "}",
        "many numbers": "[" + "0," * half + "0]",
        "many objects": "[" + "{}," * (BODY_BYTES // 3) + "{}]",
        "many lists": "[" + "[]," * (BODY_BYTES // 3) + "[]]",
        "many words": "[" + '"",' * (BODY_BYTES // 3) + '""]',
        "digits": "1" * BODY_BYTES,
        "a fraction": "0." + "1" * BODY_BYTES,
        "escapes": '"' + "\\u0061" * (BODY_BYTES // 6) + '"',
        "spaces": " " * BODY_BYTES,
    }
    for what, value in worst.items():
        yield what, value.encode()
        for field in fields:
            yield f"{what} as {field}", f'{{"{field}":{value}}}'.encode()


class Cost(NamedTuple):
    """Processor time and memory that a request took.

    Attributes:
        processor_s: time of the server's processor [s].
        status: of the answer; 0 if the server closed the connection without one.
    """

    processor_s: float
    status: int


class Strangers:
    """Clients of a server, each request from another address, so that no limit hides its cost."""

    def __init__(self, pid: int, port: int) -> None:
        """Prepare.

        Args:
            pid: id of the server's process.
            port: the server's port on loopback.
        """
        # Linux's clock of the processor time of a process (man clock_getcpuclockid).
        self._clock, self._port = ~pid << 3 | 2, port
        self._sources = (
            f"127.{a}.{b}.{c}"
            for a, b, c in itertools.product(range(1, 255), range(256), range(1, 255))
        )
        self.sent = 0

    def cost(self, request: bytes, limit_s: float) -> Cost:
        """Send a request and return what it cost; beyond a limit the least of three times.

        What else the server does meanwhile counts too, so that once may be too much by chance.
        """
        costs: list[Cost] = []
        while len(costs) < 3 and not (costs and min(costs).processor_s <= limit_s):
            costs.append(self._send(request))
        return min(costs)

    def _send(self, request: bytes) -> Cost:
        self.sent += 1
        before_s = time.clock_gettime(self._clock)
        status = self._answer_of(request)
        return Cost(time.clock_gettime(self._clock) - before_s, status)

    def _answer_of(self, request: bytes) -> int:
        source = (next(self._sources), 0)
        answer = b""
        try:
            with socket.create_connection(("127.0.0.1", self._port), _PATIENCE_S, source) as sock:
                sock.sendall(request)
                while len(answer) < 1 << 16 and (chunk := sock.recv(1 << 16)):
                    answer += chunk
                    if _is_whole(answer, has_body=not request.startswith(b"HEAD ")):
                        break
        except (ConnectionResetError, BrokenPipeError):
            pass  # the server did not read it to its end
        return int(answer.split()[1]) if answer else 0


def _is_whole(answer: bytes, *, has_body: bool) -> bool:
    """Whether nothing follows that is to be waited for: an endless stream has no end."""
    head, separator, body = answer.partition(b"\r\n\r\n")
    if not separator or not has_body:
        return bool(separator)
    length = re.search(rb"\r\ncontent-length: (\d+)", head.lower())
    if length is not None:
        return len(body) >= int(length[1])
    return b"text/event-stream" in head


def request(
    method: str, target: str, port: int, header_lines: Mapping[str, str], body: bytes = b""
) -> bytes:
    """Return the bytes of a request."""
    lines: dict[str, str] = {"host": f"127.0.0.1:{port}", "connection": "close"}
    if method not in ("GET", "HEAD", "OPTIONS"):
        lines["content-length"] = str(len(body))
    lines |= header_lines
    head = f"{method} {target} HTTP/1.1\r\n"
    head += "".join(f"{name}: {value}\r\n" for name, value in lines.items())
    return head.encode("latin-1") + b"\r\n" + body


def worst_framings(port: int) -> Iterator[tuple[str, bytes]]:
    """Yield heads and bodies that are long by their lines, not by one of them."""
    first = f"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n"
    for what, line in {
        "many headers": "a:b\r\n",
        "many cookies": "cookie: a=b\r\n",
        "many lengths": "content-length: 1\r\n",
        "many forwarded": "x-forwarded-for: 127.0.0.1\r\n",
        "many upgrades": "upgrade: a\r\n",
        "folded lines": " a\r\n",
        "lines without colon": "a\r\n",
    }.items():
        yield what, (first + f"x: y\r\n{_repeated(line)(HEAD_BYTES)}\r\n\r\n").encode()
    post = "POST /api/v1/what-if HTTP/1.1\r\nTransfer-Encoding: chunked\r\n"
    post += f"Host: 127.0.0.1:{port}\r\nContent-Type: application/json\r\nConnection: close\r\n\r\n"
    yield "small chunks", (post + "1\r\n1\r\n" * (BODY_BYTES // 6) + "0\r\n\r\n").encode()
    trailers = "a:b\r\n" * (HEAD_BYTES // 5)
    yield "trailers", f"{post}1\r\n1\r\n0\r\n{trailers}\r\n".encode()
    yield "a long chunk size", (post + "1;" + "a" * HEAD_BYTES + "\r\n").encode()
    yield "empty lines", b"\r\n" * (HEAD_BYTES // 2) + first.encode() + b"\r\n"
    again = f"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n"
    # Requests that wait behind the first; each of them counts on its own.
    big = f"GET /healthz HTTP/1.1\r\nHost: a\r\n{'a:b' * 20_000}\r\n\r\n"
    yield "a large one behind another", (again + big).encode()


def fields_of(document: Mapping[str, Any], method: str, path: str) -> tuple[str, ...]:
    """Return the names of the members of a route's JSON body, by the server's description."""
    operation = document["paths"].get(path, {}).get(method.lower(), {})
    content = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
    return tuple(sorted(set(_members(document, content.get("schema", {})))))


def _members(document: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[str]:
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        yield from _members(document, document["components"]["schemas"][name])
    yield from schema.get("properties", {})
    for option in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ())):
        yield from _members(document, option)
