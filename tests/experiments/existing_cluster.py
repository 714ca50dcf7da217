"""An existing Dask cluster for tests: scheduler and workers started by their command lines."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import psutil
from distributed import Client
from distributed.security import Security

from hexapods.experiments.cluster import ClusterSpec
from tests.timeouts import LONG_S

_OPTIONS = {"tls_ca": "--tls-ca-file", "tls_cert": "--tls-cert", "tls_key": "--tls-key"}


class ExistingCluster:
    """A scheduler process and its workers. Created by `scheduler`."""

    def __init__(self, folder: Path, tls: bool, stack: ExitStack) -> None:
        self._folder, self._stack = folder, stack
        self._security = Security.temporary() if tls else Security()
        self._files = _certificates(folder, self._security) if tls else {}
        self._workers = 0
        file = folder / "scheduler.json"
        self.process = self._start(
            "scheduler",
            *("--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)),
            *(("--protocol", "tls") if tls else ()),
        )
        deadline = time.monotonic() + LONG_S
        while not file.exists() or not file.read_text("utf-8").endswith("}"):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        self.address: str = json.loads(file.read_text("utf-8"))["address"]

    def worker(self, **variables: str) -> None:
        """Start a worker, with additional environment variables, and wait until it is known.

        An experiment waits for one less long than it may take to start on a busy machine.
        """
        self._start("worker", self.address, "--nthreads", "1", **variables)
        self._workers += 1
        options: dict[str, Any] = {"timeout": LONG_S, "set_as_default": False}
        with Client(self.address, security=self._security, **options) as client:
            client.wait_for_workers(self._workers, timeout=LONG_S)

    @property
    def where(self) -> ClusterSpec:
        """The spec to connect to it, with its certificates."""
        return ClusterSpec(scheduler=self.address, **self._files)

    def _start(self, what: str, *arguments: str, **variables: str) -> subprocess.Popen[bytes]:
        # The modules that `dask scheduler` and `dask worker` run.
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments]
        files = [
            argument for name, file in self._files.items() for argument in (_OPTIONS[name], file)
        ]
        process = subprocess.Popen(
            [*command, "--no-dashboard", *files],
            cwd=self._folder,
            env={**os.environ, "PYTHONPATH": str(Path.cwd()), **variables},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._stack.callback(_end, process)
        return process


@contextmanager
def scheduler(folder: Path, tls: bool = False) -> Iterator[ExistingCluster]:
    """Start a scheduler on loopback without workers; all processes end with the context.

    Args:
        folder: working directory.
        tls: whether to require client certificates.
    """
    with ExitStack() as stack:
        yield ExistingCluster(folder, tls, stack)


def _certificates(folder: Path, credentials: Any) -> dict[str, Any]:
    """Write PEM files for scheduler, workers and clients; paths by field of `ClusterSpec`."""
    files = {}
    for name, text in (
        ("tls_ca", credentials.tls_ca_file),
        ("tls_cert", credentials.tls_client_cert),
        ("tls_key", credentials.tls_client_key),
    ):
        (folder / f"{name}.pem").write_text(text, "utf-8")
        files[name] = str(folder / f"{name}.pem")
    return files


def _end(process: subprocess.Popen[bytes]) -> None:
    children = (
        psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []
    )
    process.kill()
    process.wait()
    _, left = psutil.wait_procs(children, timeout=LONG_S)
    for child in left:
        child.kill()
