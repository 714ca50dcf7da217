"""Test set-up: a hub on a real uvicorn server, and websocket clients, all on loopback."""

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
from app.viewer.hub import Hub
from app.viewer.session import websocket_options
from app.viewer.viewer_page import viewer_routes
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser

T = TypeVar("T")

PATIENCE_S = 30.0
"""Timeout of waits; only ends a test that would hang."""


def start_viser() -> InProcessViser:
    """Start an in-process viser with the root node that the follow camera translates."""
    viser_server = InProcessViser()
    viser_server.scene.add_frame("/world", show_axes=False)
    return viser_server


class Upstream:
    """viser's stream to the hub, with connection loss on demand."""

    def __init__(self, viser_server: InProcessViser) -> None:
        self._viser_server, self._lose_next = viser_server, False

    async def frames(self) -> AsyncGenerator[bytes, None]:
        async with aclosing(self._viser_server.frames()) as frames:
            async for frame in frames:
                if self._lose_next:
                    self._lose_next = False
                    raise ConnectionError("lost by the test")
                yield frame

    def lose(self) -> None:
        self._lose_next = True
        self._viser_server.scene.add_frame("/lost", show_axes=False)


class Robots:
    """A batched mesh that is moved like the stage's robots."""

    NAME = "/world/robots"

    def __init__(self, viser_server: viser.ViserServer, count: int = 4) -> None:
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32)
        self._viser_server = viser_server
        self._shape = (count, 3)
        self._handle = viser_server.scene.add_batched_meshes_simple(
            self.NAME,
            corners,
            faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            batched_positions=np.zeros(self._shape, np.float32),
        )

    def move_to(self, place: float) -> None:
        """Set all positions to (place, place, place) and flush."""
        with self._viser_server.atomic():
            self._handle.batched_positions = np.full(self._shape, place, np.float32)
        self._viser_server.flush()


def wait_until(predicate: Callable[[], object]) -> None:
    """Poll until a predicate is true.

    Raises:
        TimeoutError: It did not become true in time.
    """
    end = time.monotonic() + PATIENCE_S
    while not predicate():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.02)


class ServedHub:
    """A served hub with its address."""

    def __init__(self, hub: Hub, port: int) -> None:
        self.hub = hub
        self.port = port
        self.host = f"127.0.0.1:{port}"
        self.page = f"http://{self.host}/viewer/"

    def watch(self, view: str | None = None, **options: Any) -> "Viewer":
        """Connect a websocket as a browser does."""
        query = "" if view is None else f"?view={view}"
        return Viewer(f"ws://{self.host}/viewer/{query}", **options)

    def watch_slowly(self, view: str | None = None) -> "Viewer":
        """Connect a slow viewer, which reads only into small buffers until `frame` is called."""
        sock = socket.socket()
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        sock.connect(("127.0.0.1", self.port))
        return self.watch(view, sock=sock, max_queue=1, ping_interval=None, close_timeout=0.1)


class Reader:
    """Synchronous reader of viser's stream; runs the hub's asynchronous reader in a thread."""

    def __init__(self, viser_server: InProcessViser) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._frames = viser_server.frames()

    def __enter__(self) -> "Reader":
        return self

    def __exit__(self, *_: object) -> None:
        self._wait(self._frames.aclose())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def frame(self) -> stream.Frame:
        """Return the next frame.

        Raises:
            ConnectionError: viser has stopped.
        """
        return stream.parse(self._wait(self._next()))

    def frames_until(self, is_last: Callable[[stream.Frame], object]) -> list[stream.Frame]:
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
    """A raw websocket client that decodes frames."""

    def __init__(self, url: str, protocol: str = stream.SUBPROTOCOL, **options: Any) -> None:
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

    def frame(self) -> stream.Frame:
        """Return the next frame.

        Raises:
            websockets.exceptions.ConnectionClosed: The connection was closed.
        """
        return stream.parse(self.socket.recv(PATIENCE_S, decode=False))

    def frames_until(self, is_last: Callable[[stream.Frame], object]) -> list[stream.Frame]:
        """The next frames, up to the first one that is the last."""
        frames = [self.frame()]
        while not is_last(frames[-1]):
            frames.append(self.frame())
        return frames


@contextmanager
def serving(
    hub: Hub, *, more_routes: Sequence[BaseRoute] = (), **config: Any
) -> Iterator[ServedHub]:
    """Serve the hub as `running` does."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        hub.start()
        yield
        await hub.stop()

    app = Starlette(routes=[*viewer_routes(hub.serve), *more_routes], lifespan=lifespan)
    with running(app, **config) as port:
        yield ServedHub(hub, port)


@contextmanager
def running(app: Starlette, **config: Any) -> Iterator[int]:
    """Serve an app by uvicorn in a thread, with the server's options; yield its port."""
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
        wait_until(lambda: server.started)
        yield server.servers[0].sockets[0].getsockname()[1]
    finally:
        server.should_exit = True
        thread.join(PATIENCE_S)
        assert not thread.is_alive(), "the server hangs at shutdown"


def has_message(type_: str, **fields: object) -> Callable[[stream.Frame], bool]:
    """Return a predicate: whether a frame has a message of this type with these fields."""

    def predicate(frame: stream.Frame) -> bool:
        return any(
            message["type"] == type_ and fields.items() <= message.items()
            for message in frame.messages
        )

    return predicate


def array(frame: stream.Frame, name: str, field: str) -> NDArray[np.float32] | None:
    """Return the newest value of a node's array property in a frame, None if there is none."""
    value = None
    for message in frame.messages:
        if message.get("name") == name:
            properties = message.get("updates") or message.get("props") or {}
            value = properties.get(field, value)
    if value is None:
        return None
    return np.frombuffer(frame.buffers[value["__binary_index"]], value["dtype"])
