"""Worker processes on this machine, which run trials."""

import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Future
from contextlib import contextmanager

from hexapods.experiments.plan import Trial
from hexapods.experiments.worker import ClusterLost, Outcome, WorkerDied, run_batch, versions
from hexapods.machine import memory_bytes
from hexapods.processes import SetUp, start_fork_server
from hexapods.worker_pool import WorkerPool

_PRELOADED = ["hexapods.experiments.worker", "hexapods.physics.mujoco_simulator"]
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables by which NumPy's libraries start a number of threads."""
_MEMORY_SHARE = 0.95
"""Share of the machine's memory that all workers may take."""


@contextmanager
def local_workers(count: int, most_bytes: int | None = None) -> "Iterator[LocalWorkers]":
    """Start worker processes for trials, and yield them; see `local_pool`.

    Raises:
        ClusterLost: if they cannot be started.
    """
    with local_pool(count, most_bytes) as pool:
        yield LocalWorkers(pool)


@contextmanager
def local_pool(count: int, most_bytes: int | None = None) -> Iterator[WorkerPool]:
    """Start worker processes, and yield them; they end with this process, even if it is killed.

    Args:
        count: their number.
        most_bytes: memory above which one is killed; None for its share of the machine's.

    Raises:
        ClusterLost: if they cannot be started.
    """
    if most_bytes is None:
        most_bytes = int(_MEMORY_SHARE * memory_bytes() / count)
    # Of a killed worker too, the temporary files are deleted with this folder; if this process is
    # killed, the workers delete it.
    with tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True) as folder:
        set_up = SetUp(
            name="trial worker",
            # They are stopped and continued together with this process.
            leads_group=False,
            imports_main=defines_agents(),
            temporary=folder,
            environment=dict(os.environ),
        )
        pool = WorkerPool(count, set_up, most_bytes=most_bytes)
        try:
            with _one_thread_each():
                start_fork_server(_PRELOADED)
                _wait_until_started(pool)
            yield pool
        finally:
            # Each would finish its trial first.
            pool.shutdown(cancel_futures=True)


def defines_agents() -> bool:
    """Whether the main module defines classes of agents, for which workers have to import it."""
    return any(
        isinstance(value, type) and value.__module__ == "__main__" and hasattr(value, "act")
        for value in list(vars(sys.modules["__main__"]).values())
    )


class LocalWorkers:
    """Worker processes on this machine. Their tasks are futures of `concurrent.futures`."""

    def __init__(self, pool: WorkerPool) -> None:
        """Give trials to the processes of a pool."""
        self._pool, self._expected = pool, versions()

    def count(self) -> int:
        """Return the number of worker processes, each of which computes one task at a time."""
        return self._pool.count

    def submit(self, trials: Sequence[Trial]) -> "Future[list[Outcome]]":
        """Let the next free worker run a batch of trials."""
        return self._pool.submit(run_batch, trials, self._expected)

    def result(self, task: "Future[list[Outcome]]") -> list[Outcome]:
        """Return the result of a task that has ended.

        Raises:
            WorkerDied: if its worker process ended.
            ClusterLost: if no worker can be started.
        """
        try:
            return task.result()
        except BrokenExecutor as error:
            raise WorkerDied from error
        except OSError as error:
            raise _not_started(error) from error


def _wait_until_started(pool: WorkerPool) -> None:
    """Wait until all processes run; raises ClusterLost if one cannot be started."""
    try:
        for probe in [pool.submit(os.getpid) for _ in range(pool.count)]:
            probe.result()
    except BrokenExecutor as error:
        raise ClusterLost(
            "no worker process can be started; the workers import the program for its agents: does "
            'it start its work under `if __name__ == "__main__":`?'
        ) from error
    except OSError as error:
        raise _not_started(error) from error


def _not_started(error: OSError) -> ClusterLost:
    return ClusterLost(f"no worker process can be started ({error})")


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Let NumPy compute in one thread in processes that are started meanwhile."""
    added = {name: "1" for name in _THREADS if name not in os.environ}
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]
