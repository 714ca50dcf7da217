"""`hexapods serve` as a user runs it: a process of its own, on a free port of this machine."""

import os
import re
import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import httpx2

from app.storage.server_lock import read_address_file
from tests.forked import start_hexapods

_ADDRESS = re.compile(r"is at (https?://\S+)")
_STARTS_WITHIN_S = 60
_RUNS_WITHIN_S = 60
_ENDS_WITHIN_S = 20


class Serving:
    """A server process on a data folder, with its address.

    Attributes:
        address: where it is on this machine, with a slash at the end.
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
        self._has_address = threading.Event()
        self.address = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if not self._has_address.wait(_STARTS_WITHIN_S) or not self.address:
            self.stop()
            raise RuntimeError(f"the server did not start; it said: {''.join(self._said)}")

    def link(self, view: str = "", /, **state: object) -> str:
        """Return the address that opens the page in a state: its depth, its tab, the form."""
        return f"{self.address}?{urlencode(state)}#{view}"

    @contextmanager
    def api(self, token: str = "") -> Iterator[httpx2.Client]:
        """A client of its API, of the operator with this token."""
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        with httpx2.Client(
            base_url=f"{self.address}api/v1/", headers=headers, timeout=60, trust_env=False
        ) as client:
            yield client

    @property
    def port(self) -> int:
        """The port that the system chose."""
        return int(self.address.rstrip("/").rsplit(":", 1)[1])

    @property
    def pid(self) -> int:
        """Id of its process."""
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
            if match := _ADDRESS.search(line):
                # It says its public address, if it has one.
                self.address = read_address_file(self.data) or match[1]
                self._has_address.set()
        self._has_address.set()


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


def finished(api: httpx2.Client, path: str, body: dict[str, Any]) -> dict[str, Any]:
    """Start a run, and return it once it has finished."""
    run: dict[str, Any] = api.post(path, json=body).raise_for_status().json()
    deadline = time.monotonic() + _RUNS_WITHIN_S
    while run["state"] != "finished":
        assert time.monotonic() < deadline, run
        time.sleep(0.1)
        run = api.get(f"{path}/{run['id']}").json()
    return run


def hold(api: httpx2.Client, run: dict[str, Any], time_s: float) -> None:
    """Show a moment of a run on the stage, and hold it."""
    moment = {"run_id": run["id"], "time_s": time_s, "playing": False}
    api.put("stage", json=moment).raise_for_status()
