"""A viser server without a listener: its stream is read in-process, and it receives no messages.

viser 1.1.1 listens on a TCP port without authentication, and one of the messages that it accepts
there (`ShareUrlRequest`) starts a process that opens a public tunnel. So this server binds no
socket: it keeps viser's message buffer, thread and encoder, and passes the encoded windows to the
one reader in this process, the hub. No message reaches viser from outside.
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

_construction_lock = threading.Lock()


class _Broadcaster(infra.WebsockServer):
    """viser's message buffer on its own thread and event loop, without a socket."""

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
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class InProcessViser(viser.ViserServer):
    """A viser server whose scene is read through `frames` only: no port, no clients, no tunnel."""

    def __init__(self) -> None:
        """Start viser's thread.

        Raises:
            RuntimeError: This version of viser creates its server in another way.
        """
        self._client_ids = itertools.count()
        # viser's constructor accepts no server, so the class it instantiates is replaced meanwhile.
        with _construction_lock, _without_listener(), _quiet():
            super().__init__(host="127.0.0.1", port=0, label=None, verbose=False)
        if not isinstance(self._websock_server, _Broadcaster):
            self.stop()
            raise RuntimeError(f"viser {viser.__version__} does not take a server without a port")

    async def frames(self) -> AsyncGenerator[bytes, None]:
        """Yield encoded frames as a new client receives them: first the scene, then its changes.

        Runs on the caller's event loop, with back-pressure: viser sends a frame only after the
        last one was consumed, and merges changes meanwhile.

        Raises:
            ConnectionError: viser has stopped.
        """
        server, queue = self._websock_server, _FrameQueue()
        self._run_garbage_collector()
        producer = _infra._message_producer(
            queue,  # type: ignore[arg-type]  # only send() of a connection is used
            server.get_message_buffer(),
            next(self._client_ids),
            backlog_done_message=server._backlog_done_message,
        )
        run_producer = queue.run_producer(producer)
        try:
            future = asyncio.run_coroutine_threadsafe(run_producer, self._event_loop)
        except RuntimeError as error:
            run_producer.close()
            producer.close()
            raise ConnectionError("viser has stopped") from error
        try:
            while (frame := await queue.next()) is not None:
                yield frame
        finally:
            future.cancel()
        raise ConnectionError("viser has stopped")

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Do nothing and return None: no tunnel, since the scene is read through the hub only."""
        del verbose
        return None

    def disconnect_share_url(self) -> None:
        """Do nothing: there is never a tunnel."""


class _FrameQueue:
    """Passes frames from viser's event loop to the reader's, one at a time (rendezvous)."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._frames: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._is_first = True

    async def send(self, frame: bytes) -> None:
        """Pass a frame on and wait until the reader has consumed it; runs on viser's loop."""
        await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self._put(frame), self._loop))

    async def run_producer(self, producer: Any) -> None:
        """Run viser's producer on viser's loop, and signal its end to the reader."""
        try:
            await producer
        finally:
            with contextlib.suppress(RuntimeError):  # the reader's loop is closed
                self._loop.call_soon_threadsafe(self._frames.put_nowait, None)

    async def next(self) -> bytes | None:
        """Mark the last frame as consumed and return the next one; None at the end."""
        if not self._is_first:
            self._frames.task_done()
        self._is_first = False
        return await self._frames.get()

    async def _put(self, frame: bytes) -> None:
        self._frames.put_nowait(frame)
        await self._frames.join()


@contextlib.contextmanager
def _without_listener() -> Iterator[None]:
    """Replace viser's server class meanwhile, so that its constructor opens no socket."""
    original = infra.WebsockServer
    infra.WebsockServer = _Broadcaster  # type: ignore[misc]
    try:
        yield
    finally:
        infra.WebsockServer = original  # type: ignore[misc]


@contextlib.contextmanager
def in_process_viser() -> Iterator[InProcessViser]:
    """Run a viser server without a port within a `with` block."""
    server = InProcessViser()
    try:
        yield server
    finally:
        with _quiet():
            server.stop()


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Silence viser's console, which would print an address that does not exist."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
