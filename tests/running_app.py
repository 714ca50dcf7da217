"""Serves an app by uvicorn in a thread of the test, on loopback."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import uvicorn
from starlette.applications import Starlette

from app.server import GRACE_S

PATIENCE_S = 30.0
"""Timeout of waits [s]; only ends a test that would hang."""


@contextmanager
def running(app: Starlette) -> Iterator[int]:
    """Serve an app with the options of the server; yield its port."""
    config = uvicorn.Config(
        app,
        host="127.0.0.1",
        port=0,
        ws="none",
        log_level="warning",
        timeout_graceful_shutdown=GRACE_S,
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    try:
        wait_until(lambda: server.started)
        yield server.servers[0].sockets[0].getsockname()[1]
    finally:
        server.should_exit = True
        thread.join(PATIENCE_S)
        assert not thread.is_alive(), "the server hangs at shutdown"


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
