"""A local Dask cluster: one worker process per core, on loopback, with TLS client certificates."""

import logging
import multiprocessing.resource_tracker
import os
import signal
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING

from hexapods.processes import STALLED_S, is_stopped

if TYPE_CHECKING:
    from distributed import Client, SpecCluster


_logger = logging.getLogger(__name__)


def cores() -> int:
    """Return the number of usable cores, with a container's CPU limit (cgroup) applied."""
    from dask.system import CPU_COUNT  # noqa: PLC0415 - importing Dask takes half a second

    return int(CPU_COUNT)


@contextmanager
def own_cluster(workers: int) -> "Iterator[Client]":
    """Start a cluster on loopback and yield a client of it.

    Its processes end with this one, even if this one is killed.

    Args:
        workers: number of worker processes, of one thread each.
    """
    import dask  # noqa: PLC0415
    from distributed import Client, Nanny, SpecCluster  # noqa: PLC0415
    from distributed.security import Security  # noqa: PLC0415
    from distributed.utils import get_mp_context  # noqa: PLC0415
    from distributed.worker_memory import parse_memory_limit  # noqa: PLC0415

    from hexapods.experiments.cluster_nodes import SchedulerWithoutHttp, WorkerWithoutHttp  # noqa: PLC0415

    with ExitStack() as stack:
        folder = tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True)
        stack.enter_context(folder)
        settings = {**_DASK_SETTINGS, "temporary-directory": folder.name}
        stack.enter_context(dask.config.set(settings))
        context = get_mp_context()
        if context.get_start_method() == "forkserver":
            # Instead of Dask's choice; a fork server that already runs keeps what it has imported.
            context.set_forkserver_preload(_PRELOADED)
        with _sigint_blocked():
            # Without client certificates any local user could send code to the ports.
            security = Security.temporary()
            endpoint = {"host": "127.0.0.1", "protocol": "tls://", "security": security}
            worker = {
                "cls": Nanny,
                "options": {
                    **endpoint,
                    "worker_class": WorkerWithoutHttp,
                    "nthreads": 1,
                    "memory_limit": parse_memory_limit("auto", 1, workers, logger=_logger),
                    "dashboard": False,
                    "local_directory": folder.name,
                    # A fork server has the environment of its start. A killed worker's temporary
                    # files are deleted with this folder.
                    "env": {**os.environ, "TMPDIR": folder.name},
                    "silence_logs": logging.CRITICAL,
                },
            }
            scheduler = {
                "cls": SchedulerWithoutHttp,
                "options": {
                    **endpoint,
                    "port": 0,
                    "dashboard": False,
                    # No retries by Dask: the engine handles each worker's death itself.
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
        stack.enter_context(_watched(cluster))
        stack.callback(_kill_workers, cluster)
        yield client


_PRELOADED = [
    "hexapods.experiments.cluster_nodes",
    "hexapods.experiments.worker",
    "hexapods.physics.mujoco_simulator",
]
_DASK_SETTINGS: dict[str, object] = {
    # Forked from one process that has imported all they need, workers start in a tenth of the time.
    "distributed.worker.multiprocessing-method": (
        "forkserver" if sys.platform == "linux" else "spawn"
    ),
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.worker.profile.enabled": False,
    # Results are small, so spilling to disk and pausing are of no use. A trial that exceeds the
    # memory limit ends only its own worker, by the nanny.
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
}


@contextmanager
def _sigint_blocked() -> Iterator[None]:
    """Block SIGINT while worker processes are started, so that they ignore Ctrl-C.

    A terminal sends SIGINT to its whole process group; only this process shall handle it. A child
    inherits the signal mask of the thread that starts it, and so do workers restarted later.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Starting the resource tracker unblocks SIGINT, so that it must be running beforehand.
    multiprocessing.resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _watched(cluster: "SpecCluster") -> Iterator[None]:
    """Kill workers that a signal has stopped for `STALLED_S`; others then get their trials."""
    closing, seen_stopped = threading.Event(), Counter[int]()

    def watch() -> None:
        while not closing.wait(1.0):
            # Times that it was seen so, since a clock also runs while all processes are stopped.
            for pid in [nanny.pid for nanny in list(cluster.workers.values())]:
                seen_stopped[pid] = seen_stopped[pid] + 1 if pid and is_stopped(pid) else 0
                if seen_stopped[pid] > STALLED_S:
                    _logger.warning("a worker was stopped by a signal for %g s", STALLED_S)
                    with suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)

    thread = threading.Thread(target=watch, name="workers' watch", daemon=True)
    thread.start()
    try:
        yield
    finally:
        closing.set()
        thread.join()


def _kill_workers(cluster: "SpecCluster") -> None:
    """Kill the workers at once; on a graceful shutdown each would finish its trial first."""

    async def kill_all() -> None:
        for nanny in cluster.workers.values():
            nanny.close_gracefully()  # so that the nanny does not restart the worker
            process = nanny.process and nanny.process.process
            if process is not None and process.is_alive():
                await process.kill()

    cluster.sync(kill_all)
