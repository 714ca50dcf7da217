"""A cluster of this machine's own: one worker process a core, on loopback, closed to others."""

import logging
import multiprocessing.resource_tracker
import signal
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from distributed import Client, SpecCluster


_logger = logging.getLogger(__name__)


def cores() -> int:
    """How many workers this machine has room for, within the limits of a container."""
    from dask.system import CPU_COUNT  # noqa: PLC0415 - half a second that others need not

    return int(CPU_COUNT)


@contextmanager
def own_cluster(workers: int) -> "Iterator[Client]":
    """A client of a cluster on loopback, whose processes end with this one, however it ends.

    Args:
        workers: processes, of one thread each.
    """
    import dask  # noqa: PLC0415
    from distributed import Client, Nanny, SpecCluster  # noqa: PLC0415
    from distributed.security import Security  # noqa: PLC0415
    from distributed.worker_memory import parse_memory_limit  # noqa: PLC0415

    from app.experiments.cluster_nodes import PagelessScheduler, PagelessWorker  # noqa: PLC0415

    with ExitStack() as stack:
        folder = tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True)
        stack.enter_context(folder)
        settings = {**_OWN_SETTINGS, "temporary-directory": folder.name}
        stack.enter_context(dask.config.set(settings))
        with _sigint_blocked():
            # Anyone on the machine could otherwise send code to the ports.
            security = Security.temporary()
            anywhere = {"host": "127.0.0.1", "protocol": "tls://", "security": security}
            worker = {
                "cls": Nanny,
                "options": {
                    **anywhere,
                    "worker_class": PagelessWorker,
                    "nthreads": 1,
                    "memory_limit": parse_memory_limit("auto", 1, workers, logger=_logger),
                    "dashboard": False,
                    "local_directory": folder.name,
                    # What a trial has there goes with the folder, when its worker is ended in it.
                    "env": {"TMPDIR": folder.name},
                    "silence_logs": logging.CRITICAL,
                },
            }
            scheduler = {
                "cls": PagelessScheduler,
                "options": {
                    **anywhere,
                    "port": 0,
                    "dashboard": False,
                    # Each death comes to the engine, which says what follows from it.
                    "allowed_failures": 0,
                },
            }
            cluster = SpecCluster(
                workers=dict.fromkeys(range(workers), worker),
                worker=worker,
                scheduler=scheduler,
                security=security,
                silence_logs=logging.CRITICAL,
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
def _sigint_blocked() -> Iterator[None]:
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


def _drop_work(cluster: "SpecCluster") -> None:
    """End the workers at once; asked politely, each would finish its trial first."""

    async def drop() -> None:
        for nanny in cluster.workers.values():
            nanny.close_gracefully()  # so that it starts no other
            process = nanny.process and nanny.process.process
            if process is not None and process.is_alive():
                await process.kill()

    cluster.sync(drop)
