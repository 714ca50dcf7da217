"""A viser server of one's own for a while."""

import contextlib
from collections.abc import Iterator

import rich
import viser


@contextlib.contextmanager
def loopback_viser() -> Iterator[viser.ViserServer]:
    """Viser on a free port of 127.0.0.1: its own default is every interface, and asks nobody."""
    with _quiet():
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        yield server
    finally:
        with _quiet():
            server.stop()


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Without the box with its own address that viser prints."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
