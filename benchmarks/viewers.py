"""Load by viewers: `python benchmarks/viewers.py http://127.0.0.1:8000 --viewers 200`.

Opens viewers of a server that runs on this machine, counts what they get for some seconds, times
`GET /healthz` meanwhile, prints one JSON object, and ends. Something must move on stage, or there
are no frames to count: start a race or a training first.

What is promised: 200 viewers get 20 frames/s or more in the median, the API's 95th percentile
stays under 250 ms, and 20 who do not read cost the others less than 5 % of their frames.

With `--replays 20` so many more play a run of the server by themselves, each from a time of its
own, as the page does: twice as fast as real time, the next segment requested in the middle of one.
"""

import argparse
import asyncio
import gzip
import http.client
import json
import socket
import statistics
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import AsyncExitStack
from dataclasses import dataclass
from urllib.parse import urlsplit

import viser
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

_LOOPBACK = ("127.0.0.1", "localhost")
_OPENING_AT_ONCE = 20
_SMALL_BUFFER_BYTES = 4096
_API_PAUSE_S = 0.05
_REPLAY_LEVEL, _REPLAY_SPEED = 1, 2.0
_PICTURES_PER_S = 30.0


@dataclass
class Tally:
    """Frames and bytes that one viewer got."""

    frames: int = 0
    size_bytes: int = 0
    lost: bool = False


async def measure(host: str, port: int, options: argparse.Namespace) -> dict[str, float]:
    """Watch for `options.seconds`, with `options.viewers` and `options.stalled` viewers."""
    url = f"ws://{host}:{port}/viewer/?view={options.view}"
    async with AsyncExitStack() as stack:
        gate = asyncio.Semaphore(_OPENING_AT_ONCE)

        async def open_one(buffer_bytes: int | None) -> ClientConnection:
            async with gate:
                return await stack.enter_async_context(_viewer(url, host, port, buffer_bytes))

        stalled = await asyncio.gather(
            *(open_one(_SMALL_BUFFER_BYTES) for _ in range(options.stalled))
        )
        viewers = await asyncio.gather(*(open_one(None) for _ in range(options.viewers)))
        # The whole scene, which a newcomer gets first, is not the stream's rate.
        await asyncio.gather(*(viewer.recv(decode=False) for viewer in viewers))
        tallies = [Tally() for _ in viewers]
        replays = [Replay(number) for number in range(options.replays)]
        began_s = time.perf_counter()
        until_s = began_s + options.seconds
        # As many as there are; the loop's own pool has only a few.
        with ThreadPoolExecutor(len(replays) or 1) as pool:
            playing = [pool.submit(replay.play, host, port, until_s) for replay in replays]
            _, latencies_s = await asyncio.gather(
                asyncio.gather(*map(_watch, viewers, tallies, [until_s] * len(viewers))),
                asyncio.to_thread(_ask, host, port, until_s),
            )
            await asyncio.gather(*map(asyncio.wrap_future, playing))
        took_s = time.perf_counter() - began_s
        for viewer in (*viewers, *stalled):
            # No farewells: hundreds of them would take longer than the measurement.
            viewer.transport.abort()
    return {**_report(tallies, latencies_s, took_s), **_replay_report(replays)}


class Replay:
    """A page that plays a run by itself, by its number, which decides the run and the time."""

    def __init__(self, number: int) -> None:
        self._number = number
        self.pictures = 0
        self.played_s = 0.0
        self.waits_s: list[float] = []
        """Times from the request of each segment until it could be drawn [s]."""

    def play(self, host: str, port: int, until_s: float) -> None:
        """Play until a time of `time.perf_counter`; run it in a thread."""
        connection = http.client.HTTPConnection(host, port, timeout=30)
        runs = json.loads(_get(connection, "/api/v1/races?state=finished"))["items"]
        path = f"/api/v1/runs/{runs[self._number % len(runs)]['id']}/replay"
        plan = json.loads(_get(connection, path))
        _get(connection, f"{path}/scene")
        segment_s = plan["segment_frames"] * plan["frame_s"] * 2**_REPLAY_LEVEL / _REPLAY_SPEED
        last = int(plan["recorded_s"][-1][1] / _REPLAY_SPEED / segment_s)
        began_s = due_s = time.perf_counter()
        number = self._number
        while due_s < until_s:
            requested_s = time.perf_counter()
            frames = _get(connection, f"{path}/segments/{_REPLAY_LEVEL}/{number % last}")
            gzip.decompress(frames)
            arrived_s = time.perf_counter()
            self.waits_s.append(arrived_s - requested_s)
            if len(self.waits_s) == 1:
                began_s = arrived_s
            # A late segment is waited for; playback goes on from there.
            due_s = max(due_s, arrived_s)
            self.pictures += min(plan["segment_frames"], round((until_s - due_s) * _PICTURES_PER_S))
            due_s += segment_s
            time.sleep(max(0.0, min(due_s - segment_s / 2, until_s) - time.perf_counter()))
            number += 1
        self.played_s = until_s - began_s
        connection.close()


def _get(connection: http.client.HTTPConnection, path: str) -> bytes:
    connection.request("GET", path, headers={"Accept-Encoding": "gzip"})
    response = connection.getresponse()
    content = response.read()
    if response.status != http.client.OK:
        raise RuntimeError(f"{path}: {response.status} {content[:200]!r}")
    is_frames = response.headers.get("Content-Encoding") == "gzip" and "segments" not in path
    return gzip.decompress(content) if is_frames else content


def _replay_report(replays: list[Replay]) -> dict[str, float]:
    if not replays:
        return {}
    rates = [replay.pictures / replay.played_s for replay in replays]
    waits_s = [wait_s for replay in replays for wait_s in replay.waits_s]
    return {
        "replays": len(replays),
        "pictures_per_s_median": round(statistics.median(rates), 2),
        "pictures_per_s_lowest": round(min(rates), 2),
        "segments": len(waits_s),
        "segment_p95_ms": round(statistics.quantiles(waits_s, n=20)[-1] * 1e3, 1),
    }


def _viewer(url: str, host: str, port: int, buffer_bytes: int | None) -> connect:
    sock = socket.socket()
    if buffer_bytes is not None:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_bytes)
    sock.connect((host, port))
    sock.setblocking(False)
    return connect(
        url,
        sock=sock,
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        compression=None,
        max_size=None,
        max_queue=1 if buffer_bytes is not None else 16,
        ping_interval=None,
        close_timeout=1,
        proxy=None,
    )


async def _watch(viewer: ClientConnection, tally: Tally, until_s: float) -> None:
    try:
        async with asyncio.timeout(until_s - time.perf_counter()):
            while True:
                tally.size_bytes += len(await viewer.recv(decode=False))
                tally.frames += 1
    except TimeoutError:
        return
    except ConnectionClosed:
        tally.lost = True


def _ask(host: str, port: int, until_s: float) -> list[float]:
    """Time the API, by one request after another [s]."""
    connection = http.client.HTTPConnection(host, port, timeout=10)
    latencies_s = []
    while time.perf_counter() < until_s:
        began_s = time.perf_counter()
        connection.request("GET", "/healthz")
        connection.getresponse().read()
        latencies_s.append(time.perf_counter() - began_s)
        time.sleep(_API_PAUSE_S)
    connection.close()
    return latencies_s


def _report(tallies: list[Tally], latencies_s: list[float], took_s: float) -> dict[str, float]:
    rates = [tally.frames / took_s for tally in tallies]
    return {
        "viewers": len(tallies),
        "seconds": round(took_s, 1),
        "frames_per_s_median": round(statistics.median(rates), 2),
        "frames_per_s_highest": round(max(rates), 2),
        "frames_per_s_lowest": round(min(rates), 2),
        "bytes_per_s_total": round(sum(tally.size_bytes for tally in tallies) / took_s),
        "viewers_lost": sum(tally.lost for tally in tallies),
        "healthz_requests": len(latencies_s),
        "healthz_p95_ms": round(statistics.quantiles(latencies_s, n=20)[-1] * 1e3, 1),
    }


def main() -> None:
    """Measure, print, end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("address", help="of the server, such as http://127.0.0.1:8000")
    parser.add_argument("--viewers", type=int, default=200)
    parser.add_argument("--stalled", type=int, default=0, help="further ones that never read")
    parser.add_argument("--replays", type=int, default=0, help="further ones with an own replay")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--view", default="leader", help="leader, 1 to 8, or free")
    options = parser.parse_args()
    address = urlsplit(options.address)
    if address.scheme != "http" or address.hostname not in _LOOPBACK:
        parser.error(f"only a server on this machine is measured: http://{_LOOPBACK[0]}:PORT")
    report = asyncio.run(measure(address.hostname, address.port or 80, options))
    sys.stdout.write(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
