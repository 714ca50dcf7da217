"""A hub on a real server, and real clients to it, all on loopback."""

import asyncio
import socket
import threading
import time
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Coroutine, Iterator, Sequence
from contextlib import aclosing, asynccontextmanager, contextmanager
from typing import Any, TypeVar

import numpy as np
import uvicorn
import viser
from numpy.typing import NDArray
from starlette.applications import Starlette
from starlette.routing import BaseRoute
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.server import GRACE_S
from app.viewer import wire
from app.viewer.hub import Hub
from app.viewer.in_process import InProcessViser
from app.viewer.protocol import websocket_options
from app.viewer.service import viewer_routes

T = TypeVar("T")

PATIENCE_S = 30.0
"""No test depends on how long anything takes; this only ends one that would hang."""


def start_viser() -> InProcessViser:
    """viser, drawing everything under the frame that followers move."""
    stage = InProcessViser()
    stage.scene.add_frame("/world", show_axes=False)
    return stage


class Upstream:
    """viser's stream to the hub, which can be lost, and is found again."""

    def __init__(self, stage: InProcessViser) -> None:
        self._stage, self._is_lost = stage, False

    async def frames(self) -> AsyncGenerator[bytes, None]:
        async with aclosing(self._stage.frames()) as frames:
            async for frame in frames:
                if self._is_lost:
                    self._is_lost = False
                    raise ConnectionError("lost by the test")
                yield frame

    def lose(self) -> None:
        self._is_lost = True
        self._stage.scene.add_frame("/lost", show_axes=False)


class Robots:
    """A batch of boxes that stand where they are told, like the stage's robots."""

    NAME = "/world/robots"

    def __init__(self, stage: viser.ViserServer, count: int = 4) -> None:
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32)
        self._stage = stage
        self._shape = (count, 3)
        self._handle = stage.scene.add_batched_meshes_simple(
            self.NAME,
            corners,
            faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            batched_positions=np.zeros(self._shape, np.float32),
        )

    def stand_at(self, place: float) -> None:
        """All of them, on the diagonal; sent at once."""
        with self._stage.atomic():
            self._handle.batched_positions = np.full(self._shape, place, np.float32)
        self._stage.flush()


def eventually(holds: Callable[[], object]) -> None:
    """Wait until it holds.

    Raises:
        TimeoutError: It never did.
    """
    end = time.monotonic() + PATIENCE_S
    while not holds():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.005)


class Address:
    """Where a hub is served, and who it is."""

    def __init__(self, hub: Hub, port: int) -> None:
        self.hub = hub
        self.port = port
        self.host = f"127.0.0.1:{port}"
        self.page = f"http://{self.host}/viewer/"

    def watch(self, view: str | None = None, **options: Any) -> "Viewer":
        """A browser's socket, without the browser."""
        query = "" if view is None else f"?view={view}"
        return Viewer(f"ws://{self.host}/viewer/{query}", **options)

    def watch_slowly(self, view: str | None = None) -> "Viewer":
        """One that reads no further than its few and small buffers hold, until it is asked to."""
        sock = socket.socket()
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        sock.connect(("127.0.0.1", self.port))
        return self.watch(view, sock=sock, max_queue=1, ping_interval=None, close_timeout=0.1)


class Reader:
    """Reads viser's own stream, as the hub does, from a thread that has no loop."""

    def __init__(self, stage: InProcessViser) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._frames = stage.frames()

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_: object) -> None:
        self._wait(self._frames.aclose())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def frame(self) -> wire.Frame:
        """The next frame.

        Raises:
            ConnectionError: There is none any more.
        """
        return wire.parse(self._wait(self._next()))

    def frames_until(self, is_last: Callable[[wire.Frame], object]) -> list[wire.Frame]:
        """The next frames, up to the first one that is the last."""
        frames = [self.frame()]
        while not is_last(frames[-1]):
            frames.append(self.frame())
        return frames

    async def _next(self) -> bytes:
        return await anext(self._frames)

    def _wait(self, work: Coroutine[Any, Any, T]) -> T:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(PATIENCE_S)


class Viewer:
    """A raw client that decodes what it gets."""

    def __init__(self, url: str, protocol: str = wire.SUBPROTOCOL, **options: Any) -> None:
        self.socket: ClientConnection = connect(
            url,
            subprotocols=[Subprotocol(protocol)],
            compression=None,
            max_size=None,
            proxy=None,
            **options,
        )

    def __enter__(self) -> "Viewer":
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def frame(self) -> wire.Frame:
        """The next frame.

        Raises:
            websockets.exceptions.ConnectionClosed: There is none any more.
        """
        return wire.parse(self.socket.recv(PATIENCE_S, decode=False))

    def frames_until(self, is_last: Callable[[wire.Frame], object]) -> list[wire.Frame]:
        """The next frames, up to the first one that is the last."""
        frames = [self.frame()]
        while not is_last(frames[-1]):
            frames.append(self.frame())
        return frames


@contextmanager
def serving(hub: Hub, *, more_routes: Sequence[BaseRoute] = (), **config: Any) -> Iterator[Address]:
    """Serve the hub by uvicorn in a thread, as the app does."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        async with hub:
            yield

    app = Starlette(routes=[*viewer_routes(hub), *more_routes], lifespan=lifespan)
    # A client that was stopped in a closing handshake must not keep the server up.
    options = {
        **websocket_options(),
        "log_level": "warning",
        "timeout_graceful_shutdown": GRACE_S,
        **config,
    }
    server = uvicorn.Server(uvicorn.Config(app, host="127.0.0.1", port=0, **options))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        eventually(lambda: server.started)
        yield Address(hub, server.servers[0].sockets[0].getsockname()[1])
    finally:
        server.should_exit = True
        thread.join(PATIENCE_S)
        assert not thread.is_alive(), "the server hangs at shutdown"


def says(type_: str, **fields: object) -> Callable[[wire.Frame], bool]:
    """Whether a frame has a message of that type, with those fields."""

    def holds(frame: wire.Frame) -> bool:
        return any(
            message["type"] == type_ and fields.items() <= message.items()
            for message in frame.messages
        )

    return holds


def array(frame: wire.Frame, name: str, field: str) -> NDArray[np.float32] | None:
    """The newest value of a node's property in a frame; None if it says nothing of it."""
    value = None
    for message in frame.messages:
        if message.get("name") == name:
            properties = message.get("updates") or message.get("props") or {}
            value = properties.get(field, value)
    if value is None:
        return None
    return np.frombuffer(frame.buffers[value["__binary_index"]], value["dtype"])
