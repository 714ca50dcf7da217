"""Ends the long requests of a server that stops, which are computed in its own threads."""

import threading

from app.storage.errors import Busy


class Stopping:
    """Flag of a server that is stopping. Thread-safe."""

    def __init__(self) -> None:
        """Create it for a server that runs."""
        self._is_set = threading.Event()

    def set(self) -> None:
        """Let every `check` fail from now on."""
        self._is_set.set()

    def check(self) -> None:
        """Raise if the server is stopping; call it between the parts of long work.

        Raises:
            Busy: if the server stops.
        """
        if self._is_set.is_set():
            raise Busy("the server is stopping; try again later", 1)
