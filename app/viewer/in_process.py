"""A viser server without a listener: its stream is read within the process, and nothing is heard.

viser 1.1.1 listens on a TCP port that asks for no credentials, and one of the messages that it
takes there (`ShareUrlRequest`) starts a process that opens a public tunnel. So this server binds no
socket: it keeps viser's message buffer, its thread and its encoder, and hands the encoded windows
to the one reader in this process, the hub. No message ever reaches viser from outside.

What this module relies on inside viser, all of it checked by `tests/viewer/test_in_process.py`:

- `viser.ViserServer.__init__` makes its server by `viser._viser.infra.WebsockServer(...)`, which
  starts a thread on `_background_worker(ready)`; that worker makes `_background_event_loop`,
  `_stop_event` and `_broadcast_buffer`, listens, releases `ready`, and ends by `_stop_event`.
- `viser.infra._infra._message_producer(websocket, buffer, client_id, backlog_done_message)` sends
  the buffer's windows by `await websocket.send(bytes)`, first the backlog, then
  `_backlog_done_message`, until the buffer is `done`.
- `ViserServer._run_garbage_collector()` is what viser does before a client's backlog is sent.
- Tunnels are opened and closed by `ViserServer.request_share_url` and `.disconnect_share_url` only.
- `viser.infra.AsyncMessageBuffer(event_loop, persistent_messages=True)` is the broadcast's buffer.
"""

import asyncio
import contextlib
import itertools
import threading
from collections.abc import AsyncGenerator, Iterator
from typing import Any

import rich
import viser
from viser import infra
from viser.infra import _infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

_making = threading.Lock()


class _Broadcaster(infra.WebsockServer):
    """viser's message buffer on its own thread and loop, without a socket."""

    def _background_worker(self, ready_sem: threading.Semaphore) -> None:
        loop = asyncio.new_event_loop()
        self._stop_event = asyncio.Event()
        self._background_event_loop = loop
        self._broadcast_buffer = AsyncMessageBuffer(loop, persistent_messages=True)
        ready_sem.release()
        try:
            loop.run_until_complete(self._serve_until_stopped(self._stop_event))
        finally:
            loop.close()

    async def _serve_until_stopped(self, stop: asyncio.Event) -> None:
        await stop.wait()
        streams = asyncio.all_tasks() - {asyncio.current_task()}
        for stream in streams:
            stream.cancel()
        await asyncio.gather(*streams, return_exceptions=True)


class InProcessViser(viser.ViserServer):
    """viser's scene, read by `frames` alone: no port, no clients, no tunnel."""

    def __init__(self) -> None:
        """Start its thread.

        Raises:
            RuntimeError: This version of viser makes its server in another way.
        """
        self._readers = itertools.count()
        # viser's constructor takes no server; it is given one without a listener by its name.
        with _making, _without_listener(), _quiet():
            super().__init__(host="127.0.0.1", port=0, label=None, verbose=False)
        if not isinstance(self._websock_server, _Broadcaster):
            self.stop()
            raise RuntimeError(f"viser {viser.__version__} does not take a server without a port")

    async def frames(self) -> AsyncGenerator[bytes, None]:
        """Encoded frames as a newcomer gets them: all that there is, then what changes.

        Runs on the caller's loop; viser waits with a frame until the one before it was taken, and
        meanwhile merges what is drawn.

        Raises:
            ConnectionError: viser has stopped.
        """
        server, taken = self._websock_server, _Stream()
        self._run_garbage_collector()
        producing = _infra._message_producer(
            taken,  # type: ignore[arg-type]  # only send() of a connection is used
            server.get_message_buffer(),
            next(self._readers),
            backlog_done_message=server._backlog_done_message,
        )
        until_end = taken.until_end(producing)
        try:
            production = asyncio.run_coroutine_threadsafe(until_end, self._event_loop)
        except RuntimeError as error:
            until_end.close()
            producing.close()
            raise ConnectionError("viser has stopped") from error
        try:
            while (frame := await taken.next()) is not None:
                yield frame
        finally:
            production.cancel()
        raise ConnectionError("viser has stopped")

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Open no tunnel: what is drawn here is read through the hub only."""
        del verbose
        return None

    def disconnect_share_url(self) -> None:
        """Do nothing: there is never a tunnel."""


class _Stream:
    """Hands frames from viser's loop to the reader's, one at a time."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._frames: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._is_first = True

    async def send(self, frame: bytes) -> None:
        """Called on viser's loop; returns when the reader has taken the frame."""
        await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self._put(frame), self._loop))

    async def until_end(self, producing: Any) -> None:
        """Run viser's producer on viser's loop, and tell the reader when it ends."""
        try:
            await producing
        finally:
            with contextlib.suppress(RuntimeError):  # the reader's loop is closed
                self._loop.call_soon_threadsafe(self._frames.put_nowait, None)

    async def next(self) -> bytes | None:
        """The next frame, once the one before it was dealt with; None at the end."""
        if not self._is_first:
            self._frames.task_done()
        self._is_first = False
        return await self._frames.get()

    async def _put(self, frame: bytes) -> None:
        self._frames.put_nowait(frame)
        await self._frames.join()


@contextlib.contextmanager
def _without_listener() -> Iterator[None]:
    """Let viser's constructor make a server that does not listen."""
    listening = infra.WebsockServer
    infra.WebsockServer = _Broadcaster  # type: ignore[misc]
    try:
        yield
    finally:
        infra.WebsockServer = listening  # type: ignore[misc]


@contextlib.contextmanager
def in_process_viser() -> Iterator[InProcessViser]:
    """Run a viser server without a port for a while."""
    server = InProcessViser()
    try:
        yield server
    finally:
        with _quiet():
            server.stop()


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep viser from printing the address that it does not have."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
