"""Runs trials on a cluster: a sliding window of tasks, and an answer for each that dies."""

import queue
import time
import uuid
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import TYPE_CHECKING, NamedTuple

from app.experiments.cluster import ClusterLost, ClusterSpec, connect
from app.experiments.plan import Trial
from app.experiments.trial import TrialResult
from app.experiments.versions import versions
from app.experiments.worker import Done, OtherResults, work

if TYPE_CHECKING:
    from distributed import Client, Future

DEATHS = 3
"""How often a trial may end its worker before it is set aside."""

BATCH_S = 0.5
MAX_BATCH = 64
_AHEAD = 2
"""Tasks a worker: while one is computed the next is there already."""
_LOOK_S = 0.2
_COUNT_S = 1.0
_NO_WORKER_S = 60.0


class Outcome(NamedTuple):
    """What became of a trial."""

    key: str
    result: TrialResult | None
    """None if it was set aside."""
    set_aside: str | None
    """Why there is no result, in a sentence."""
    compute_s: float
    """How long a worker computed."""


def run_trials(
    trials: Iterable[Trial], where: ClusterSpec, go_on: Callable[[], bool] = lambda: True
) -> Generator[Outcome, None, None]:
    """Run trials, and tell of each as it ends, in whatever order that is.

    A trial whose worker died is tried again, alone; one that ended its worker three times, or
    raised an error, is set aside. Trials that measure time come last, each with nothing beside it.
    Whoever calls this from a script needs `if __name__ == "__main__":`, since the workers import
    it.

    Args:
        trials: what to run; keys are unique.
        where: on which machines. A cluster of this machine's is started for the first trial.
        go_on: asked before each task, and five times a second. False ends it, and what is being
            computed is dropped. It may wait before it answers, which is a pause.

    Raises:
        InvalidInput: if the cluster cannot be used; see `connect`.
        ClusterLost: if it is gone, or no worker came back to it.
    """
    waiting = iter(trials)
    first = next(waiting, None)
    if first is None or not go_on():
        return
    with connect(where) as client:
        yield from run_on(client, chain([first], waiting), go_on)


def run_on(
    client: "Client", trials: Iterable[Trial], go_on: Callable[[], bool] = lambda: True
) -> Iterator[Outcome]:
    """As `run_trials`, on a cluster that is there."""
    return _Engine(client, go_on).run(trials)


class _Batches:
    """How many trials make a task: so many that handing them out costs nothing beside them."""

    def __init__(self) -> None:
        self.size = 1
        self._trial_s: float | None = None

    def learn(self, done: Sequence[Done]) -> None:
        mean_s = sum(one.compute_s for one in done) / len(done)
        known_s = mean_s if self._trial_s is None else self._trial_s
        self._trial_s = max(0.7 * known_s + 0.3 * mean_s, 1e-6)
        self.size = max(1, min(2 * self.size, MAX_BATCH, int(BATCH_S / self._trial_s)))


class _Engine:
    """One run on one cluster."""

    def __init__(self, client: "Client", go_on: Callable[[], bool]) -> None:
        self._client, self._go_on = client, go_on
        self._expected = versions()
        self._batches = _Batches()
        self._in_flight: dict[Future[list[Done]], list[Trial]] = {}
        self._ended: queue.SimpleQueue[Future[list[Done]]] = queue.SimpleQueue()
        self._suspects: list[Trial] = []
        self._threads, self._counted_s = 0, -_COUNT_S
        self._without_workers_since_s: float | None = None

    def run(self, trials: Iterable[Trial]) -> Iterator[Outcome]:
        timed: list[Trial] = []
        crowd = _without_timed(trials, timed)
        while True:
            self._fill(crowd)
            if not self._in_flight:
                break
            ended = self._next()
            if ended is None:
                return
            batch = self._in_flight.pop(ended)
            try:
                yield from self._outcomes(ended, batch)
            except _Died:
                self._suspects += batch
        for trial in self._suspects:
            yield from self._alone(trial, deaths=1)
        for trial in timed:
            yield from self._alone(trial, deaths=0)

    def _fill(self, crowd: Iterator[Trial]) -> None:
        """Submit so much that every worker has something to do, and the next thing."""
        self._count_workers()
        while len(self._in_flight) < _AHEAD * max(1, self._threads) and self._go_on():
            batch = list(islice(crowd, self._batches.size))
            if not batch:
                return
            self._submit(batch)

    def _alone(self, trial: Trial, deaths: int) -> Iterator[Outcome]:
        """Run a trial while nothing else does, so that a death is its own."""
        while deaths < DEATHS:
            if not self._go_on():
                return
            self._submit([trial])
            ended = self._next()
            if ended is None:
                return
            del self._in_flight[ended]
            try:
                yield from self._outcomes(ended, [trial])
            except _Died as died:
                deaths += died.times
            else:
                return
        reason = f"it ended its worker's process {deaths} times"
        yield Outcome(trial.key, None, reason, 0.0)

    def _submit(self, batch: list[Trial]) -> None:
        configs = [trial.config for trial in batch]
        key = f"hexapods-{uuid.uuid4().hex}"
        future = self._client.submit(work, configs, self._expected, key=key)
        self._in_flight[future] = batch
        future.add_done_callback(self._ended.put)

    def _next(self) -> "Future[list[Done]] | None":
        """The next task that ends; None if the run shall."""
        while self._go_on():
            try:
                return self._ended.get(timeout=_LOOK_S)
            except queue.Empty:
                self._count_workers()
        return None

    def _outcomes(self, ended: "Future[list[Done]]", batch: list[Trial]) -> list[Outcome]:
        from distributed import CancelledError, KilledWorker  # noqa: PLC0415

        try:
            done: list[Done] = ended.result()
        except KilledWorker as error:
            raise _Died(error.allowed_failures + 1) from error
        except CancelledError as error:
            raise ClusterLost(_LOST) from error
        except OtherResults:
            raise
        except Exception as error:
            # What the worker could not even begin, such as an agent that is not there.
            reason = f"a worker cannot run it ({type(error).__name__}: {error})"
            return [Outcome(trial.key, None, reason, 0.0) for trial in batch]
        self._batches.learn(done)
        return [Outcome(trial.key, *one) for trial, one in zip(batch, done, strict=True)]

    def _count_workers(self) -> None:
        now_s = time.monotonic()
        if now_s - self._counted_s < _COUNT_S:
            return
        self._counted_s = now_s
        try:
            self._threads = sum(self._client.nthreads().values())
        except (OSError, TimeoutError) as error:
            raise ClusterLost(_LOST) from error
        if self._threads:
            self._without_workers_since_s = None
        elif self._without_workers_since_s is None:
            self._without_workers_since_s = now_s
        elif now_s - self._without_workers_since_s > _NO_WORKER_S:
            raise ClusterLost(f"no worker came back within {_NO_WORKER_S:.0f} s; {_KEPT}")


class _Died(Exception):
    """A worker's process ended while it computed a task."""

    def __init__(self, times: int) -> None:
        super().__init__(times)
        self.times = times


_KEPT = "what was done is kept"
_LOST = f"the connection to the cluster's scheduler was lost; {_KEPT}"


def _without_timed(trials: Iterable[Trial], timed: list[Trial]) -> Iterator[Trial]:
    """Those that may run beside others; the rest is put aside in `timed`."""
    for trial in trials:
        if trial.config.must_be_alone:
            timed.append(trial)
        else:
            yield trial
