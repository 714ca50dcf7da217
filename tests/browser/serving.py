"""`hexapods serve` as a user runs it: a process of its own, on a free port of this machine."""

import os
import re
import signal
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.forked import start_hexapods

_ADDRESS = re.compile(r"is at (http://\S+)")
_STARTS_WITHIN_S = 60
_ENDS_WITHIN_S = 20


class Serving:
    """One server.

    Attributes:
        address: where it is, with a slash at the end.
        data: its folder.
    """

    def __init__(
        self,
        data: Path,
        port: int = 0,
        token: str = "",
        spectators: str = "public",
        **settings: object,
    ) -> None:
        """Start it, with further settings by their names, and wait until it says where it is."""
        self.data = data
        environment = {k: v for k, v in os.environ.items() if not k.startswith("HEXAPODS_")}
        self._process = start_hexapods(
            ["serve", "--port", str(port), "--data", str(data)],
            {
                **environment,
                # A busy machine would starve jobs of a lower priority than the tests have.
                "HEXAPODS_JOB_NICENESS": "0",
                "HEXAPODS_TOKEN": token,
                "HEXAPODS_SPECTATORS": spectators,
                **{f"HEXAPODS_{name.upper()}": str(value) for name, value in settings.items()},
            },
            stderr=subprocess.STDOUT,
        )
        self._said: list[str] = []
        self._found = threading.Event()
        self.address = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if not self._found.wait(_STARTS_WITHIN_S) or not self.address:
            self.stop()
            raise RuntimeError(f"the server did not start; it said: {''.join(self._said)}")

    @property
    def port(self) -> int:
        """The port that the system chose."""
        return int(self.address.rstrip("/").rsplit(":", 1)[1])

    @property
    def pid(self) -> int:
        """Of its process."""
        return self._process.pid

    def kill(self) -> None:
        """End it as a crash does."""
        self._end(signal.SIGKILL)

    def stop(self) -> None:
        """End it as Ctrl-C does."""
        self._end(signal.SIGTERM)

    def _end(self, how: signal.Signals) -> None:
        if self._process.poll() is None:
            self._process.send_signal(how)
            self._process.wait(_ENDS_WITHIN_S)
        self._reader.join(_ENDS_WITHIN_S)
        if self._process.stdout is not None:
            self._process.stdout.close()

    def _read(self) -> None:
        # To the end, because a full pipe would stop the server.
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._said.append(line)
            if found := _ADDRESS.search(line):
                self.address = found[1]
                self._found.set()
        self._found.set()


@contextmanager
def serving(
    data: Path, port: int = 0, token: str = "", spectators: str = "public", **settings: object
) -> Iterator[Serving]:
    """A server for as long as the block lasts."""
    server = Serving(data, port, token, spectators, **settings)
    try:
        yield server
    finally:
        server.stop()
