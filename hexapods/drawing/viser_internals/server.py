"""viser servers without a listener: what they draw is read in-process, and no message reaches them.

viser 1.1.1 listens on a TCP port without authentication, and one of the messages that it accepts
there (`ShareUrlRequest`) starts a process that opens a public tunnel. So these servers bind no
socket. `RecordedViser` has neither a thread, and is what most drawing needs; `InProcessViser` keeps
viser's message buffer, thread and encoder, and passes the encoded windows to the one reader in this
process, the hub.
"""

import asyncio
import contextlib
import itertools
import threading
from collections.abc import AsyncGenerator, Iterator
from functools import cache
from typing import Any, ClassVar, get_type_hints

import rich
import viser
from viser import _assignable_props_api, infra
from viser.infra import _infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

_console_lock = threading.Lock()


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


class _Unread(infra.WebsockServer):
    """viser's messages as serializers take them, without a thread, an event loop or a socket.

    Its loop is closed from the start, so that viser wakes nothing; once a serializer is registered,
    messages are not kept for clients any more.
    """

    def start(self) -> None:
        """Make the message buffer."""
        self._background_event_loop = _closed_loop()
        self._broadcast_buffer = AsyncMessageBuffer(
            self._background_event_loop, persistent_messages=True
        )

    def stop(self) -> None:
        """Do nothing: there is no thread."""

    def queue_message(self, message: infra.Message) -> None:
        """Pass a message to the serializers, or keep it for the first one."""
        with self._record_lock:
            for serializer in self._record_handles:
                serializer._insert_message(message)
            if not self._record_handles:
                self.get_message_buffer().push(message)


@cache
def _closed_loop() -> asyncio.AbstractEventLoop:
    loop = asyncio.new_event_loop()
    loop.close()
    return loop


class ViserWithoutSocket(viser.ViserServer):
    """A viser server without a port, clients or a tunnel.

    Raises:
        RuntimeError: This version of viser creates its server in another way.
    """

    _server_class: ClassVar[type[infra.WebsockServer]]

    def __init__(self) -> None:
        # viser's constructor accepts no server, so the class it instantiates is replaced meanwhile.
        with _quiet(), _instead_of_listener(self._server_class):
            super().__init__(host="127.0.0.1", port=0, label=None, verbose=False)
        if not isinstance(self._websock_server, self._server_class):
            self.stop()
            raise RuntimeError(f"viser {viser.__version__} does not take a server without a port")

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Do nothing and return None: no tunnel, since the scene is read in this process only."""
        del verbose
        return None

    def disconnect_share_url(self) -> None:
        """Do nothing: there is never a tunnel."""


class RecordedViser(ViserWithoutSocket):
    """A viser server that only draws: what it draws is taken by a recorder or a serializer."""

    _server_class = _Unread


class InProcessViser(ViserWithoutSocket):
    """A viser server whose scene is read through `frames` only."""

    _server_class = _Broadcaster

    def __init__(self) -> None:
        """Start viser's thread."""
        self._client_ids = itertools.count()
        super().__init__()

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
def _instead_of_listener(server_class: type[infra.WebsockServer]) -> Iterator[None]:
    """Replace viser's server class meanwhile, so that its constructor opens no socket."""
    original = infra.WebsockServer
    infra.WebsockServer = server_class  # type: ignore[misc]
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
def recorded_viser() -> Iterator[RecordedViser]:
    """Draw in a viser server of which a recorder or a serializer takes what is drawn."""
    server = RecordedViser()
    try:
        yield server
    finally:
        server.stop()


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Silence viser's console, which would print an address that does not exist.

    One thread at a time is in it, so that each restores what was there before.
    """
    console = rich.get_console()
    with _console_lock:
        before, console.quiet = console.quiet, True
        # A quiet console lays its tables out nevertheless, which takes longer than starting viser.
        printing, rich.print = rich.print, lambda *_objects, **_settings: None
        try:
            yield
        finally:
            console.quiet, rich.print = before, printing


# viser resolves the types of a node's properties anew for each node, a third of the time that it
# takes to draw a scene.
_assignable_props_api.get_type_hints = cache(  # type: ignore[attr-defined, assignment]
    get_type_hints
)
