"""The machines that trials run on: this one's cores, or a Dask cluster that is there already."""

import logging
import multiprocessing.resource_tracker
import re
import signal
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.domain.errors import HexapodError, InvalidInput
from app.experiments.versions import difference, versions
from app.runs.config import check_whole

if TYPE_CHECKING:
    from distributed import Client, LocalCluster
    from distributed.security import Security

MAX_WORKERS = 512
ANSWER_S = 8.0
"""How long a scheduler may take to answer."""

_ADDRESS = re.compile(r"(tcp|tls)://[^\s/]+:\d{1,5}")
_HOW_TO_START = (
    "start one with `dask scheduler` and `dask worker ADDRESS --nthreads 1`, or leave --scheduler "
    "out to use the cores of this machine"
)


class ClusterLost(HexapodError):
    """The cluster is gone, or has no worker left; the message says what is kept."""


@dataclass(frozen=True, kw_only=True)
class Where:
    """On which machines trials run.

    Attributes:
        workers: processes of a cluster on this machine; None for one a core.
        scheduler: of a cluster that is there already, such as `tcp://10.0.0.7:8786`, or `tls://`;
            None for this machine.
        tls_ca, tls_cert, tls_key: PEM files, for a `tls://` scheduler.
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


def cores() -> int:
    """How many workers this machine has room for, within the limits of a container."""
    from dask.system import CPU_COUNT  # noqa: PLC0415 - half a second that others need not

    return int(CPU_COUNT)


@contextmanager
def connect(where: Where) -> "Iterator[Client]":
    """A client of the cluster, which is started first where it is this machine's own.

    Whoever leaves drops what is still computed. Its processes end with this one, however it ends.

    Raises:
        InvalidInput: if the scheduler does not answer, or a worker would compute other results.
        ClusterLost: if no worker can be started.
    """
    from distributed.utils import silence_logging_cmgr  # noqa: PLC0415

    with ExitStack() as stack:
        # It would tell of every worker that dies, which the engine reports in its own words.
        stack.enter_context(silence_logging_cmgr(logging.CRITICAL))
        connected = _foreign if where.scheduler is not None else _own
        yield stack.enter_context(connected(where))


@contextmanager
def _own(where: Where) -> "Iterator[Client]":
    import dask  # noqa: PLC0415
    from distributed import Client, LocalCluster  # noqa: PLC0415

    with ExitStack() as stack:
        folder = tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True)
        stack.enter_context(folder)
        settings = {**_OWN_SETTINGS, "temporary-directory": folder.name}
        stack.enter_context(dask.config.set(settings))
        with _deaf_to_ctrl_c():
            cluster = LocalCluster(
                n_workers=where.workers or cores(),
                threads_per_worker=1,
                host="127.0.0.1",
                # Anyone on the machine could otherwise send code to the port.
                security=True,
                dashboard_address=None,
                local_directory=folder.name,
                # What a trial has there goes with the folder, when its worker is ended in it.
                env={"TMPDIR": folder.name},
                silence_logs=logging.CRITICAL,
                scheduler_kwargs={
                    # Each death comes to the engine, which says what follows from it.
                    "allowed_failures": 0,
                    # No page, and not on the port that others expect it on.
                    "dashboard": False,
                    "dashboard_address": "127.0.0.1:0",
                },
            )
        stack.enter_context(cluster)
        client = stack.enter_context(Client(cluster, set_as_default=False))
        stack.callback(_drop_work, cluster)
        yield client


_OWN_SETTINGS = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.worker.profile.enabled": False,
    # Little is ever kept in memory. A trial that takes all there is ends its worker, no other's.
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
}


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Ctrl-C reaches every process of a terminal; workers shall leave it to this one.

    Processes inherit what is blocked from the thread that starts them, also those started later
    in place of dead ones.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Whoever starts this helper of `multiprocessing` would unblock it again.
    multiprocessing.resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _drop_work(cluster: "LocalCluster") -> None:
    """End the workers at once; asked politely, each would finish its trial first."""

    async def drop() -> None:
        for nanny in cluster.workers.values():
            nanny.close_gracefully()  # so that it starts no other
            process = nanny.process and nanny.process.process
            if process is not None and process.is_alive():
                await process.kill()

    cluster.sync(drop)


@contextmanager
def _foreign(where: Where) -> "Iterator[Client]":
    from distributed import Client  # noqa: PLC0415

    address = str(where.scheduler)
    try:
        client = Client(address, security=_security(where), timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InvalidInput(
            f"no scheduler answers at {address} ({_reason(error)}); {_HOW_TO_START}"
        ) from error
    with client:
        _check_workers(client, address)
        yield client


def _security(where: Where) -> "Security | None":
    from distributed.security import Security  # noqa: PLC0415

    if where.tls_ca is None:
        return None
    return Security(
        require_encryption=True,
        tls_ca_file=where.tls_ca,
        tls_client_cert=where.tls_cert,
        tls_client_key=where.tls_key,
    )


def _check_workers(client: "Client", address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=ANSWER_S)
    except TimeoutError as error:
        raise InvalidInput(
            f"the scheduler at {address} has no workers; start some with `dask worker {address} "
            "--nthreads 1`"
        ) from error
    here = versions()
    found: dict[str, Any] = client.run(versions, on_error="return")
    for worker, there in found.items():
        if not isinstance(there, dict):
            raise InvalidInput(
                f"the worker at {worker} cannot run trials ({_reason(there)}); install "
                f"racing-hexapods {here['racing-hexapods']} there"
            )
        differs = difference(here, there)
        if differs is not None:
            raise InvalidInput(
                f"the worker at {worker} would compute other results: it has {differs}"
            )


def _reason(error: BaseException) -> str:
    return str(error).strip().split("\n")[0] or type(error).__name__
