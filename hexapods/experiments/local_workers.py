"""Worker processes on this machine: a pool of one process for each.

A pool is broken by the death of any of its processes. As each has its own, a death makes suspects
of the tasks of that worker only, and the others go on.
"""

import logging
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess

from hexapods.experiments.trial import TrialConfig
from hexapods.experiments.worker import Attempt, ClusterLost, WorkerDied, run_batch, versions
from hexapods.machine import memory_bytes
from hexapods.processes import (
    STALLED_S,
    end_with_parent,
    is_stopped,
    kill_workers,
    memory_used_bytes,
    set_process_name,
    worker_processes,
)

_PRELOADED = ["hexapods.experiments.worker", "hexapods.physics.mujoco_simulator"]
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables by which NumPy's libraries start a number of threads."""
_MEMORY_SHARE = 0.95
"""Share of the machine's memory that all workers may take."""
_CHECK_EVERY_S = 0.2
_REAPED_S = 0.1
"""After this time it can be seen that a fork server has ended."""
_logger = logging.getLogger(__name__)


@contextmanager
def local_workers(count: int) -> "Iterator[LocalWorkers]":
    """Start worker processes, and yield them; they end with this process, even if it is killed.

    Args:
        count: their number.

    Raises:
        ClusterLost: if they cannot be started.
    """
    # Of a killed worker too, the temporary files are deleted with this folder.
    with tempfile.TemporaryDirectory(prefix="hexapods-", ignore_cleanup_errors=True) as folder:
        workers = LocalWorkers({**os.environ, "TMPDIR": folder})
        try:
            workers.start(count)
            yield workers
        finally:
            workers.close()


class LocalWorkers:
    """Worker processes on this machine. Their tasks are futures of `concurrent.futures`."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        """Start none yet.

        Args:
            environment: their environment.
        """
        self._environment, self._expected = dict(environment), versions()
        self._workers: list[_Worker] = []
        self._closing = threading.Event()

    def start(self, count: int, most_bytes: int | None = None) -> None:
        """Start the processes, and wait until they run.

        Args:
            count: their number.
            most_bytes: memory above which one is killed; None for its share of the machine's.

        Raises:
            ClusterLost: if they cannot be started.
        """
        total_bytes = memory_bytes()
        if most_bytes is None and total_bytes is not None:
            most_bytes = int(_MEMORY_SHARE * total_bytes / count)
        try:
            for _ in range(count):
                self._workers.append(_Worker(self._environment))
            for worker in self._workers:
                worker.started.result()
        except BrokenProcessPool as error:
            raise ClusterLost(
                "no worker process can be started; does the program start its work under "
                '`if __name__ == "__main__":`, as the workers import it?'
            ) from error
        threading.Thread(target=self._watch, args=(most_bytes,), daemon=True).start()

    def count(self) -> int:
        """Return how many tasks they compute at once."""
        return len(self._workers)

    def submit(self, configs: Sequence[TrialConfig]) -> "Future[list[Attempt]]":
        """Let the worker with the fewest tasks run a batch of trials."""
        worker = min(self._workers, key=lambda one: len(one.tasks))
        return worker.submit(configs, self._expected)

    def result(self, task: "Future[list[Attempt]]") -> list[Attempt]:
        """Return the result of a task that has ended; raises WorkerDied if its worker did."""
        try:
            return task.result()
        except BrokenProcessPool as error:
            raise WorkerDied from error

    def close(self) -> None:
        """Kill the processes, as each would finish its trial first."""
        self._closing.set()
        for worker in self._workers:
            kill_workers(worker.pool)
        for worker in self._workers:
            worker.pool.shutdown(cancel_futures=True)

    def _watch(self, most_bytes: int | None) -> None:
        """Kill workers that a signal has stopped, and those that take too much memory."""
        seen_stopped = Counter[int]()
        while not self._closing.wait(_CHECK_EVERY_S):
            for process in self._processes():
                pid = process.pid or 0
                # Times that it was seen so, as a clock also runs while all processes are stopped.
                seen_stopped[pid] = seen_stopped[pid] + 1 if is_stopped(pid) else 0
                if seen_stopped[pid] * _CHECK_EVERY_S > STALLED_S:
                    _logger.warning("a worker was stopped by a signal for %g s", STALLED_S)
                    process.kill()
                elif most_bytes is not None and memory_used_bytes(pid) > most_bytes:
                    _logger.warning("a worker took over %d MB of memory", most_bytes >> 20)
                    process.kill()

    def _processes(self) -> list[BaseProcess]:
        return [process for one in self._workers for process in worker_processes(one.pool)]


class _Worker:
    """A worker process, which is started again after its death.

    Attributes:
        pool: the pool of this process only.
        tasks: what it has to do.
        started: ends once the process runs.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = environment
        self._start()

    def submit(
        self, configs: Sequence[TrialConfig], expected: Mapping[str, str]
    ) -> "Future[list[Attempt]]":
        try:
            task = self.pool.submit(run_batch, configs, expected)
        except BrokenProcessPool:
            self._start()
            task = self.pool.submit(run_batch, configs, expected)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)
        return task

    def _start(self) -> None:
        try:
            self._create()
        except (EOFError, ConnectionError):  # the fork server has ended, and a new one is started
            time.sleep(_REAPED_S)
            try:
                self._create()
            except (EOFError, OSError) as error:
                raise ClusterLost(f"no worker process can be started ({error})") from error

    def _create(self) -> None:
        self.tasks: set[Future[list[Attempt]]] = set()
        self.pool = ProcessPoolExecutor(
            1, _context(), initializer=_set_up, initargs=(self._environment,)
        )
        with _starting():
            self.started = self.pool.submit(os.getpid)
        # Private. As long as this end is open, the pool of a worker that is killed while it sends a
        # result waits for the rest of it.
        self.pool._result_queue._writer.close()  # type: ignore[attr-defined]  # noqa: SLF001


def _context() -> ForkServerContext | SpawnContext:
    """Return how processes start: on Linux as forks of one that has imported all they need."""
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(_PRELOADED)
    return context


def _set_up(environment: Mapping[str, str]) -> None:
    set_process_name("trial worker")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    # A fork server has the environment of its start, and may have looked for the temporary folder.
    os.environ.update(environment)
    tempfile.tempdir = None


@contextmanager
def _starting() -> Iterator[None]:
    """Let processes started meanwhile ignore Ctrl-C, and NumPy compute in one thread in them.

    A terminal sends SIGINT to its whole process group; only this process shall handle it. A child
    inherits the signal mask of the thread that starts it, and the environment.
    """
    added = {name: "1" for name in _THREADS if name not in os.environ}
    os.environ.update(added)
    if sys.platform != "win32":
        # Starting the resource tracker unblocks SIGINT, so that it must be running beforehand.
        resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if sys.platform != "win32":
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for name in added:
            del os.environ[name]
