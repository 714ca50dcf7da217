"""Load by viewers: `python benchmarks/viewers.py http://127.0.0.1:8000 --viewers 200`.

Opens pages' streams of events with the picture of the stage, on this machine, reads them for some
seconds, times `GET /healthz` meanwhile, prints one JSON object, and ends. Something must move on
stage, or there are no pieces to count: start a race or a training first.

A *gap* is a time in which a viewer has no frame for the moment that the playhead shows; `gap_share`
is the sum of all gaps over the time watched by all viewers. `late_p95_ms` is how long after it was
sent a piece had arrived.

With `--stalled 20` so many more never read. With `--fetching 1000` so many more get no pieces by
their streams, as behind a proxy that holds them back: they fetch each segment, from `--from` if
that is given, such as a proxy that caches.
"""

import argparse
import asyncio
import bisect
import http.client
import itertools
import json
import resource
import socket
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, cast
from urllib.parse import urlsplit

import psutil

_LOOPBACK = ("127.0.0.1", "localhost")
_OPENING_AT_ONCE = 50
_SMALL_BUFFER_BYTES = 4096
_API_PAUSE_S = 0.25
_FETCHED_AHEAD_S = 1.0
_HEAD = b"GET %s HTTP/1.1\r\nHost: %s\r\nAccept-Encoding: gzip\r\n\r\n"


@dataclass
class Piece:
    """What the benchmark knows of a piece of the picture, by its JSON without the data."""

    begin_s: float
    end_s: float
    sent_s: float
    playhead: dict[str, Any]


class Pieces:
    """The pieces of all viewers: each is decoded once."""

    def __init__(self) -> None:
        self._by_id: dict[bytes, Piece | None] = {}

    def of(self, event: bytes) -> Piece | None:
        """Return the piece of an event; None of other events."""
        if not event.startswith(b"event: piece"):
            return None
        number = event[event.rindex(b"\nid: ") :]
        if number not in self._by_id:
            begin = event.index(b"data: ") + 6
            body = json.loads(event[begin : event.index(b"\n", begin)])
            self._by_id[number] = _piece(body)
        return self._by_id[number]


def _piece(body: dict[str, Any]) -> Piece:
    if body["level"] is None:
        begin_s = end_s = body["time_s"]
    else:
        step_s = 2.0 ** body["level"] / 30
        begin_s = body["first"] * step_s
        end_s = begin_s + body["count"] * step_s
    return Piece(begin_s, end_s, body["sent_s"], body["playhead"])


def time_at(playhead: dict[str, Any], now_s: float) -> float:
    """Return the time of the run that a playhead shows at a time of the server's clock [s]."""
    points: list[tuple[float, float]] = playhead["points"]
    after_s: float = now_s - playhead["at_s"]
    index = bisect.bisect_right(points, after_s, key=lambda point: point[0])
    if index == 0:
        return float(points[0][1])
    begin_s, time_s = points[index - 1]
    if index == len(points):
        return time_s + float(playhead["rate"]) * (after_s - begin_s)
    end_s, later_s = points[index]
    return float(time_s + (later_s - time_s) * (after_s - begin_s) / (end_s - begin_s))


class Viewer(asyncio.Protocol):
    """A page that watches: it reads its stream, and notes the gaps in its picture."""

    def __init__(self, path: str, host: str, pieces: Pieces) -> None:
        self._request = _HEAD % (path.encode(), host.encode())
        self._pieces = pieces
        self._rest = b""
        self._has_s: list[tuple[float, float]] = []
        self._playhead: dict[str, Any] | None = None
        self.size_bytes = 0
        self.events = 0
        self.delays_s: list[float] = []
        self.gaps_s = 0.0
        self.is_lost = False
        self.transport: asyncio.Transport | None = None
        self.opened = asyncio.get_running_loop().create_future()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Send the request."""
        self.transport = cast("asyncio.Transport", transport)
        self.transport.write(self._request)

    def data_received(self, data: bytes) -> None:
        """Take in events."""
        now_s = time.monotonic()
        self.size_bytes += len(data)
        *events, self._rest = (self._rest + data).split(b"\n\n")
        for event in events:
            if b"event: snapshot" in event and not self.opened.done():
                self.opened.set_result(None)
            # A chunk of the transfer encoding may begin before an event.
            begin = event.find(b"event: ")
            piece = self._pieces.of(event[begin:]) if begin >= 0 else None
            self.events += 1
            if piece is not None:
                self._take(piece, now_s)

    def _take(self, piece: Piece, now_s: float) -> None:
        self.delays_s.append(now_s - piece.sent_s)
        self._playhead = piece.playhead
        shown_s = time_at(piece.playhead, now_s)
        has = any(begin_s <= shown_s <= end_s for begin_s, end_s in self._has_s)
        if self._has_s and not has and piece.end_s > piece.begin_s:
            # It was missed since the frames before it had been shown.
            last_s = max((end_s for _, end_s in self._has_s if end_s <= shown_s), default=shown_s)
            rate = max(1.0, piece.playhead["rate"])
            self.gaps_s += (shown_s - last_s) / rate if shown_s - last_s < 60 else 0.0
        self._has_s = [*self._has_s[-8:], (piece.begin_s, piece.end_s)]

    def connection_lost(self, error: Exception | None) -> None:
        """Note that the stream has ended."""
        self.is_lost = True
        if not self.opened.done():
            self.opened.set_exception(error or ConnectionError("the stream ended at once"))


@dataclass
class Fetching:
    """A page that fetches the segments of the run on stage one by one."""

    number: int
    requests: int = 0
    size_bytes: int = 0
    waits_s: list[float] = field(default_factory=list)
    failures: int = 0

    async def play(self, host: str, port: int, stage: dict[str, Any], until_s: float) -> None:
        """Fetch what the playhead comes to until a time of the clock, and read it."""
        rate = max(stage["playhead"]["rate"], 1.0)
        level = 1 if rate >= 1.5 else 0
        segment_s = 64 * 2.0**level / 30
        last = max(1, int(stage["playhead"]["computed_s"] / segment_s))
        reader, writer = await asyncio.open_connection(host, port)
        due_s = time.monotonic() + (self.number % 100) / 100 * segment_s / rate
        step = 0
        while due_s < until_s:
            await asyncio.sleep(max(0.0, due_s - time.monotonic()))
            path = (
                f"/api/v1/runs/{stage['run_id']}/replay/segments/{level}/{step % last}"
                f"?clock={stage['clock']}&version={stage['version']}"
            )
            began_s = time.monotonic()
            writer.write(_HEAD % (path.encode(), host.encode()))
            head = (await reader.readuntil(b"\r\n\r\n")).lower()
            length = int(head.split(b"content-length: ")[1].split(b"\r\n")[0])
            await reader.readexactly(length)
            self.failures += not head.startswith(b"http/1.1 200")
            self.waits_s.append(time.monotonic() - began_s)
            self.size_bytes += len(head) + length
            self.requests += 1
            step += 1
            due_s = max(due_s + segment_s / rate, time.monotonic() - _FETCHED_AHEAD_S)
        writer.close()


async def measure(host: str, port: int, options: argparse.Namespace) -> dict[str, Any]:
    """Watch for `options.seconds`."""
    server = psutil.Process(options.pid or _listener_of(port))
    loop, pieces = asyncio.get_running_loop(), Pieces()
    gate, addresses = asyncio.Semaphore(_OPENING_AT_ONCE), itertools.cycle(range(2, 52))

    async def open_viewer(buffer_bytes: int | None, path: str) -> Viewer:
        async with gate:
            sock = socket.socket()
            if buffer_bytes is not None:
                sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_bytes)
            # Clients at other addresses, as an address has a limit of connections.
            sock.bind((f"127.0.0.{next(addresses)}", 0))
            sock.setblocking(False)
            await loop.sock_connect(sock, (host, port))
            _, viewer = await loop.create_connection(lambda: Viewer(path, host, pieces), sock=sock)
            await viewer.opened
            return viewer

    path = "/api/v1/events?picture=true"
    stalled = await asyncio.gather(
        *(open_viewer(_SMALL_BUFFER_BYTES, path) for _ in range(options.stalled))
    )
    for viewer in stalled:
        if viewer.transport is not None:
            viewer.transport.pause_reading()
    viewers = await asyncio.gather(*(open_viewer(None, path) for _ in range(options.viewers)))
    stage = json.loads(_get(host, port, "/api/v1/stage"))
    await asyncio.sleep(2.0)
    for viewer in viewers:
        viewer.size_bytes = viewer.events = 0
        viewer.delays_s, viewer.gaps_s = [], 0.0
    fetching = [Fetching(number) for number in range(options.fetching)]
    source = urlsplit(getattr(options, "from") or f"http://{host}:{port}")
    until_s = time.monotonic() + options.seconds
    before, began_s = sum(server.cpu_times()[:2]), time.monotonic()
    asking = asyncio.create_task(asyncio.to_thread(_ask, host, port, until_s))
    playing = [
        page.play(source.hostname or host, source.port or 80, stage, until_s) for page in fetching
    ]
    await asyncio.gather(asking, asyncio.sleep(options.seconds), *playing)
    took_s = time.monotonic() - began_s
    share = (sum(server.cpu_times()[:2]) - before) / took_s
    report = _report(viewers, asking.result(), took_s)
    report["share_of_a_core"] = round(share, 4)
    report["memory_mb"] = round(server.memory_info().rss / 1e6)
    for viewer in (*viewers, *stalled):
        if viewer.transport is not None:
            viewer.transport.abort()
    return {**report, **_fetching_report(fetching, took_s)}


def _listener_of(port: int) -> int:
    for connection in psutil.net_connections("tcp"):
        at: Any = connection.laddr
        if connection.status == psutil.CONN_LISTEN and at.port == port and connection.pid:
            return connection.pid
    raise SystemExit(f"no process listens on port {port}; name it with --pid")


def _get(host: str, port: int, path: str) -> bytes:
    connection = http.client.HTTPConnection(host, port, timeout=30)
    connection.request("GET", path)
    content = connection.getresponse().read()
    connection.close()
    return content


def _ask(host: str, port: int, until_s: float) -> list[float]:
    """Time the API, by one request after another [s]."""
    connection = http.client.HTTPConnection(host, port, timeout=10)
    latencies_s = []
    while time.monotonic() < until_s:
        began_s = time.perf_counter()
        connection.request("GET", "/healthz")
        connection.getresponse().read()
        latencies_s.append(time.perf_counter() - began_s)
        time.sleep(_API_PAUSE_S)
    connection.close()
    return latencies_s


def _p95_ms(times_s: Sequence[float]) -> float | None:
    if len(times_s) < 2:
        return None
    return round(statistics.quantiles(times_s, n=20)[-1] * 1e3, 1)


def _report(viewers: list[Viewer], latencies_s: list[float], took_s: float) -> dict[str, Any]:
    delays_s = [delay_s for viewer in viewers for delay_s in viewer.delays_s]
    watched_s = max(1, len(viewers)) * took_s
    pieces = [len(viewer.delays_s) for viewer in viewers] or [0]
    return {
        "viewers": len(viewers),
        "seconds": round(took_s, 1),
        "pieces_median": statistics.median(pieces),
        "pieces_lowest": min(pieces),
        "bytes_per_s_each": round(sum(viewer.size_bytes for viewer in viewers) / watched_s),
        "viewers_lost": sum(viewer.is_lost for viewer in viewers),
        "gap_share": round(sum(viewer.gaps_s for viewer in viewers) / watched_s, 5),
        "late_p95_ms": _p95_ms(delays_s),
        "healthz_requests": len(latencies_s),
        "healthz_p95_ms": _p95_ms(latencies_s),
    }


def _fetching_report(fetching: list[Fetching], took_s: float) -> dict[str, Any]:
    if not fetching:
        return {}
    return {
        "fetching": len(fetching),
        "requests": sum(page.requests for page in fetching),
        "fetch_failures": sum(page.failures for page in fetching),
        "fetch_p95_ms": _p95_ms([wait_s for page in fetching for wait_s in page.waits_s]),
        "fetched_bytes_per_s_each": round(
            sum(page.size_bytes for page in fetching) / len(fetching) / took_s
        ),
    }


def main() -> None:
    """Measure, print, end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("address", help="of the server, such as http://127.0.0.1:8000")
    parser.add_argument("--viewers", type=int, default=200)
    parser.add_argument("--stalled", type=int, default=0, help="further ones that never read")
    parser.add_argument("--fetching", type=int, default=0, help="further ones that fetch segments")
    parser.add_argument("--from", help="address from which those fetch, by default the server's")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--pid", type=int, help="of the server, if it cannot be found by its port")
    options = parser.parse_args()
    address = urlsplit(options.address)
    if address.scheme != "http" or address.hostname not in _LOOPBACK:
        parser.error(f"only a server on this machine is measured: http://{_LOOPBACK[0]}:PORT")
    limit = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (limit, limit))
    report = asyncio.run(measure(address.hostname, address.port or 80, options))
    sys.stdout.write(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
