"""A viser server without a listener: a recorder takes what it draws, and no message reaches it.

viser 1.1.1 listens on a TCP port without authentication, and one of the messages that it accepts
there (`ShareUrlRequest`) starts a process that opens a public tunnel. So this server binds no
socket. It has no thread either.
"""

import asyncio
import contextlib
import threading
from collections.abc import Iterator
from functools import cache
from typing import get_type_hints

import rich
import viser
from viser import _assignable_props_api, infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

_console_lock = threading.Lock()


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


class RecordedViser(viser.ViserServer):
    """A viser server that only draws: no port, no clients, no tunnel."""

    def __init__(self) -> None:
        """Create it.

        Raises:
            RuntimeError: This version of viser creates its server in another way.
        """
        # viser's constructor accepts no server, so the class it instantiates is replaced meanwhile.
        with _quiet(), _without_listener():
            super().__init__(host="127.0.0.1", port=0, label=None, verbose=False)
        if not isinstance(self._websock_server, _Unread):
            self.stop()
            raise RuntimeError(f"viser {viser.__version__} does not take a server without a port")

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Do nothing and return None: there is never a tunnel."""
        del verbose
        return None

    def disconnect_share_url(self) -> None:
        """Do nothing."""


@contextlib.contextmanager
def _without_listener() -> Iterator[None]:
    """Replace viser's server class meanwhile, so that its constructor opens no socket."""
    original = infra.WebsockServer
    infra.WebsockServer = _Unread  # type: ignore[misc]
    try:
        yield
    finally:
        infra.WebsockServer = original  # type: ignore[misc]


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
