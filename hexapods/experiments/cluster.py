"""Workers that trials run on: processes of this machine, or an existing Dask cluster."""

import asyncio
import logging
import re
import socket
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hexapods.domain.checks import check_whole
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.config import MAX_WORKERS
from hexapods.experiments.local_workers import local_workers
from hexapods.experiments.plan import Trial
from hexapods.experiments.worker import (
    ClusterLost,
    Outcome,
    WorkerDied,
    Workers,
    difference,
    run_batch,
    versions,
)
from hexapods.extras import needs
from hexapods.machine import cores

if TYPE_CHECKING:
    from distributed import Client, Future
    from distributed.security import Security

ANSWER_S = 8.0
"""Timeout for connecting to a scheduler and for its answers."""

_ADDRESS = re.compile(r"(tcp|tls)://[^\s/]+:\d{1,5}")
_HOW_TO_START = (
    "start one with `dask scheduler` and `dask worker ADDRESS --nthreads 1`, or leave --scheduler "
    "out to use the cores of this machine"
)
_PURPOSE = "an experiment on a Dask cluster"
_LOST = "the connection to the cluster's scheduler was lost; what was done is kept"


@dataclass(frozen=True, kw_only=True)
class ClusterSpec:
    """The workers that trials run on.

    Attributes:
        workers: number of processes on this machine; None for one per core.
        scheduler: address of a Dask cluster's scheduler, such as `tcp://10.0.0.7:8786` or
            `tls://…`; None for this machine.
        tls_ca, tls_cert, tls_key: paths of PEM files, for a `tls://` scheduler.

    Raises:
        InvalidInput: if the fields are out of range or contradict each other.
    """

    workers: int | None = None
    scheduler: str | None = None
    tls_ca: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None

    def __post_init__(self) -> None:
        if self.workers is not None:
            check_whole("workers", self.workers, 1, MAX_WORKERS)
        files = {name: getattr(self, name) for name in ("tls_ca", "tls_cert", "tls_key")}
        if self.scheduler is None:
            if any(files.values()):
                raise InvalidInput("TLS files are for a scheduler at tls://HOST:PORT")
            return
        if self.workers is not None:
            raise InvalidInput(
                "choose either workers on this machine or a scheduler, which has its own"
            )
        if not _ADDRESS.fullmatch(self.scheduler):
            raise InvalidInput(
                f"a scheduler is at tcp://HOST:PORT or tls://HOST:PORT, not {self.scheduler!r}"
            )
        if self.scheduler.startswith("tls") != all(files.values()) or (
            any(files.values()) != all(files.values())
        ):
            raise InvalidInput(
                "a scheduler at tls:// needs a CA, a certificate and its key, one at tcp:// none"
            )
        for file in files.values():
            if file is not None and not Path(file).is_file():
                raise InvalidInput(f"there is no file {file}")


@contextmanager
def connect(spec: ClusterSpec) -> Iterator[Workers]:
    """Yield the workers; those of this machine are started first.

    Leaving the context cancels the tasks in progress. Processes on this machine end with this one,
    even if this one is killed.

    Raises:
        InvalidInput: if the scheduler does not answer, or a worker would compute other results.
        MissingExtra: if there is a scheduler, and Dask is not installed.
        ClusterLost: if no worker can be started.
    """
    if spec.scheduler is None:
        with local_workers(spec.workers or cores()) as workers:
            yield workers
    else:
        with _existing_cluster(spec) as client:
            yield _ClusterWorkers(client)


class _ClusterWorkers:
    """The workers of a Dask cluster."""

    def __init__(self, client: "Client") -> None:
        self._client, self._expected = client, versions()

    def count(self) -> int:
        try:
            return sum(self._client.nthreads().values())  # whole numbers
        # Tornado raises a ValueError if the connection is closed as it begins to be encrypted.
        except (OSError, TimeoutError, ValueError) as error:
            raise ClusterLost(_LOST) from error

    def submit(self, trials: Sequence[Trial]) -> "Future[list[Outcome]]":
        # Not through `get_executor`: its future never ends if a result is lost on its way.
        return self._client.submit(run_batch, trials, self._expected, pure=False)

    def result(self, task: Any) -> list[Outcome]:
        with needs("cluster", _PURPOSE):
            from distributed import CancelledError, KilledWorker  # noqa: PLC0415

        try:
            done: list[Outcome] = task.result()
        except KilledWorker as error:
            raise WorkerDied(error.allowed_failures + 1) from error
        except CancelledError as error:
            raise ClusterLost(_LOST) from error
        return done


@contextmanager
def _existing_cluster(spec: ClusterSpec) -> "Iterator[Client]":
    with needs("cluster", _PURPOSE):
        from distributed import Client  # noqa: PLC0415 - importing Dask takes half a second
        from distributed.utils import silence_logging_cmgr  # noqa: PLC0415

    address = str(spec.scheduler)
    # Silences Dask's log of every worker that dies; the engine reports these itself.
    with silence_logging_cmgr(logging.CRITICAL):
        security = _security(spec)
        try:
            _probe(address, security)
            client = Client(address, security=security, timeout=ANSWER_S, set_as_default=False)
        except (OSError, OverflowError, ValueError, TypeError) as error:
            raise InvalidInput(
                f"no scheduler answers at {address} ({_first_line(error)}); {_HOW_TO_START}"
            ) from error
        try:
            _check_workers(client, address)
            yield client
        finally:
            _close(client)


def _close(client: "Client") -> None:
    try:
        client.close()
    except (OSError, ValueError):
        # Its task that reads from a scheduler that died could not reconnect, and ended with an
        # error that `close` raises again (Tornado: "IOStream is not idle; cannot convert to SSL").
        client._handle_report_task = None  # noqa: SLF001 - so that `close` does not wait for it
        client.close()


def _probe(address: str, security: "Security") -> None:
    """Check that a scheduler answers at the address, within `ANSWER_S`.

    Dask's own client retries a refused connection, and waits without a timeout for a server that
    accepts the connection but does not answer.
    """
    with needs("cluster", _PURPOSE):
        from distributed.comm.core import connect as shake_hands  # noqa: PLC0415

    host, _, port = address.partition("://")[2].rpartition(":")
    with socket.create_connection((host.strip("[]"), int(port)), ANSWER_S):
        pass

    async def handshake() -> None:
        arguments = security.get_connection_args("client")
        comm = await asyncio.wait_for(shake_hands(address, ANSWER_S, **arguments), ANSWER_S)
        await comm.close()

    # In a thread of its own, since a notebook's main thread already runs an event loop.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(lambda: asyncio.run(handshake())).result()


def _security(spec: ClusterSpec) -> "Security":
    with needs("cluster", _PURPOSE):
        from distributed.security import Security  # noqa: PLC0415

    if spec.tls_ca is None:
        return Security()
    return Security(
        require_encryption=True,
        tls_ca_file=spec.tls_ca,
        tls_client_cert=spec.tls_cert,
        tls_client_key=spec.tls_key,
    )


def _check_workers(client: "Client", address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=ANSWER_S)
    except TimeoutError as error:
        raise InvalidInput(
            f"the scheduler at {address} has no workers; start some with `dask worker {address} "
            "--nthreads 1`"
        ) from error
    own_versions = versions()
    versions_by_worker: dict[str, Any] = client.run(versions, on_error="return")
    for worker, worker_versions in versions_by_worker.items():
        if not isinstance(worker_versions, dict):
            raise InvalidInput(
                f"the worker at {worker} cannot run trials ({_first_line(worker_versions)}); "
                f"install racing-hexapods {own_versions['racing-hexapods']} there"
            )
        differs = difference(own_versions, worker_versions)
        if differs is not None:
            raise InvalidInput(
                f"the worker at {worker} would compute other results: it has {differs}"
            )


def _first_line(error: BaseException) -> str:
    return str(error).strip().split("\n")[0] or type(error).__name__
