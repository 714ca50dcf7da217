"""Pool of worker processes that run trials for interactive requests, and shut down when idle."""

import multiprocessing
import os
import queue
import threading
import time
from collections.abc import Sequence
from concurrent.futures import Future
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import NamedTuple

from app.domain.errors import HexapodError, InvalidInput
from app.experiments.trial import TrialConfig, TrialResult, run_trial
from app.jobs.process_setup import set_up_process
from app.storage.errors import Busy

IDLE_S = 60.0
TIMEOUT_S = 60.0
NICENESS = 10
"""Less than that of jobs, since a user waits for the reply."""
_CHUNK_SIZE = 3
_CLOSE_S = 3.0

_Reply = list[TrialResult] | str


class _Request(NamedTuple):
    configs: Sequence[TrialConfig]
    future: "Future[list[TrialResult]]"


class _Worker(NamedTuple):
    process: SpawnProcess
    pipe: Connection


class _WorkerLost(Exception):
    """Raised if a worker process exited or exceeded the timeout."""


class TrialPool:
    """Worker processes, started on the first request and shut down after an idle timeout.

    They die with the server, however that ends.
    """

    def __init__(self, count: int | None = None, idle_s: float = IDLE_S) -> None:
        """Create the pool; the first request starts the processes.

        Args:
            count: number of processes; by default one per core.
            idle_s: time without a request after which they are shut down [s].
        """
        self._count, self._idle_s = count or os.cpu_count() or 1, idle_s
        self._requests: queue.SimpleQueue[_Request | None] = queue.SimpleQueue()
        self._workers: list[_Worker] = []
        # PR_SET_PDEATHSIG kills a child when the *thread* that started it ends, so one long-lived
        # thread starts all of them.
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self._closed = False

    @property
    def pids(self) -> list[int]:
        """Process ids of the running workers."""
        return [
            worker.process.pid for worker in list(self._workers) if worker.process.pid is not None
        ]

    def run(self, configs: Sequence[TrialConfig]) -> list[TrialResult]:
        """Run trials and wait for them; callable from any thread, requests are serialised.

        Args:
            configs: the trials.

        Returns:
            their results, in the same order.

        Raises:
            InvalidInput: if a trial is invalid.
            Busy: if a worker exits, the timeout passes, or the pool is closed.
        """
        request = _Request(configs, Future())
        with self._lock:
            if self._closed:
                raise Busy("the server is stopping; try again later", 1)
            if self._thread is None:
                self._thread = threading.Thread(target=self._serve, name="trial pool", daemon=True)
                self._thread.start()
            self._requests.put(request)
        return request.future.result()

    def close(self) -> None:
        """Kill the processes and reject further requests."""
        with self._lock:
            self._closed = True
            self._requests.put(None)
            thread = self._thread
        for worker in list(self._workers):
            with suppress(ValueError):  # it has exited, and its handle is closed
                worker.process.kill()
        if thread is not None:
            thread.join(_CLOSE_S)

    def _serve(self) -> None:
        while True:
            try:
                request = self._requests.get(timeout=self._idle_s)
            except queue.Empty:
                self._stop_workers()
                continue
            if request is None:
                self._stop_workers()
                return
            try:
                request.future.set_result(self._run(request.configs))
            except HexapodError as error:
                request.future.set_exception(error)
            except (_WorkerLost, OSError) as error:
                self._stop_workers()
                message = f"the processes that try it are gone ({error}); try again"
                request.future.set_exception(Busy(message, 1))

    def _run(self, configs: Sequence[TrialConfig]) -> list[TrialResult]:
        while len(self._workers) < self._count:
            self._workers.append(_start())
        chunks = [configs[i : i + _CHUNK_SIZE] for i in range(0, len(configs), _CHUNK_SIZE)]
        results: dict[int, list[TrialResult]] = {}
        idle = [worker.pipe for worker in self._workers]
        in_flight: dict[Connection, int] = {}
        error: str | None = None
        deadline = time.monotonic() + TIMEOUT_S
        number = 0
        while number < len(chunks) or in_flight:
            # After the first error no more chunks are sent: all trials of a request share it.
            while idle and number < len(chunks) and error is None:
                idle[-1].send(chunks[number])
                in_flight[idle.pop()] = number
                number += 1
            if not in_flight:
                break
            for pipe in _ready(in_flight, deadline):
                reply = _receive(pipe)
                if isinstance(reply, str):
                    error = reply
                else:
                    results[in_flight[pipe]] = reply
                del in_flight[pipe]
                idle.append(pipe)
        if error is not None:
            raise InvalidInput(error)
        return [result for number in sorted(results) for result in results[number]]

    def _stop_workers(self) -> None:
        for worker in self._workers:
            worker.process.kill()
            worker.process.join()
            worker.process.close()
            worker.pipe.close()
        self._workers.clear()


def _start() -> _Worker:
    context = multiprocessing.get_context("spawn")
    pipe, child_pipe = context.Pipe()
    # A daemon, so that a program that never calls `close` can still exit.
    process = context.Process(target=main, args=(child_pipe,), name="trials", daemon=True)
    process.start()
    child_pipe.close()
    return _Worker(process, pipe)


def _ready(in_flight: dict[Connection, int], deadline: float) -> list[Connection]:
    readable = wait(list(in_flight), timeout=max(0.0, deadline - time.monotonic()))
    if not readable:
        raise _WorkerLost(f"it takes over {TIMEOUT_S:.0f} s")
    return [pipe for pipe in in_flight if pipe in readable]


def _receive(pipe: Connection) -> _Reply:
    try:
        reply: _Reply = pipe.recv()
    except (EOFError, OSError) as error:
        raise _WorkerLost("one of them ended") from error
    return reply


def main(pipe: Connection) -> None:
    """Entry point of a worker process: run chunks of trials until the pipe is closed."""
    set_up_process(NICENESS)
    with suppress(EOFError, OSError):
        while True:
            pipe.send(_run_chunk(pipe.recv()))
    os._exit(0)


def _run_chunk(configs: Sequence[TrialConfig]) -> _Reply:
    try:
        return [run_trial(config) for config in configs]
    except HexapodError as error:
        return str(error)
    except Exception as error:  # an agent is anyone's code
        return f"something in it broke ({type(error).__name__}: {error})"
