"""An experiment in its job's process: tries what was not tried yet, and tells what it shows."""

import importlib
import json
import logging
import os
import queue
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from app.experiments.plan import Plan, Trial
from app.experiments.trial import TrialResult
from app.jobs.messages import Began, Command, Ended, ExperimentTask, Message, Reported, TrialsDone
from app.storage.store import SUMMARY
from app.storage.stored_trials import results_of

if TYPE_CHECKING:
    from app.experiments.engine import Outcome

BATCHES_PER_S = 5
SUMMARY_EVERY_S = 2.0
_SUMMARY_SHARE = 0.15
"""Of the time, at most; it takes a core away from the trials."""


def experiment(
    order: ExperimentTask, send: Callable[[Message], None], words: "queue.SimpleQueue[Command]"
) -> None:
    """Run an experiment to its end, or until someone says stop or leave.

    Args:
        order: what to try.
        send: tells the server.
        words: what the server says.

    Raises:
        HexapodError: if it cannot go on.
    """
    send(Began((), len(order.rows)))
    listener, book = _Listener(words), _Progress(order, send)
    book.summarise()
    while listener.wait():
        for outcome in book.tried(listener.go_on):
            book.take(outcome)
        book.flush()
        if not listener.held:
            break
        if listener.paused:
            # Nothing runs while it waits: not even the cluster, which takes memory.
            book.summarise()
    if not listener.leaving:
        book.report()
        send(Ended("stopped" if listener.stopped else "finished", book.result()))


class _Listener:
    """Obeys words between trials.

    Attributes:
        paused: whether it is to wait.
        stopped: whether it is to end with what there is.
        leaving: whether it is to end at once, to go on another time.
        held: whether the trials were told not to go on; they are until somebody waits.
    """

    def __init__(self, words: "queue.SimpleQueue[Command]") -> None:
        self.paused = self.stopped = self.leaving = self.held = False
        self._words = words

    def go_on(self) -> bool:
        """Obey what was said; False if nothing more is to be tried before somebody waits."""
        # Once is enough: who was told to end must not be told to go on while it does.
        while not self.held and not self._words.empty():
            self._obey(self._words.get())
            self.held = self.paused or self.stopped or self.leaving
        return not self.held

    def wait(self) -> bool:
        """Wait for as long as it is paused; False if it is to end."""
        while not (self.stopped or self.leaving):
            if not self.paused and self._words.empty():
                self.held = False
                return True
            self._obey(self._words.get())
        return False

    def _obey(self, word: Command) -> None:
        if word.verb in ("pause", "resume"):
            self.paused = word.verb == "pause"
        self.stopped |= word.verb == "stop"
        self.leaving |= word.verb == "leave"


class _Progress:
    """What came of the trials, and what the server knows of it."""

    def __init__(self, order: ExperimentTask, send: Callable[[Message], None]) -> None:
        self._order, self._send_now = order, send
        self._sending = threading.Lock()
        self._summariser = ThreadPoolExecutor(1, "summary")
        self._being_made: Future[None] | None = None
        self._plan = Plan(order.config)
        self._results, self._set_aside = results_of(order.rows)
        self._compute_s = sum(row["compute_s"] for row in order.rows)
        self._wall_s = order.wall_s
        self._pending: list[dict[str, Any]] = []
        self._sent_s = self._due_s = time.monotonic()
        self._summary: dict[str, Any] = {}
        self._is_stale = True
        self._files: list[str] = []

    @property
    def done(self) -> int:
        """How many trials there are no more to be tried."""
        return len(self._results) + len(self._set_aside)

    def tried(self, go_on: Callable[[], bool]) -> "Iterator[Outcome]":
        """Try what is left."""
        # The server imports this module, and has no use for what a cluster needs.
        from app.experiments.cluster import ClusterSpec  # noqa: PLC0415
        from app.experiments.engine import run_trials  # noqa: PLC0415

        # It would tell of each start and end of a cluster, and of tasks that a pause drops.
        importlib.import_module("distributed")
        for name in ("distributed", "distributed.scheduler"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        began_s, before_s = time.monotonic(), self._wall_s

        def attentive() -> bool:
            self._wall_s = before_s + time.monotonic() - began_s
            self._keep_up()
            return go_on()

        yield from run_trials(list(self._left()), ClusterSpec(workers=self._workers), attentive)
        self._wall_s = before_s + time.monotonic() - began_s

    def take(self, outcome: "Outcome") -> None:
        """Take in what came of a trial."""
        result = None if outcome.result is None else outcome.result.as_json()
        row = {**outcome._asdict(), "result": result}
        results, set_aside = results_of([row])
        self._results |= results
        self._set_aside |= set_aside
        self._compute_s += outcome.compute_s
        self._pending.append(row)
        self._is_stale = True

    def flush(self) -> None:
        """Send what was not sent yet."""
        if self._pending:
            self._send(TrialsDone(tuple(self._pending), self.done))
        self._pending = []
        self._sent_s = time.monotonic()

    def summarise(self) -> None:
        """Send what the trials show so far, if that is another than before, and wait for it."""
        self._wait_for_summary()
        if self._is_stale:
            self._begin_summary()
            self._wait_for_summary()

    def _begin_summary(self) -> None:
        """Make it beside the trials, which it would keep waiting."""
        self.flush()
        self._is_stale = False
        seen = dict(self._results), dict(self._set_aside), self._cost()
        self._being_made = self._summariser.submit(self._make_summary, *seen)

    def _wait_for_summary(self) -> None:
        if self._being_made is not None:
            self._being_made.result()
            self._being_made = None

    def _make_summary(
        self, results: Mapping[str, TrialResult], set_aside: Mapping[str, str], cost: Any
    ) -> None:
        from app.experiments.summary import summarise  # noqa: PLC0415 - it brings SciPy

        began_s = time.monotonic()
        self._summary = summarise(self._order.config, results, set_aside, cost)
        took_s = time.monotonic() - began_s
        self._due_s = began_s + max(SUMMARY_EVERY_S, took_s / _SUMMARY_SHARE)
        self._keep(SUMMARY, json.dumps(self._summary, allow_nan=False).encode())

    def report(self) -> None:
        """Send the files of the report."""
        from app.experiments.report.files import report_files  # noqa: PLC0415 - it brings Matplotlib

        self.flush()
        self._is_stale = True
        self.summarise()
        for name, data in report_files(self._summary, self._results):
            self._keep(name, data)

    def result(self) -> dict[str, Any]:
        """The run's result, short enough for lists of runs."""
        trials = {name: self._summary["trials"][name] for name in ("done", "total", "failed")}
        trials["set_aside"] = len(self._set_aside)
        claims = [{n: claim[n] for n in ("id", "verdict")} for claim in self._summary["claims"]]
        return {"trials": trials, "claims": claims, "files": self._files}

    def _left(self) -> Iterator[Trial]:
        known = self._results.keys() | self._set_aside.keys()
        return (trial for trial in self._plan.trials() if trial.key not in known)

    def _keep_up(self) -> None:
        now_s = time.monotonic()
        if self._pending and now_s - self._sent_s >= 1 / BATCHES_PER_S:
            self.flush()
        if self._being_made is not None and self._being_made.done():
            self._wait_for_summary()
        if self._is_stale and now_s >= self._due_s and self._being_made is None:
            self._begin_summary()

    def _keep(self, name: str, data: bytes) -> None:
        if name not in self._files:
            self._files.append(name)
        self._send(Reported(name, data))

    def _send(self, message: Message) -> None:
        with self._sending:
            self._send_now(message)

    @property
    def _workers(self) -> int:
        return self._order.workers or os.cpu_count() or 1

    def _cost(self) -> dict[str, Any]:
        wall_s = self._wall_s
        return {
            "wall_s": round(wall_s, 3),
            "compute_s": round(self._compute_s, 3),
            "trials_per_s": round(self.done / wall_s, 3) if wall_s > 0 else None,
            "workers": self._workers,
        }
