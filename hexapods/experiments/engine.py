"""Run trials on workers: a sliding window of tasks, with retries for trials whose worker died."""

import queue
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from itertools import chain, islice

from hexapods.domain.sums import ordered_sum
from hexapods.experiments.cluster import ClusterSpec, connect
from hexapods.experiments.plan import Trial
from hexapods.experiments.worker import (
    BatchFuture,
    ClusterLost,
    Outcome,
    VersionMismatch,
    WorkerDied,
    Workers,
)

DEATHS = 3
"""Number of times that a trial may kill its worker before it is set aside."""

BATCH_S = 0.5
MAX_BATCH = 64
_TASKS_PER_WORKER = 2
"""Tasks in flight per worker: while one is computed, the next is queued on the worker."""
_POLL_S = 0.2
_WORKER_COUNT_S = 1.0
_WORKER_WAIT_S = 60.0


def run_trials(
    trials: Iterable[Trial], spec: ClusterSpec, may_continue: Callable[[], bool] = lambda: True
) -> Generator[Outcome, None, None]:
    """Run trials and yield each outcome as it completes, in order of completion.

    A trial whose worker died is retried alone; one that killed its worker `DEATHS` times, or
    raised an error, is set aside. Trials that measure time run last, one at a time. A script that
    defines agents needs `if __name__ == "__main__":`, since the worker processes import it then.

    Args:
        trials: the trials, with unique keys.
        spec: the workers. Those of this machine are started before the first trial.
        may_continue: called before each task is submitted, and five times a second. Returning
            False ends the run and cancels the tasks in progress; blocking in it pauses the run.

    Raises:
        InvalidInput: if the cluster cannot be used; see `connect`.
        ClusterLost: if no worker can be started or comes back in time, or the scheduler's
            connection is lost.
    """
    remaining = iter(trials)
    first = next(remaining, None)
    if first is None or not may_continue():
        return
    with connect(spec) as workers:
        yield from run_on(workers, chain([first], remaining), may_continue)


def run_on(
    workers: Workers, trials: Iterable[Trial], may_continue: Callable[[], bool] = lambda: True
) -> Generator[Outcome, None, None]:
    """Run trials as `run_trials` does, on workers that are already there."""
    return _Engine(workers, may_continue).run(trials)


class _BatchSizer:
    """Number of trials per task, adapted so that a task takes about `BATCH_S`.

    With batches of that length the overhead of scheduling a task is negligible. The time per trial
    is an exponential moving average.
    """

    def __init__(self) -> None:
        self.size = 1
        self._trial_s: float | None = None

    def update(self, done: Sequence[Outcome]) -> None:
        mean_s = ordered_sum(outcome.compute_s for outcome in done) / len(done)
        previous_s = mean_s if self._trial_s is None else self._trial_s
        self._trial_s = max(0.7 * previous_s + 0.3 * mean_s, 1e-6)
        self.size = max(1, min(2 * self.size, MAX_BATCH, int(BATCH_S / self._trial_s)))


class _Engine:
    """State of one `run_on`: the sliding window of tasks in flight, and the trials to retry."""

    def __init__(self, workers: Workers, may_continue: Callable[[], bool]) -> None:
        self._workers, self._may_continue = workers, may_continue
        self._batches = _BatchSizer()
        self._in_flight: dict[BatchFuture, list[Trial]] = {}
        self._ended_tasks: queue.SimpleQueue[BatchFuture] = queue.SimpleQueue()
        self._suspects: list[Trial] = []
        self._count, self._counted_s = 0, -_WORKER_COUNT_S
        self._without_workers_since_s: float | None = None

    def run(self, trials: Iterable[Trial]) -> Generator[Outcome, None, None]:
        timed: list[Trial] = []
        untimed = _split_timed(trials, timed)
        while True:
            self._fill_window(untimed)
            if not self._in_flight:
                break
            ended = self._next_ended()
            if ended is None:
                return
            batch = self._in_flight.pop(ended)
            try:
                yield from self._outcomes(ended, batch)
            except WorkerDied:
                self._suspects += batch
        for trial in self._suspects:
            yield from self._run_alone(trial, deaths=1)
        for trial in timed:
            yield from self._run_alone(trial, deaths=0)

    def _fill_window(self, untimed: Iterator[Trial]) -> None:
        """Submit batches until each worker has `_TASKS_PER_WORKER` tasks in flight."""
        self._check_workers()
        while (
            len(self._in_flight) < _TASKS_PER_WORKER * max(1, self._count) and self._may_continue()
        ):
            batch = list(islice(untimed, self._batches.size))
            if not batch:
                return
            self._submit(batch)

    def _run_alone(self, trial: Trial, deaths: int) -> Iterator[Outcome]:
        """Run a trial with nothing else on the workers, so that a worker's death is due to it."""
        while deaths < DEATHS:
            if not self._may_continue():
                return
            self._submit([trial])
            ended = self._next_ended()
            if ended is None:
                return
            del self._in_flight[ended]
            try:
                yield from self._outcomes(ended, [trial])
            except WorkerDied as died:
                deaths += died.times
            else:
                return
        reason = f"it ended its worker's process {deaths} times"
        yield Outcome(trial.key, None, reason, 0.0)

    def _submit(self, batch: list[Trial]) -> None:
        task = self._workers.submit(batch)
        self._in_flight[task] = batch
        task.add_done_callback(self._ended_tasks.put)

    def _next_ended(self) -> BatchFuture | None:
        """Wait for the next task that ends; None if the run shall end."""
        while self._may_continue():
            try:
                return self._ended_tasks.get(timeout=_POLL_S)
            except queue.Empty:
                self._check_workers()
        return None

    def _outcomes(self, ended: BatchFuture, batch: list[Trial]) -> list[Outcome]:
        try:
            done = self._workers.result(ended)
        except (WorkerDied, ClusterLost, VersionMismatch):
            raise
        except Exception as error:
            # The task could not be deserialised, for example an agent's module is missing there.
            reason = f"a worker cannot run it ({type(error).__name__}: {error})"
            return [Outcome(trial.key, None, reason, 0.0) for trial in batch]
        self._batches.update(done)
        return done

    def _check_workers(self) -> None:
        now_s = time.monotonic()
        if now_s - self._counted_s < _WORKER_COUNT_S:
            return
        self._counted_s = now_s
        self._count = self._workers.count()
        if self._count:
            self._without_workers_since_s = None
        elif self._without_workers_since_s is None:
            self._without_workers_since_s = now_s
        elif now_s - self._without_workers_since_s > _WORKER_WAIT_S:
            raise ClusterLost(
                f"no worker came back within {_WORKER_WAIT_S:.0f} s; what was done is kept"
            )


def _split_timed(trials: Iterable[Trial], timed: list[Trial]) -> Iterator[Trial]:
    """Yield the trials that may run concurrently; append the others to `timed`."""
    for trial in trials:
        if trial.config.must_be_alone:
            timed.append(trial)
        else:
            yield trial
